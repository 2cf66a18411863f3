"""Kernels: their shape, their integrals as exact fractions, and errata E01-E04, E17."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refcloud.metaballs import (
    axis_depth,
    chord,
    gaussian,
    integral,
    normalisation,
    printed_wyvill,
    profile,
    wyvill,
)
from refcloud.metaballs import integrals as exact
from refcloud.metaballs import kernels as table
from refcloud.metaballs.kernels import slope_of

KERNELS = ["wyvill", "gaussian"]
NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)  # on [-1, 1]
HALF_NODES, HALF_WEIGHTS = (NODES + 1.0) / 2.0, WEIGHTS / 2.0  # on [0, 1]

ratios = st.floats(0.0, 1.0)


def test_wyvill_at_centre_half_and_rim():
    assert wyvill([0.0, 1.0, 2.0], 2.0).tolist() == [1.0, 0.5, 0.0]
    assert profile([0.0, 0.25, 1.0]).tolist() == [1.0, 0.5, 0.0]


def test_wyvill_reaches_the_rim_without_a_bend():
    assert slope_of(np.array([1.0]), "wyvill")[0] == 0.0
    # As polynomials of a = r/R, exactly: f(1) = f'(1) = 0 and f(1/2) = 1/2.
    c = table.WYVILL
    assert sum(c) == 0
    assert sum(2 * k * c[k] for k in range(4)) == 0
    assert sum(c[k] * Fraction(1, 4) ** k for k in range(4)) == Fraction(1, 2)


@pytest.mark.parametrize("kernel", KERNELS)
@given(a=ratios, b=ratios)
def test_kernels_and_chords_fall_outward_within_0_and_1(kernel, a, b):
    low, high = sorted((a, b))
    for function in (profile, chord):
        near, far = function([low, high], kernel)
        assert 0.0 <= far <= near * (1.0 + 1e-15) <= 1.0 + 1e-15


@pytest.mark.parametrize("kernel", KERNELS)
@given(q=st.floats(1.0, 1e300))
def test_nothing_is_outside(kernel, q):
    assert profile(q, kernel) == 0.0
    assert chord(q, kernel) == 0.0


@given(r=st.floats(0.0, 1e300), R=st.floats(1e-300, 1e300))
def test_any_distance_and_radius_give_a_share(r, R):
    for function in (wyvill, gaussian):
        assert 0.0 <= function(r, R) <= 1.0


@pytest.mark.parametrize("kernel", KERNELS)
@given(q=st.floats(0.01, 0.99))
def test_slope_is_the_derivative(kernel, q):
    h = 1e-5  # the difference is off by f''' h^2 / 6, below 1e-9
    ends = profile([q - h, q + h], kernel)
    slope = slope_of(np.array([q]), kernel)[0]
    assert slope == pytest.approx((ends[1] - ends[0]) / (2 * h), abs=2e-8)


def test_e01_the_printed_sign_grows_outward_and_jumps():
    r = np.linspace(0.0, 1.0, 101)
    printed = printed_wyvill(r, 1.0)
    assert np.all(np.diff(printed) > 0.0)
    assert printed[-1] == pytest.approx(44 / 9, abs=1e-15)
    assert printed_wyvill(1.0 + 1e-12, 1.0) == 0.0
    assert np.all(np.diff(wyvill(r, 1.0)) < 0.0)


def moments(coefficients) -> list[Fraction]:
    """Integrate a polynomial of a^2 over line, disc and ball: over 1, pi and pi."""
    terms = list(enumerate(coefficients))
    return [
        sum((2 * c / (2 * k + 1) for k, c in terms), Fraction(0)),
        sum((2 * c / (2 * k + 2) for k, c in terms), Fraction(0)),
        sum((4 * c / (2 * k + 3) for k, c in terms), Fraction(0)),
    ]


def test_the_fractions_are_the_exact_integrals():
    expected = [exact.WYVILL_LINE, exact.WYVILL_DISC, exact.WYVILL_VOLUME]
    assert moments(table.WYVILL) == expected
    # The chord through the centre, and its integral over the disc, say the same.
    c5, c7 = table.WYVILL_CHORD
    assert c5 + c7 == exact.WYVILL_LINE
    assert c5 * Fraction(2, 7) + c7 * Fraction(2, 9) == exact.WYVILL_VOLUME


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_integrals_equal_gauss_quadrature(kernel, dimension):
    sphere = {1: 2.0, 2: 2.0 * math.pi, 3: 4.0 * math.pi}[dimension]
    values = profile(HALF_NODES**2, kernel) * HALF_NODES ** (dimension - 1)
    expected = sphere * float(HALF_WEIGHTS @ values)
    assert integral(kernel, dimension) == pytest.approx(expected, rel=1e-14)
    assert integral(kernel, dimension, R=3.0) == pytest.approx(
        expected * 3.0**dimension, rel=1e-14
    )


@pytest.mark.parametrize("kernel", KERNELS)
@given(q=st.floats(0.0, 0.999))
def test_e04_chord_equals_quadrature_along_the_line(kernel, q):
    s = math.sqrt(1.0 - q)
    values = profile(q + (s * NODES) ** 2 * (1.0 - 1e-16), kernel)
    assert chord(q, kernel) == pytest.approx(s * float(WEIGHTS @ values), abs=1e-14)


def test_e04_the_footprint_is_not_the_profile():
    b = np.linspace(0.0, 1.0, 1001)
    off = np.abs(chord(b**2) / chord(0.0) - profile(b**2))
    assert off.max() == pytest.approx(0.065, abs=5e-4)
    assert b[off.argmax()] == pytest.approx(0.57, abs=5e-3)


@given(q=ratios)
def test_gaussian_chord_equals_erf(q):
    # Worst seen 8.9e-16 of the value on 10,001 places, times 10.
    expected = (
        math.sqrt(math.pi)
        / 2.0
        * math.exp(-4.0 * q)
        * math.erf(2.0 * math.sqrt(1.0 - q))
    )
    assert chord(q, "gaussian") == pytest.approx(expected, rel=1e-14, abs=1e-15)


def test_gaussian_series_is_long_enough():
    # The rest is below its first term over 1 - 8/63, and the sum is 24.
    first = 8.0**table.GAUSSIAN_TERMS / math.prod(
        range(1, 2 * table.GAUSSIAN_TERMS + 2, 2)
    )
    assert first / (1 - 8 / 63) / 24.0 < 4e-17


@pytest.mark.parametrize("kernel", KERNELS)
@given(R=st.floats(1e-3, 1e3))
def test_e02_peak_and_volume_do_what_they_say_and_the_paper_neither(kernel, R):
    assert normalisation(kernel, "peak", R=R) == 1.0
    volume = 4.0 * math.pi * R**3
    ball = volume * float(
        HALF_WEIGHTS @ (profile(HALF_NODES**2, kernel) * HALF_NODES**2)
    )
    assert ball / normalisation(kernel, "volume", R=R) == pytest.approx(1.0, rel=1e-14)


def test_e02_the_papers_k_is_no_integral_of_the_kernel():
    k = normalisation("wyvill", "paper", R=2.0)
    assert k == pytest.approx(748 / 405 * math.pi * 2.0, rel=1e-15)
    for dimension in (1, 2, 3):
        assert abs(k / integral("wyvill", dimension, R=2.0) - 1.0) > 0.5


def test_e03_the_density_at_the_centre_is_the_balls_only_with_k_1():
    assert wyvill(0.0, 5.0) / normalisation("wyvill") == 1.0
    assert wyvill(0.0, 5.0) / normalisation("wyvill", "paper", R=5.0) < 0.04


def test_e17_gaussian_has_no_half_and_leaves_two_percent_at_the_cut():
    assert gaussian(1.0, 1.0) == math.exp(-1.0)
    assert gaussian(2.0, 1.0) == pytest.approx(0.018, abs=5e-4)
    assert profile(np.nextafter(1.0, 0.0), "gaussian") == pytest.approx(math.exp(-4.0))


def test_e17_gaussian_of_175_sigma_is_nearest_to_wyvill():
    a = np.linspace(0.0, 1.0, 2001)
    cuts = np.arange(1.5, 2.3, 0.01)
    rms = [
        np.sqrt(np.mean((np.exp(-((u * a) ** 2)) - wyvill(a, 1.0)) ** 2)) for u in cuts
    ]
    assert cuts[np.argmin(rms)] == pytest.approx(1.75, abs=0.03)
    assert min(rms) == pytest.approx(0.036, abs=2e-3)


@pytest.mark.parametrize("kernel", KERNELS)
def test_axis_depth_is_the_chord_through_the_centre(kernel):
    depth = axis_depth(2.0, [0.5], [3.0], kernel)
    assert depth[0] == pytest.approx(2.0 * 0.5 * 3.0 * chord(0.0, kernel), rel=1e-15)
    assert axis_depth(1.0, [1.0], [1.0])[0] == 944 / 945


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: wyvill(-1.0, 1.0), "r: expected numbers in"),
        (lambda: wyvill(1.0, 0.0), "R: expected numbers in"),
        (lambda: profile(-0.1), "q: expected numbers in"),
        (lambda: profile(np.nan), "q: expected finite"),
        (lambda: profile(0.1, "cosine"), "kernel: expected one of 'wyvill'"),
        (lambda: integral("wyvill", 4), "dimension: expected one of 1, 2, 3"),
        (lambda: axis_depth(1.0, [1.0], [1.0, 2.0]), "radii: expected an array"),
    ],
)
def test_refusals_name_the_argument(call, message):
    with pytest.raises(ValueError, match=message):
        call()
