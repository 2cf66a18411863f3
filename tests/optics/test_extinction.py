"""Extinction and the light handed on: no form makes light, one survives splitting."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from twins.optics import depths, shares

from refcloud.optics import (
    ALBEDO_MAN2003,
    PHASE_MAN2003,
    TAU_MAN2003,
    beer_lambert,
    coupling_man2003,
    largest_steady_tau,
    scattered_man2003,
    scattered_split,
)

BIT = 2.3e-16  # one last bit of 1
thin = st.floats(0.0, 30.0)


@given(thin, thin)
def test_transmittances_multiply(a: float, b: float) -> None:
    product = beer_lambert([a])[0] * beer_lambert([b])[0]
    # The exponent is known to 60 times one last bit.
    assert beer_lambert([a + b])[0] == pytest.approx(product, rel=2e-14)


@given(depths)
def test_e24_more_depth_lets_less_through(tau: float) -> None:
    near, far = beer_lambert([tau, 2.0 * tau])
    assert 0.0 <= far <= near <= 1.0
    if 1e-8 < tau < 300.0:
        assert far < near < 1.0  # exp(+tau), as scan 000 prints it, would grow


@given(depths, shares)
@example(1e37, 1.0)
@example(0.0, 0.5)
def test_e23_held_scattering_makes_no_light(tau: float, kappa: float) -> None:
    g = scattered_man2003([tau], kappa)[0]
    assert 0.0 <= g
    assert g + beer_lambert([tau])[0] <= 1.0 + BIT


@given(depths, shares)
@example(1e37, 1.0)
def test_split_scattering_makes_no_light(tau: float, forward: float) -> None:
    g = scattered_split([tau], forward)[0]
    assert 0.0 <= g
    assert g + beer_lambert([tau])[0] <= 1.0 + BIT


@given(st.floats(1e-300, 0.999), st.floats(0.0, 1.0))
def test_the_guard_changes_nothing_in_the_steady_range(kappa, share) -> None:
    tau = share * min(largest_steady_tau(kappa), 1e37)
    # At the limit itself both branches of the guard meet within rounding.
    expected = pytest.approx(kappa * tau, rel=1e-12)
    assert scattered_man2003([tau], kappa)[0] == expected


@given(st.floats(0.0, 40.0), shares, st.integers(1, 50))
def test_split_scattering_survives_splitting(tau, forward, parts) -> None:
    def passed(depth: float) -> float:
        return scattered_split([depth], forward)[0] + beer_lambert([depth])[0]

    # Fifty factors of rounding, and exponents of up to 40.
    assert passed(tau / parts) ** parts == pytest.approx(passed(tau), rel=1e-12)


def test_the_papers_form_does_not_survive_splitting() -> None:
    kappa = coupling_man2003()
    passed = [
        (scattered_man2003([8.0 / n], kappa)[0] + math.exp(-8.0 / n)) ** n
        for n in (1, 2, 8)
    ]
    assert passed == pytest.approx([0.860, 0.201, 0.0026], rel=0.01)


def test_e22_a_solid_angle_brings_the_constants_of_two_sources_together() -> None:
    skyworks = 80.0 * coupling_man2003(0.9, 1.0, solid_angle=0.09)
    assert skyworks == pytest.approx(0.516, abs=5e-4)
    assert 1.5 * skyworks == pytest.approx(0.773, abs=1e-3)
    man = TAU_MAN2003 * coupling_man2003(ALBEDO_MAN2003, PHASE_MAN2003)
    assert man == pytest.approx(0.859, abs=1e-3)
    assert 80.0 * 0.09 == pytest.approx(TAU_MAN2003, rel=0.11)


@pytest.mark.parametrize(
    ("kappa", "limit"),
    [
        (coupling_man2003(), 9.308),
        (coupling_man2003(1.0), 8.376),
        (coupling_man2003(p=3.0), 4.61),
        (0.5, 1.594),
    ],
)
def test_e23_beyond_the_limit_eq_26_makes_light(kappa: float, limit: float) -> None:
    found = largest_steady_tau(kappa)
    assert found == pytest.approx(limit, rel=1e-3)
    assert kappa * found + math.exp(-found) == pytest.approx(1.0, abs=1e-14)
    assert kappa * 1.01 * found + math.exp(-1.01 * found) > 1.0
    # A hundred such balls in a row: the printed form explodes, the guarded one holds.
    tau = 1.3 * found
    assert (kappa * tau + math.exp(-tau)) ** 100 > 1e6
    assert (scattered_man2003([tau], kappa)[0] + math.exp(-tau)) ** 100 <= 1.0 + 1e-13


def test_e23_a_coupling_of_1_makes_light_at_any_depth() -> None:
    forgotten = coupling_man2003(solid_angle=4.0 * math.pi)
    assert forgotten == pytest.approx(1.35)
    assert largest_steady_tau(forgotten) == largest_steady_tau(1.0) == 0.0
    with pytest.raises(ValueError, match="kappa: expected a finite number in"):
        scattered_man2003([1.0], forgotten)


def test_e23_refusing_is_one_named_line() -> None:
    kappa = coupling_man2003()
    within = scattered_man2003([9.3], kappa, gain="refuse")
    assert within == scattered_man2003([9.3], kappa)
    with pytest.raises(ValueError, match=r"tau: expected at most 9\.308.*got 9\.4"):
        scattered_man2003([1.0, 9.4], kappa, gain="refuse")


@given(st.floats(0.0, 1.0))
def test_the_limit_falls_as_the_coupling_grows(kappa: float) -> None:
    limit = largest_steady_tau(kappa)
    assert limit >= largest_steady_tau(min(1.01 * kappa, 1.0))
    if 0.0 < kappa < 1.0 and math.isfinite(limit):
        assert -math.log(kappa) * (1.0 - 1e-12) <= limit <= 1.0 / kappa


@pytest.mark.parametrize("kappa", [0.0, 5e-324, 1e-310])
def test_hardly_any_coupling_has_no_limit(kappa: float) -> None:
    assert largest_steady_tau(kappa) == math.inf
    assert scattered_man2003([1e37], kappa)[0] <= 1e37 * kappa


@pytest.mark.parametrize("tau", [-1.0, math.nan, math.inf])
def test_depths_that_are_none_are_refused(tau: float) -> None:
    for function in (
        beer_lambert,
        lambda t: scattered_split(t, 0.5),
        lambda t: scattered_man2003(t, 0.5),
    ):
        with pytest.raises(ValueError, match="tau: expected"):
            function(np.array([tau]))
