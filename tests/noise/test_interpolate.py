"""Interpolants: laws of each, their ranges (E12) and their measured orders (E13)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.noise import INTERPOLANTS, TWO_POINT, lattice_values, unit

import refcloud.noise as noise
from refcloud.noise import catmull_rom, cubic, hermite, quintic, taps
from refcloud.noise.weights import PEAKS

FOUR_POINT = sorted(set(INTERPOLANTS) - set(TWO_POINT))
ROUNDING = 5e-15  # quintic's terms reach 15; worst seen 1.8e-15

four_values = st.tuples(*[lattice_values] * 4)


def applied(name: str, values: tuple, t: object) -> np.ndarray:
    """Interpolate four neighbours, of which some forms need the middle two."""
    function = getattr(noise, name)
    return function(*(values[1:3] if name in TWO_POINT else values), t)


@pytest.mark.parametrize("name", INTERPOLANTS)
@given(four_values, unit)
def test_taps_are_the_interpolant_as_weights(name: str, values: tuple, t: float):
    weights, offsets = taps(name, t)
    neighbours = np.array(values)[offsets + 1]
    assert weights @ neighbours == pytest.approx(applied(name, values, t), abs=ROUNDING)
    assert weights.sum() == pytest.approx(1.0, abs=ROUNDING)


@pytest.mark.parametrize("name", INTERPOLANTS)
@given(four_values)
def test_the_ends_are_the_two_values(name: str, values: tuple) -> None:
    assert applied(name, values, 0.0) == pytest.approx(values[1], abs=ROUNDING)
    assert applied(name, values, 1.0) == pytest.approx(values[2], abs=ROUNDING)


@pytest.mark.parametrize("name", INTERPOLANTS)
@given(four_values, unit)
def test_both_directions_agree(name: str, values: tuple, t: float) -> None:
    back = applied(name, values[::-1], 1.0 - t)
    assert applied(name, values, t) == pytest.approx(back, abs=ROUNDING)


@pytest.mark.parametrize("name", TWO_POINT)
@given(four_values, unit)
def test_two_point_forms_stay_within_the_unit_range(name: str, values: tuple, t: float):
    assert abs(applied(name, values, t)) <= 1.0  # to the last bit


@pytest.mark.parametrize("name", FOUR_POINT)
@given(four_values, unit)
def test_e12_four_point_forms_stay_within_their_peak(name: str, values: tuple, t):
    assert abs(applied(name, values, t)) <= PEAKS[name] + ROUNDING


def test_e12_cubic_reaches_three_halves_and_catmull_rom_five_quarters() -> None:
    assert cubic(-1.0, 1.0, 1.0, -1.0, 0.5) == 1.5
    assert catmull_rom(-1.0, 1.0, 1.0, -1.0, 0.5) == 1.25
    t = np.linspace(0.0, 1.0, 1001)
    for name in FOUR_POINT:
        assert np.abs(taps(name, t)[0]).sum(axis=0).max() == PEAKS[name]


@given(four_values)
def test_e12_cubic_slopes_are_twice_those_of_catmull_rom(values: tuple) -> None:
    h = 2.0**-20
    steps = [
        np.array([f(*values, h) - f(*values, 0.0), f(*values, 1.0) - f(*values, 1 - h)])
        for f in (cubic, catmull_rom)
    ]
    # Second differences: curvature at most 16 over a step of h.
    np.testing.assert_allclose(steps[0] / h, 2.0 * steps[1] / h, rtol=0, atol=32 * h)


@given(lattice_values, lattice_values, unit)
def test_e12_catmull_rom_keeps_straight_lines_and_cubic_does_not(start, slope, t):
    line = tuple(start + slope * k for k in (-1, 0, 1, 2))
    expected = start + slope * t
    assert catmull_rom(*line, t) == pytest.approx(expected, abs=ROUNDING)
    # The paper's cubic leaves the line by slope t (1 - t) (1 - 2 t).
    bend = slope * t * (1.0 - t) * (1.0 - 2.0 * t)
    assert cubic(*line, t) == pytest.approx(expected + bend, abs=ROUNDING)


def order(name: str) -> float:
    """Measure the exponent of the error in the spacing, on a sine."""
    errors = []
    for cells in (64, 128):
        h = 2.0 * math.pi / cells
        values = np.sin(h * np.arange(-1, cells + 2))
        t = np.linspace(0.0, 1.0, 33)
        k = np.arange(cells)[:, None]
        weights, offsets = taps(name, t)
        joined = sum(
            w * values[k + o + 1] for w, o in zip(weights, offsets, strict=True)
        )
        errors.append(np.abs(joined - np.sin(h * (k + t))).max())
    return math.log2(errors[0] / errors[1])


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("linear", 2),
        ("cosine", 1),
        ("hermite", 1),
        ("quintic", 1),
        ("cubic", 1),
        ("catmull_rom", 3),
    ],
)
def test_e13_order_of_the_error(name: str, expected: int) -> None:
    # At 64 cells the next term of the error is a few per cent of the first.
    assert order(name) == pytest.approx(expected, abs=0.05)


def test_hermite_is_flat_and_quintic_straight_at_the_ends() -> None:
    h = 2.0**-10
    for f, curvature in ((hermite, 6.0), (quintic, 0.0)):
        first, second = float(f(0.0, 1.0, h)), float(f(0.0, 1.0, 2.0 * h))
        assert first / h == pytest.approx(0.0, abs=4 * h)
        # The third derivative (60 at most) moves a second difference by h times it.
        assert (second - 2.0 * first) / h**2 == pytest.approx(curvature, abs=61 * h)


@pytest.mark.parametrize("name", INTERPOLANTS)
@pytest.mark.parametrize("t", [-1e-9, 1.0 + 1e-9, math.nan, math.inf])
def test_places_outside_the_cell_are_refused(name: str, t: float) -> None:
    with pytest.raises(ValueError, match=r"^t: expected"):
        applied(name, (0.0, 0.0, 1.0, 1.0), t)


def test_unknown_interpolant_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^interpolant: expected one of 'linear'"):
        taps("Linear", 0.5)
