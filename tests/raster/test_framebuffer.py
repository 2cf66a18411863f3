"""The framebuffer's type and formats, its clear, its readback of boxes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from refcloud.image import srgb_decode
from refcloud.raster import (
    Framebuffer,
    State,
    clear,
    framebuffer,
    read_average,
    read_pixels,
    seen_through_layers,
    splat,
    stored,
)
from refcloud.raster.formats import (
    LARGEST_16,
    LARGEST_32,
    srgb_decode_llvmpipe,
    srgb_encode_llvmpipe,
)

CHANNEL = st.floats(-1e300, 1e300)
FORMATS = ["RGBA64F", "RGBA32F", "RGBA16F", "RGBA8", "SRGB8_ALPHA8"]
every_format = pytest.mark.parametrize("format", FORMATS)
few = settings(max_examples=20)
every_arithmetic = pytest.mark.parametrize("arithmetic", ["ideal", "llvmpipe"])


@given(
    width=st.integers(1, 40),
    height=st.integers(1, 40),
    first=st.lists(CHANNEL, min_size=4, max_size=4),
    second=st.lists(CHANNEL, min_size=4, max_size=4),
)
def test_clear_sets_every_pixel(width, height, first, second) -> None:
    buffer = framebuffer(width, height, color=first)
    assert buffer.pixels.shape == (height, width, 4)
    assert (buffer.pixels == first).all()
    clear(buffer, second)
    assert (buffer.pixels == second).all()


@settings(max_examples=50)
@given(data=st.data(), width=st.integers(1, 9), height=st.integers(1, 9))
def test_read_pixels_is_a_copy_of_the_box(data, width, height) -> None:
    pixels = np.arange(width * height * 4.0).reshape(height, width, 4)
    top = data.draw(st.integers(0, height))
    bottom = data.draw(st.integers(top, height))
    left = data.draw(st.integers(0, width))
    right = data.draw(st.integers(left, width))
    buffer = Framebuffer(pixels)
    box = read_pixels(buffer, slice(top, bottom), slice(left, right))
    np.testing.assert_array_equal(box, pixels[top:bottom, left:right])
    box[...] = -1.0
    assert (buffer.pixels >= 0.0).all()


def test_read_pixels_takes_open_ends() -> None:
    assert read_pixels(framebuffer(3, 2), slice(None), slice(1, None)).shape == (
        2,
        2,
        4,
    )


@pytest.mark.parametrize(
    "part", [slice(0, 5), slice(-1, 2), slice(2, 1), slice(0, "a")]
)
def test_a_box_outside_is_refused(part: slice) -> None:
    with pytest.raises(ValueError, match="rows: expected a slice of step 1 within"):
        read_pixels(framebuffer(4, 4), part, slice(0, 1))


def test_a_framebuffer_keeps_the_array_it_was_given() -> None:
    pixels = np.zeros((2, 3, 4))
    clear(Framebuffer(pixels), [1, 2, 3, 4])
    assert pixels[1, 2].tolist() == [1, 2, 3, 4]


@pytest.mark.parametrize(
    ("pixels", "error", "message"),
    [
        (np.zeros((2, 2, 4), np.float32), TypeError, "float64, got float32"),
        ([[[0.0] * 4]], TypeError, "float64, got list"),
        (np.zeros((2, 2, 3)), ValueError, r"\(H, W, 4\), got shape \(2, 2, 3\)"),
        (np.zeros((2, 4)), ValueError, r"\(H, W, 4\), got shape \(2, 4\)"),
        (np.zeros((0, 2, 4)), ValueError, r"\(H, W, 4\), got shape \(0, 2, 4\)"),
        (np.broadcast_to(0.0, (2, 2, 4)), ValueError, "read-only"),
    ],
)
def test_other_arrays_are_refused(pixels, error, message) -> None:
    with pytest.raises(error, match=message):
        Framebuffer(pixels)


@pytest.mark.parametrize(("width", "height"), [(0, 1), (1, 0), (-3, 2), (2**70, 1)])
def test_a_size_outside_is_refused(width: int, height: int) -> None:
    with pytest.raises(ValueError, match=r"width|height"):
        framebuffer(width, height)


def test_a_buffer_too_large_is_refused_before_memory_is_taken() -> None:
    with pytest.raises(ValueError, match="at most 8300000 pixels, got 1000000000000"):
        framebuffer(10**6, 10**6)


@pytest.mark.parametrize("color", [[0, 0, 0], [0, 0, 0, np.nan], [0, 0, 0, np.inf]])
def test_a_wrong_colour_is_refused(color: list[float]) -> None:
    with pytest.raises(ValueError, match="color: expected"):
        clear(framebuffer(1, 1), color)


@every_format
@every_arithmetic
@few
@given(values=arrays(np.float64, (3, 4), elements=CHANNEL))
def test_a_format_keeps_what_it_holds(format, arithmetic, values) -> None:
    once = stored(values, format, arithmetic=arithmetic)
    assert np.isfinite(once).all(), "nothing grows infinite"
    buffer = framebuffer(1, 1, color=values[0], format=format, arithmetic=arithmetic)
    assert buffer.pixels[0, 0].tolist() == once[0].tolist()
    Framebuffer(buffer.pixels, format=format)  # holds it, by either arithmetic
    if format != "SRGB8_ALPHA8":  # what is stored there is no light
        again = stored(once, format, arithmetic=arithmetic)
        np.testing.assert_array_equal(again, once)


@every_format
@every_arithmetic
@few
@given(values=arrays(np.float64, (8,), elements=st.floats(-1.0, 2.0)))
def test_rounding_never_turns_an_order_around(format, arithmetic, values) -> None:
    ranked = np.sort(values)[:, None] * np.ones(4)
    kept = stored(ranked, format, arithmetic=arithmetic)
    assert (np.diff(kept, axis=0) >= 0.0).all()


@every_arithmetic
@pytest.mark.parametrize(
    ("format", "half_step", "largest"),
    [("RGBA32F", 2.0**-25, LARGEST_32), ("RGBA16F", 2.0**-12, LARGEST_16)],
)
@few
@given(value=st.floats(2.0**-14, 65504.0) | st.floats(-65504.0, -(2.0**-14)))
def test_a_float_is_the_nearest_or_the_one_toward_zero(
    format, half_step, largest, arithmetic, value
) -> None:
    kept = float(stored(np.full(4, value), format, arithmetic=arithmetic)[0])
    # A step is at most 2 half steps of the power of two above the number.
    step = 2.0 * half_step * 2.0 ** np.ceil(np.log2(abs(value)) + 1e-12)
    if arithmetic == "llvmpipe" and format == "RGBA16F":
        assert abs(kept) <= abs(value) < abs(kept) + 2.0 * step
    else:
        assert abs(kept - value) <= step
    beyond = stored(np.full(4, 1e39), format, arithmetic=arithmetic)
    assert beyond.tolist() == [largest] * 4


@every_arithmetic
def test_every_code_comes_back(arithmetic) -> None:
    codes = np.arange(256.0)[:, None] * np.ones(4) / 255.0
    for format, light in (("RGBA8", codes), ("SRGB8_ALPHA8", codes.copy())):
        if format == "SRGB8_ALPHA8":
            decode = srgb_decode if arithmetic == "ideal" else srgb_decode_llvmpipe
            light[:, :3] = decode(codes[:, :3])
        kept = stored(light, format, arithmetic=arithmetic)
        # llvmpipe's two curves are no exact inverses: by up to two codes.
        most = 2.01 / 255.0 if light is not codes and arithmetic == "llvmpipe" else 0.0
        assert np.abs(kept - codes).max() <= most, format
    halves = (np.arange(255) + 0.5)[:, None] * np.ones(4) / 255.0
    # Ties go to the even code. As float32 counts them all are ties.
    ties = np.rint(stored(halves, "RGBA8", arithmetic="llvmpipe")[:, 0] * 255.0)
    assert (ties % 2 == 0).all()


def test_llvmpipes_curves_are_near_the_standards() -> None:
    light = np.linspace(0.0, 1.0, 10_001)
    exact = stored(light[:, None] * np.ones(4), "SRGB8_ALPHA8")[:, 0]
    assert np.abs(srgb_encode_llvmpipe(light) - exact).max() * 255.0 < 0.5 + 0.26
    codes = np.arange(256) / 255.0
    gap = np.abs(srgb_decode_llvmpipe(codes) - srgb_decode(codes))
    assert gap.max() < 1.2e-3


def test_e35_8_bit_accumulation_stalls() -> None:
    exact = (1.0 - 1.0 / 255.0) ** np.arange(1001)
    for arithmetic in ("ideal", "llvmpipe"):
        how = {"arithmetic": arithmetic}
        codes = np.rint(255 * seen_through_layers(1 / 255, 1000, format="RGBA8", **how))
        assert codes[-1] == 127.0, "0.498; the truth is 0.0196"
        stopped = int(np.argmin(codes))
        # It stops where q alpha < 1/2, and loses one code a layer until then.
        assert (codes[:stopped] / 255.0 >= 0.5).all()
        assert codes[stopped] / 255.0 < 0.5
        assert (np.diff(codes[: stopped + 1]) == -1.0).all()
        assert (codes[stopped:] == 127.0).all()
        float32 = seen_through_layers(1 / 255, 1000, format="RGBA32F", **how)
        assert np.abs(float32 - exact).max() < 1000 * 2.0**-25
    # RGBA16F is right to a part in a hundred; cut toward zero it drifts dark.
    near, cut = (
        seen_through_layers(1 / 255, 1000, format="RGBA16F", arithmetic=arithmetic)
        for arithmetic in ("ideal", "llvmpipe")
    )
    assert near[-1] == pytest.approx(exact[-1], rel=0.05)
    assert (cut[1:] < exact[1:]).all()
    assert cut[-1] < near[-1]


@every_format
@few
@given(alpha=st.floats(0.0, 1.0), layers=st.integers(0, 20))
def test_e35_no_layer_brightens(format, alpha, layers) -> None:
    seen = seen_through_layers(alpha, layers, format=format)
    assert (np.diff(seen) <= 0.0).all()
    assert (seen >= 0.0).all()


@every_format
def test_a_splat_lands_in_the_format(format) -> None:
    exact, buffer = (
        framebuffer(9, 9, color=[0.1, 0.1, 0.1, 0], format=name)
        for name in ("RGBA64F", format)
    )
    for one in (exact, buffer):
        splat(one, 4.2, 4.4, 4, emission=[0.9, 0.2, 0.1], tau=1.5)
    Framebuffer(buffer.pixels, format=format)  # else it is refused
    light = buffer.linear()
    assert np.abs(light - exact.pixels).max() < 0.01
    same = np.array_equal(light, exact.pixels)
    assert same == (format == "RGBA64F")


ENDS = st.tuples(st.integers(-9, 9), st.integers(-9, 9)).map(sorted)


@few
@given(rows=ENDS, columns=ENDS)
def test_e27_what_lies_outside_is_neither_read_nor_counted(rows, columns) -> None:
    pixels = np.arange(4.0 * 5.0 * 4.0).reshape(5, 4, 4)
    found = read_average(Framebuffer(pixels.copy()), slice(*rows), slice(*columns))
    inside = [
        pixels[row, column]
        for row in range(*rows)
        for column in range(*columns)
        if 0 <= row < 5 and 0 <= column < 4
    ]
    assert (found is None) == (not inside)
    if found is not None:
        np.testing.assert_allclose(found, np.mean(inside, axis=0), rtol=1e-15)


def test_e27_a_white_buffer_reads_white_wherever_the_box_hangs() -> None:
    buffer = framebuffer(3, 3, color=[1, 1, 1, 1])
    for first in range(-4, 4):
        mean = read_average(buffer, slice(first, first + 2), slice(1, 40))
        inside = -2 < first < 3
        assert (mean is not None) == inside
        assert mean is None or (mean == 1.0).all()


@pytest.mark.parametrize("part", [slice(1), slice(0, None), slice(0, 4, 2)])
def test_an_average_needs_both_ends(part: slice) -> None:
    with pytest.raises(ValueError, match="columns: expected a slice of step 1 with bo"):
        read_average(framebuffer(4, 4), slice(0, 1), part)


def test_clear_honours_masks_and_scissor_and_nothing_else() -> None:
    buffer = framebuffer(3, 2, color=[0.5] * 4, depth=0.25, format="RGBA8")
    state = State(
        color_mask=(True, False, True, False),
        scissor=(slice(-3, 1), slice(1, 9)),
        depth_func="NEVER",
    )
    clear(buffer, [1, 1, 0, 1], depth=1.0, state=state)
    half = 128 / 255
    assert buffer.pixels[0, 1:].tolist() == [[1.0, half, 0.0, half]] * 2
    assert buffer.pixels[0, 0].tolist() == buffer.pixels[1, 2].tolist() == [half] * 4
    assert buffer.depth.tolist() == [[0.25, 1.0, 1.0], [0.25, 0.25, 0.25]]
    clear(buffer, None, depth=0.0)
    assert not buffer.depth.any()
    assert buffer.pixels[0, 1].tolist() == [1.0, half, 0.0, half]
    clear(buffer, None, depth=0.5, state=State(depth_mask=False))
    assert not buffer.depth.any()


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"format": "RGBA4"}, ValueError, "format: expected one of 'RGBA64F'"),
        ({"arithmetic": "d3d"}, ValueError, "arithmetic: expected one of 'ideal'"),
        ({"format": "RGBA8"}, ValueError, "pixels: expected numbers that RGBA8 holds"),
        ({"format": "RGBA16F"}, ValueError, "numbers that RGBA16F holds"),
        ({"depth": np.zeros((2, 3))}, ValueError, r"depth: .*\(2, 2\), got shape"),
        ({"depth": np.full((2, 2), 1.5)}, ValueError, r"depth: .*\[0, 1\], got 1.5"),
        ({"depth": 1.0}, TypeError, "depth: expected an array of float64"),
    ],
)
def test_other_formats_and_depths_are_refused(arguments, error, message) -> None:
    with pytest.raises(error, match=message):
        Framebuffer(np.full((2, 2, 4), 0.3), **arguments)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"scissor": (slice(0, 1), slice(0, None))}, "scissor: expected a slice of"),
        ({"depth_func": "CLOSER"}, "depth_func: expected one of 'NEVER'"),
        ({"color_mask": (True, True)}, "color_mask: expected 4 values, got 2"),
    ],
)
def test_a_wrong_state_is_refused(arguments, message) -> None:
    with pytest.raises(ValueError, match=message):
        State(**arguments)
