"""Prepared beams give what the sweep gives; directions and harmonics are exact."""

from __future__ import annotations

import numpy as np
import pytest
from small_lights import cloud

from refcloud.conventions import WHOLE_SPHERE
from refcloud.optics import Medium, henyey_greenstein
from refcloud.transport import (
    delta_m,
    harmonics,
    legendre_moments,
    smooth_phase,
    sphere_directions,
    sweep,
)
from refcloud.transport.beams import prepare
from refcloud.transport.mixing import fixed_point
from refcloud.transport.swept import swept_terms

COUNTS = [26, 50, 128]


@pytest.mark.parametrize("cell", [(0.1, 0.1, 0.1), (0.1, 0.15, 0.08)])
@pytest.mark.parametrize("count", COUNTS)
def test_prepared_beams_give_what_the_sweep_gives(count: int, cell) -> None:
    extinction = 20.0 * cloud(shape=(5, 6, 7)).density
    directions = sphere_directions(count)
    beams = prepare(extinction, directions, cell=np.array(cell), batch=2)
    M = len(beams.near[0])
    terms = np.sin(np.arange(3 * 2 * M)).reshape(3, 2, M)
    to_source = np.cos(np.arange(count * 3)).reshape(count, 3)
    to_terms = np.sin(np.arange(4 * count)).reshape(4, count)
    found = swept_terms(terms, beams, to_source, to_terms)
    for case in range(2):
        source = np.zeros((count, *extinction.shape))
        source[(slice(None), *beams.near)] = to_source @ terms[:, case]
        radiance = sweep(source, extinction, directions, cell=cell)
        expected = np.tensordot(to_terms, radiance, 1)[(slice(None), *beams.near)]
        # Sums of up to 128 directions in another order.
        np.testing.assert_allclose(found[:, case], expected, atol=1e-11)


@pytest.mark.parametrize(("count", "degree"), [(26, 7), (50, 11), (128, 15)])
def test_directions_integrate_polynomials_exactly(count: int, degree: int) -> None:
    chosen = sphere_directions(count)
    Y = harmonics(chosen.vectors, degree)
    expected = np.zeros((degree + 1) ** 2)
    expected[0] = np.sqrt(WHOLE_SPHERE)
    np.testing.assert_allclose(chosen.weights @ Y, expected, atol=1e-13)
    assert 2 * chosen.degree <= degree
    opposite = {tuple(v) for v in (-chosen.vectors).round(12) + 0.0}
    assert opposite == {tuple(v) for v in chosen.vectors.round(12) + 0.0}


def test_harmonics_add_up_to_legendre_polynomials() -> None:
    a, b = np.array([0.36, 0.48, 0.8]), np.array([-0.6, 0.0, 0.8])
    Y = harmonics(a, 7) * harmonics(b, 7)
    for l in range(8):
        moments = np.zeros(8)
        moments[l] = 1.0
        expected = float(smooth_phase(moments, np.array(a @ b)))
        assert Y[l * l : (l + 1) ** 2].sum() == pytest.approx(expected, abs=1e-13)


@pytest.mark.parametrize("g", [-0.5, 0.0, 0.3, 0.6])
def test_many_moments_are_the_phase_function(g: float) -> None:
    mu = np.linspace(-1, 1, 9)
    moments = legendre_moments(Medium(1.0, g=g, phase="hg"), 64)
    # The first term that is left out is 129 g^65 / 4 pi: 4e-14 at g = 0.6.
    np.testing.assert_allclose(
        smooth_phase(moments, mu), henyey_greenstein(mu, g), atol=1e-12
    )


def test_scaling_keeps_what_is_absorbed_and_the_mean_cosine() -> None:
    medium = Medium(2.0, [1.0, 0.9, 0.0], 0.8, "hg")
    scaled = delta_m(medium, 3)
    absorbed = medium.sigma_t_rgb * (1.0 - medium.albedo_rgb)
    np.testing.assert_allclose(scaled.sigma_t * (1.0 - scaled.albedo), absorbed)
    reduced = medium.sigma_t_rgb * (1.0 - 0.8 * medium.albedo_rgb)
    after = scaled.sigma_t * (1.0 - scaled.moments[1] * scaled.albedo)
    np.testing.assert_allclose(after, reduced)


@pytest.mark.parametrize("memory", [0, 1, 5])
def test_mixing_finds_a_fixed_point_sooner_than_plain_steps(memory: int) -> None:
    matrix = 0.9 * np.diag(np.linspace(0.1, 1.0, 6))
    wanted = np.arange(1.0, 7.0)
    found = fixed_point(
        lambda x: wanted - matrix @ wanted + matrix @ x,
        np.zeros(6),
        tolerance=1e-10,
        most=400,
        memory=memory,
    )
    assert found.converged
    np.testing.assert_allclose(found.value, wanted, atol=1e-7)
    assert found.iterations <= {0: 220, 1: 120, 5: 25}[memory]


def test_mixing_ends_when_it_may_go_no_further() -> None:
    found = fixed_point(lambda x: 2.0 * x + 1.0, np.ones(3), tolerance=0.0, most=3)
    assert found.iterations <= 3
    assert not found.converged or found.residual == 0.0


def test_harmonics_take_unit_vectors() -> None:
    with pytest.raises(ValueError, match=r"^vectors: expected numbers in \[-1, 1\]"):
        harmonics([[1e300, 0.0, 0.0]], 2)
    rounded = np.array([[0.6, 0.0, 0.8]], dtype=np.float32)  # of length 1.00000003
    exact = harmonics([[0.6, 0.0, 0.8]], 2)
    np.testing.assert_allclose(harmonics(rounded, 2), exact, atol=1e-6)
