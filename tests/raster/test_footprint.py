"""Patches at every border, footprints, and the two laws of transmittance."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from refcloud.raster import footprint, patch, transmittance
from refcloud.raster.footprint import opacity_of

PLACE = st.floats(-40.0, 60.0)
SIZE = st.integers(1, 24)
# 0.01 to 1e8 pixels, and often of the buffer's own size.
RADIUS = st.floats(0.4, 12.0) | st.floats(-2, 8).map(lambda power: 10.0**power)
WEIGHT = arrays(np.float64, 7, elements=st.floats(0.0, 1.0))
KERNEL = st.sampled_from(["wyvill", "gaussian"])
NAME = st.sampled_from(["chord", "profile"])
LAW = st.sampled_from(["beer", "linear"])


def whole_q(x: float, y: float, radius: float, width: int, height: int) -> np.ndarray:
    across = (np.arange(width) + 0.5 - x) / radius
    down = (np.arange(height) + 0.5 - y) / radius
    return across**2 + down[:, None] ** 2


@given(x=PLACE, y=PLACE, radius=RADIUS, width=SIZE, height=SIZE)
@example(x=0.0, y=0.0, radius=0.5, width=1, height=1)
@example(x=24.0, y=12.0, radius=1e8, width=24, height=24)
@example(x=-5.0, y=3.0, radius=5.5, width=8, height=8)
def test_patch_holds_every_pixel_of_the_ball(x, y, radius, width, height) -> None:
    q = whole_q(x, y, radius, width, height)
    found = patch(x, y, radius, width, height)
    if found is None:
        assert not (q < 1.0).any()
        return
    rows, columns = found.rows, found.columns
    assert 0 <= rows.start < rows.stop <= height
    assert 0 <= columns.start < columns.stop <= width
    np.testing.assert_array_equal(found.q, q[rows, columns])
    outside = np.ones(q.shape, bool)
    outside[rows, columns] = False
    # A pixel on the rim itself may fall to either side by a last bit.
    assert (q[outside] >= 1.0 - 1e-12).all()


@given(x=PLACE, y=PLACE, radius=RADIUS, width=SIZE, height=SIZE)
def test_patch_is_no_larger_than_the_bounding_square(
    x, y, radius, width, height
) -> None:
    found = patch(x, y, radius, width, height)
    assume(found is not None)
    assert found is not None
    centres = np.arange(width) + 0.5, np.arange(height) + 0.5
    for part, centre, middle in zip(
        (found.columns, found.rows), centres, (x, y), strict=True
    ):
        inside = np.abs(centre - middle) <= radius * (1 + 1e-12) + 1e-12
        assert inside[part].all()


@pytest.mark.parametrize("radius", [1e-300, 5e-324, 0.01, 1e8, 1e300, 1.7e308])
@pytest.mark.parametrize("place", [-1e308, -1e9, 0.0, 0.5, 4.5, 1e9, 1.7e308])
def test_patch_stands_any_size(radius: float, place: float) -> None:
    found = patch(place, 2.5, radius, 8, 8)
    if found is not None:
        assert np.isfinite(found.q).all()
        assert found.q.size <= 64


def test_a_ball_between_pixel_centres_touches_none() -> None:
    assert patch(1.0, 1.0, 0.4, 4, 4) is None
    found = patch(1.0, 1.0, 0.5, 4, 4)
    assert found is not None
    assert found.q.tolist() == [[2.0, 2.0], [2.0, 2.0]]


@given(KERNEL, NAME, arrays(np.float64, 20, elements=st.floats(0.0, 4.0)))
def test_footprint_falls_from_1_to_0(kernel, name, q) -> None:
    weight = footprint(np.sort(q), kernel=kernel, name=name)
    assert (weight >= 0.0).all()
    assert (weight <= 1.0).all()
    assert (np.diff(weight) <= 1e-15).all()
    assert not weight[np.sort(q) >= 1.0].any()
    assert footprint(np.zeros(1), kernel=kernel, name=name)[0] == pytest.approx(
        1.0, abs=2e-16
    )


def test_e04_chord_and_profile_differ_by_no_more_than_0_065() -> None:
    b = np.linspace(0.0, 1.0, 100_001)
    gap = footprint(b**2, name="profile") - footprint(b**2, name="chord")
    assert gap.max() == pytest.approx(0.065, abs=5e-4)
    assert b[gap.argmax()] == pytest.approx(0.57, abs=5e-3)
    assert gap.min() >= -1e-15, "the chord's footprint is the narrower one"


@given(q=st.floats(0.0, 0.999), kernel=KERNEL)
def test_chord_is_the_integral_along_the_line_of_sight(q, kernel) -> None:
    # Gauss-Legendre with 40 nodes is exact for polynomials up to degree 79.
    nodes, weights = np.polynomial.legendre.leggauss(40)

    def along(q: float) -> float:
        half = math.sqrt(1.0 - q)
        inside = np.minimum(q + (half * nodes) ** 2, 1.0 - 1e-16)
        return half * float(weights @ footprint(inside, kernel=kernel, name="profile"))

    expected = along(q) / along(0.0)
    actual = footprint(np.array([q]), kernel=kernel, name="chord")[0]
    assert actual == pytest.approx(expected, abs=1e-13)


@given(weight=WEIGHT, tau=st.floats(0.0, 1e3), law=LAW)
def test_transmittance_lies_between_0_and_1(weight, tau, law) -> None:
    T = transmittance(weight, tau, law=law)
    assert (T >= 0.0).all()
    assert (T <= 1.0).all()
    # 1 - T is formed with one more rounding.
    np.testing.assert_allclose(opacity_of(weight, tau, law), 1.0 - T, atol=3e-16)


@given(weight=WEIGHT, a=st.floats(0.0, 20.0), b=st.floats(0.0, 20.0))
def test_beer_multiplies_where_depths_add(weight, a, b) -> None:
    both = transmittance(weight, a + b)
    np.testing.assert_allclose(
        both, transmittance(weight, a) * transmittance(weight, b), rtol=4e-14
    )  # the exponent, up to 40, is rounded: 40 x 2e-16 x 3, and a margin


@given(tau=st.floats(0.0, 1e3))
def test_laws_agree_on_the_axis_and_outside(tau) -> None:
    ends = np.array([0.0, 1.0])
    np.testing.assert_allclose(
        transmittance(ends, tau, law="beer"),
        transmittance(ends, tau, law="linear"),
        atol=2e-16,
    )


@given(weight=WEIGHT, tau=st.floats(0.0, 1e3))
def test_the_linear_law_lets_more_light_through(weight, tau) -> None:
    gap = transmittance(weight, tau, law="linear") - transmittance(weight, tau)
    assert (gap >= -3e-16).all()


@pytest.mark.parametrize(
    ("tau", "largest", "digits"),
    [(0.1, 0.0012, 5e-5), (1, 0.078, 5e-4), (8, 0.615, 5e-4)],
)
def test_e25_largest_gap_of_the_two_laws(tau, largest, digits) -> None:
    w = np.linspace(0.0, 1.0, 100_001)
    gap = np.abs(transmittance(w, tau) - transmittance(w, tau, law="linear"))
    assert gap.max() == pytest.approx(largest, abs=digits)


@pytest.mark.parametrize("tau", [-1.0, math.nan, math.inf])
def test_a_wrong_depth_is_refused(tau: float) -> None:
    with pytest.raises(ValueError, match="tau: expected a finite number in"):
        transmittance([0.5], tau)


@pytest.mark.parametrize("radius", [0.0, -1.0, math.nan, math.inf])
def test_a_wrong_radius_is_refused(radius: float) -> None:
    with pytest.raises(ValueError, match="radius: expected a finite number in"):
        patch(0.0, 0.0, radius, 4, 4)
