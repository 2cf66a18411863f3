"""Phase functions: they integrate to 1, have their mean cosine, and say forward."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.optics import PHASES, lobes

from refcloud.conventions import WHOLE_SPHERE
from refcloud.optics import (
    Medium,
    henyey_greenstein,
    isotropic,
    phase,
    rayleigh,
    rayleigh_man2003,
)

NODES, WEIGHTS = np.polynomial.legendre.leggauss(64)
# 1 - cos is known to one last bit of 1, that is 2e-16 of 5e-9 where g = 0.9999.
RESOLVED = 2e-7
cosines = st.floats(-1.0, 1.0)


def sphere(g: float) -> tuple[np.ndarray, np.ndarray]:
    """Give cosines and weights (steradian) that resolve a lobe of mean cosine g.

    The lobe is a power of s = (1 - |g|)^2 + 2 |g| (1 - cos): in log s it is smooth.
    """
    size = abs(g)
    if size < 0.1:
        return NODES, 2.0 * math.pi * WEIGHTS
    low, high = 2.0 * math.log1p(-size), 2.0 * math.log1p(size)
    s = np.exp(low + (high - low) * (NODES + 1.0) / 2.0)
    mu = np.clip(1.0 - (s - (1.0 - size) ** 2) / (2.0 * size), -1.0, 1.0)
    steps = WEIGHTS * (high - low) / 2.0 * s / (2.0 * size)
    return math.copysign(1.0, g) * mu, 2.0 * math.pi * steps


@given(lobes)
def test_e36_henyey_greenstein_integrates_to_1(g: float) -> None:
    mu, weights = sphere(g)
    assert weights @ henyey_greenstein(mu, g) == pytest.approx(1.0, abs=RESOLVED)


@given(lobes)
def test_its_mean_cosine_is_g(g: float) -> None:
    mu, weights = sphere(g)
    mean = weights @ (mu * henyey_greenstein(mu, g))
    assert mean == pytest.approx(g, abs=RESOLVED)


def test_e36_a_fixed_quadrature_misses_the_peak() -> None:
    mu = np.linspace(-1.0, 1.0, 200_001)
    values = 2.0 * math.pi * henyey_greenstein(mu, 0.999)
    assert np.trapezoid(values, mu) == pytest.approx(5.3, abs=0.05)


def test_e36_the_usual_form_loses_the_peak_in_single_precision() -> None:
    g = np.float32(0.999)
    base = np.float32(1.0) + g * g - np.float32(2.0) * g
    usual = (1.0 - 0.999**2) / (WHOLE_SPHERE * float(base) ** 1.5)
    exact = henyey_greenstein([1.0], 0.999)[0]
    assert exact == pytest.approx(1.999e-3 / (WHOLE_SPHERE * 1e-9), rel=1e-12)
    assert usual / exact == pytest.approx(0.9, abs=0.02)


@given(cosines, lobes)
def test_turning_the_lobe_around_mirrors_it(mu: float, g: float) -> None:
    assert henyey_greenstein([mu], g) == henyey_greenstein([-mu], -g)


@given(st.lists(cosines, min_size=2, max_size=8).map(sorted), lobes)
def test_a_forward_lobe_falls_away_from_forward(mu: list[float], g: float) -> None:
    values = henyey_greenstein(mu, abs(g))
    # Neighbours a last bit apart may round either way.
    assert (np.diff(values) >= -1e-15 * values[1:]).all()


@pytest.mark.parametrize("function", [isotropic, rayleigh])
def test_polynomial_phase_functions_integrate_to_1(function) -> None:
    assert 2.0 * math.pi * WEIGHTS @ function(NODES) == pytest.approx(1.0, abs=1e-15)
    assert WEIGHTS @ (NODES * function(NODES)) == pytest.approx(0.0, abs=1e-15)


@given(cosines)
def test_symmetric_ones_are_symmetric(mu: float) -> None:
    for function in (isotropic, rayleigh, rayleigh_man2003):
        assert function([mu]) == function([-mu])


def test_e20_eq_25_has_mean_1_and_rayleigh_holds_its_4_pi() -> None:
    assert WEIGHTS @ rayleigh_man2003(NODES) / 2.0 == pytest.approx(1.0, abs=1e-15)
    ratio = rayleigh_man2003(NODES) / rayleigh(NODES)
    np.testing.assert_allclose(ratio, WHOLE_SPHERE, rtol=1e-15)


def test_e21_rayleigh_alone_is_the_same_at_0_and_180_degrees() -> None:
    assert rayleigh_man2003([1.0, -1.0]).tolist() == [1.5, 1.5]
    forward, backward = henyey_greenstein([1.0, -1.0], 0.6)
    # ((1 + g) / (1 - g))^3: the 1.5 "for 180 degrees" cannot stand for both ends.
    assert forward / backward == pytest.approx(64.0)


@given(cosines, lobes, st.sampled_from(PHASES))
def test_phase_is_chosen_by_name_and_never_negative(mu, g, name) -> None:
    value = phase(Medium(1.0, g=g, phase=name), [mu])[0]
    one = {
        "hg": henyey_greenstein([mu], g),
        "rayleigh": rayleigh([mu]),
        "isotropic": isotropic([mu]),
    }[name][0]
    assert value == one > 0.0


@pytest.mark.parametrize("g", [-1.0, 1.0, 1.5, math.nan])
def test_a_lobe_that_is_a_ray_is_refused(g: float) -> None:
    with pytest.raises(ValueError, match="g: expected a finite number in"):
        henyey_greenstein([0.0], g)


@pytest.mark.parametrize("function", [isotropic, rayleigh, rayleigh_man2003])
def test_a_cosine_beyond_1_is_refused(function) -> None:
    with pytest.raises(ValueError, match="cos_theta: expected numbers in"):
        function([1.1])
