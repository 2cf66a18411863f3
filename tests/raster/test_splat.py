"""Splats and readback: what one ball does to the buffer, and what it sees in it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refcloud.plain import raster as plain
from refcloud.raster import (
    Framebuffer,
    footprint,
    framebuffer,
    patch,
    read_mean,
    splat,
    transmittance,
)

PLACE = st.floats(-12.0, 24.0)
SIZE = st.integers(1, 12)
# 0.01 to 1e8 pixels, and often of the buffer's own size.
RADIUS = st.floats(0.4, 12.0) | st.floats(-2, 8).map(lambda power: 10.0**power)
KERNEL = st.sampled_from(["wyvill", "gaussian"])
NAME = st.sampled_from(["chord", "profile"])
LAW = st.sampled_from(["beer", "linear"])
AREA = st.sampled_from(["disc", "square", "footprint", "antialiased"])
LIGHT = st.lists(st.floats(0.0, 10.0), min_size=3, max_size=3)


def filled(width: int, height: int) -> Framebuffer:
    """Fill a buffer with values that are different everywhere, all in [0, 1]."""
    step = np.sqrt([2.0, 3.0, 5.0, 7.0])
    count = np.arange(1.0, width * height + 1).reshape(height, width, 1)
    return Framebuffer((count * step) % 1.0)


@given(
    x=PLACE,
    y=PLACE,
    radius=RADIUS,
    width=SIZE,
    height=SIZE,
    emission=LIGHT,
    tau=st.floats(0.0, 50.0),
    kernel=KERNEL,
    name=NAME,
    law=LAW,
)
def test_splat_is_eq_27_at_every_pixel(
    x, y, radius, width, height, emission, tau, kernel, name, law
) -> None:
    buffer = filled(width, height)
    before = buffer.pixels.copy()
    splat(
        buffer,
        x,
        y,
        radius,
        emission=emission,
        tau=tau,
        kernel=kernel,
        name=name,
        law=law,
    )
    rows, columns = np.arange(height)[:, None] + 0.5, np.arange(width) + 0.5
    q = ((columns - x) / radius) ** 2 + ((rows - y) / radius) ** 2
    weight = footprint(np.minimum(q, 1.0), kernel=kernel, name=name)
    T = transmittance(weight, tau, law=law)[..., None]
    if tau > 1e-4:  # below, 1 - T loses the digits that the splat keeps
        source = np.array(emission) * (1.0 - T) / (1.0 - math.exp(-tau))
        expected = source + T * before[..., :3]
        np.testing.assert_allclose(buffer.pixels[..., :3], expected, atol=1e-10)
    alpha = 1.0 - T[..., 0] * (1.0 - before[..., 3])
    np.testing.assert_allclose(buffer.pixels[..., 3], alpha, atol=1e-15)


@given(x=PLACE, y=PLACE, radius=RADIUS, emission=LIGHT, name=NAME, law=LAW)
def test_a_thin_splat_glows_as_its_footprint(x, y, radius, emission, name, law) -> None:
    results = []
    for tau in (0.0, 5e-324, 1e-16, 1.1e-16, 1e-12):
        buffer = framebuffer(9, 9, color=[0, 0, 0, 1])
        splat(buffer, x, y, radius, emission=emission, tau=tau, name=name, law=law)
        results.append(buffer.pixels)
    for other in results[1:]:
        # At depth tau the glow differs by tau / 2 at most, and by rounding.
        np.testing.assert_allclose(other, results[0], rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("tau", [1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.1])
def test_a_thin_splat_keeps_its_digits(tau) -> None:
    buffer = framebuffer(9, 9)
    splat(buffer, 4.5, 4.5, 4, emission=[1, 1, 1], tau=tau)
    found = patch(4.5, 4.5, 4, 9, 9)
    assert found is not None
    weight = footprint(found.q)
    for row, column in np.ndindex(weight.shape):
        # expm1 of the C library keeps all digits of 1 - T.
        opacity = -math.expm1(-tau * float(weight[row, column]))
        pixel = buffer.pixels[row + found.rows.start, column + found.columns.start]
        assert pixel[3] == pytest.approx(opacity, rel=1e-15, abs=0)
        assert pixel[0] == pytest.approx(opacity / -math.expm1(-tau), rel=1e-15, abs=0)


@given(
    x=PLACE,
    y=PLACE,
    radius=RADIUS,
    emission=st.floats(0.0, 1.0),
    tau=st.floats(0.0, 1e30),
    law=LAW,
    name=NAME,
)
def test_a_splat_between_black_and_white_stays_there(
    x, y, radius, emission, tau, law, name
) -> None:
    """Light that the ball adds is at most 1 - T: nothing grows past displayed white."""
    buffer = filled(9, 9)
    glow = [emission * -math.expm1(-tau)] * 3
    splat(buffer, x, y, radius, emission=glow, tau=tau, law=law, name=name)
    assert (buffer.pixels >= 0.0).all()
    assert (buffer.pixels <= 1.0 + 1e-15).all()


@given(x=PLACE, y=PLACE, radius=RADIUS, tau=st.floats(0.0, 20.0), emission=LIGHT)
@settings(max_examples=40)
def test_the_picture_turns_with_the_splat(x, y, radius, tau, emission) -> None:
    width, height = 9, 7
    one = framebuffer(width, height, color=[0.5, 0.2, 0.1, 0])
    other = framebuffer(height, width, color=[0.5, 0.2, 0.1, 0])
    splat(one, x, y, radius, emission=emission, tau=tau)
    splat(other, y, x, radius, emission=emission, tau=tau)
    np.testing.assert_allclose(
        one.pixels, other.pixels.transpose(1, 0, 2), rtol=1e-13, atol=1e-15
    )


def test_a_splat_moved_by_whole_pixels_is_the_same_splat() -> None:
    buffers = []
    for shift in (0, 5):
        buffer = framebuffer(20, 20)
        splat(buffer, 6.25 + shift, 7.5 + shift, 5, emission=[1, 1, 1], tau=2)
        buffers.append(buffer.pixels)
    np.testing.assert_array_equal(buffers[0][:13, :13], buffers[1][5:18, 5:18])


@pytest.mark.parametrize("kernel", ["wyvill", "gaussian"])
def test_mass_of_a_splat_is_that_of_its_footprint(kernel) -> None:
    # The midpoint rule over pixels nears the disc integral of the chord, which is the
    # ball's volume integral: 736/2835 pi over the chord through its centre (E02).
    buffer = framebuffer(201, 201)
    splat(buffer, 100.5, 100.5, 100, emission=[1, 1, 1], tau=0, kernel=kernel)
    mass = buffer.pixels[..., 0].sum() / 100**2
    if kernel == "wyvill":
        assert mass == pytest.approx(math.pi * 736 / 2835 / (944 / 945), rel=1e-6)
    else:
        volume = 4 * math.pi * _integral(lambda r: r * r * math.exp(-4 * r * r))
        line = 2 * _integral(lambda r: math.exp(-4 * r * r))
        assert mass == pytest.approx(volume / line, rel=1e-3)  # the rim is a step


def _integral(function) -> float:
    nodes, weights = np.polynomial.legendre.leggauss(40)
    return 0.5 * sum(
        w * function(0.5 + 0.5 * n) for n, w in zip(nodes, weights, strict=True)
    )


def test_a_ball_outside_changes_nothing() -> None:
    buffer = filled(5, 5)
    before = buffer.pixels.copy()
    splat(buffer, -9, 2, 3, emission=[1, 1, 1], tau=1)
    np.testing.assert_array_equal(buffer.pixels, before)


@given(x=PLACE, y=PLACE, radius=RADIUS, width=SIZE, height=SIZE, area=AREA, name=NAME)
def test_readback_is_the_mean_by_counting(
    x, y, radius, width, height, area, name
) -> None:
    buffer = filled(width, height)
    actual = read_mean(buffer, x, y, radius, area=area, footprint=name)
    expected = plain.read_mean(
        buffer.pixels.tolist(), x, y, radius, area, "wyvill", name
    )
    if expected is None:
        assert actual is None
    else:
        assert actual is not None
        # Sums of up to 144 values; a footprint may weigh one pixel alone, at its rim,
        # where p = 1 - q keeps few digits but the mean of one value does not change.
        np.testing.assert_allclose(actual, expected, atol=1e-12)


@given(
    x=PLACE,
    y=PLACE,
    radius=RADIUS,
    area=AREA,
    kernel=KERNEL,
    name=NAME,
    color=st.lists(st.floats(-5.0, 5.0), min_size=4, max_size=4),
)
def test_e27_a_flat_buffer_reads_its_own_colour_at_every_border(
    x, y, radius, area, kernel, name, color
) -> None:
    buffer = framebuffer(6, 5, color=color)
    mean = read_mean(buffer, x, y, radius, area=area, kernel=kernel, footprint=name)
    gap_x, gap_y = max(-x, 0.0, x - 6), max(-y, 0.0, y - 5)
    gap = max(gap_x, gap_y) if area == "square" else math.hypot(gap_x, gap_y)
    if mean is None:
        assert gap >= radius * (1 - 1e-12)
    else:
        assert gap <= radius
        # Below the smallest normal number a product loses digits, by steps of 5e-324.
        lost = np.finfo(np.float64).tiny
        np.testing.assert_allclose(mean, color, rtol=1e-14, atol=lost)


@given(x=PLACE, y=PLACE, radius=RADIUS, area=AREA)
def test_a_mean_lies_within_what_was_read(x, y, radius, area) -> None:
    buffer = filled(8, 8)
    mean = read_mean(buffer, x, y, radius, area=area)
    if mean is not None:
        assert (mean >= buffer.pixels.min((0, 1)) - 1e-15).all()
        assert (mean <= buffer.pixels.max((0, 1)) + 1e-15).all()


def test_a_tiny_area_reads_the_nearest_pixel() -> None:
    buffer = filled(4, 3)
    for x, y, row, column in [
        (2.9, 1.1, 1, 2),
        (0.0, 0.0, 0, 0),
        (4.0, 3.0, 2, 3),
        (4.005, -0.005, 0, 3),
    ]:
        for area in ("disc", "square", "footprint"):
            mean = read_mean(buffer, x, y, 0.01, area=area)
            assert mean is not None
            assert mean.tolist() == buffer.pixels[row, column].tolist()


def test_a_mean_is_no_view_of_the_buffer() -> None:
    buffer = filled(4, 4)
    mean = read_mean(buffer, 1.0, 1.0, 0.01)
    assert mean is not None
    mean[:] = 9.0
    assert buffer.pixels.max() <= 1.0


def test_a_huge_area_reads_the_whole_buffer() -> None:
    buffer = filled(8, 8)
    for area in ("disc", "square", "footprint"):
        mean = read_mean(buffer, 3.0, 3.0, 1e8, area=area)
        # At 1e-8 radii from the centre the footprint is 1 to the last digits.
        np.testing.assert_allclose(mean, buffer.pixels.mean((0, 1)), atol=1e-13)


def test_disc_and_square_and_footprint_are_different_means() -> None:
    buffer = framebuffer(41, 41)
    buffer.pixels[..., 0] = np.arange(41) ** 2
    means = [
        read_mean(buffer, 20.5, 20.5, 15, area=area)
        for area in ("square", "disc", "footprint")
    ]
    values = [mean[0] for mean in means if mean is not None]
    assert values[0] > values[1] > values[2], "ever closer to the centre's 400"


def test_emission_below_zero_is_refused() -> None:
    with pytest.raises(ValueError, match="emission: expected numbers in"):
        splat(framebuffer(1, 1), 0, 0, 1, emission=[-1, 0, 0], tau=1)


def test_patch_and_splat_agree_on_what_is_touched() -> None:
    buffer = framebuffer(16, 16)
    splat(buffer, 4.3, 12.8, 5.7, emission=[1, 1, 1], tau=3)
    found = patch(4.3, 12.8, 5.7, 16, 16)
    assert found is not None
    touched = np.zeros((16, 16), bool)
    touched[found.rows, found.columns] = found.q < 1.0
    np.testing.assert_array_equal(buffer.pixels[..., 3] > 0.0, touched)
