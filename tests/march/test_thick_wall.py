"""Voxels far thicker than light goes, against the closed answer for a thick wall.

The light that leaves a wall without end depends on no scale: how density rises toward
it does not matter. Chandrasekhar's law for isotropic scattering gives it, so it tells
what the lattice of voxels loses where it is too coarse for the light.
"""

from __future__ import annotations

import numpy as np
import pytest

from refcloud.cloudmap import VoxelGrid
from refcloud.march import integrate
from refcloud.optics import Medium, Sun

ALBEDO = 0.9


X, WEIGHTS = np.polynomial.legendre.leggauss(80)
NODES, WEIGHTS = (X + 1.0) / 2.0, WEIGHTS / 2.0


def h_at(mu: np.ndarray, albedo: float) -> np.ndarray:
    """Give Chandrasekhar's H for isotropic scattering, by iterating its equation."""

    def step(at: np.ndarray, H: np.ndarray) -> np.ndarray:
        gained = (WEIGHTS * NODES * H / (at[:, None] + NODES)).sum(axis=1)
        return 1.0 / (np.sqrt(1.0 - albedo) + albedo / 2.0 * gained)

    H = np.ones(len(NODES))
    for _ in range(200):
        H = step(NODES, H)
    return step(mu, H)


def reflected(albedo: float, mu: float, mu0: float) -> float:
    """Give a wall's radiance, irradiance 4 pi: a H(mu) H(mu0) mu0 / (mu + mu0)."""
    ends = h_at(np.array([mu, mu0]), albedo)
    return float(albedo * ends.prod() * mu0 / (mu + mu0))


@pytest.mark.parametrize("albedo", [0.1, 0.5, 0.9, 0.99])
def test_the_integral_of_h_has_its_closed_form(albedo: float) -> None:
    mean = (WEIGHTS * h_at(NODES, albedo)).sum()
    closed = 2.0 / albedo * (1.0 - np.sqrt(1.0 - albedo))
    assert mean == pytest.approx(closed, rel=1e-9)


# By optical depth of a voxel: what "finest" loses at most, seen .19 to .35, .58 to .65,
# .70 and .70, for a sun behind the eye and 60 degrees off.
LOST = {3.0: 0.4, 30.0: 0.7, 1e3: 0.75, 1e4: 0.75}


@pytest.mark.slow
@pytest.mark.parametrize("tau", LOST)
@pytest.mark.parametrize("mu0", [1.0, 0.5])
def test_a_wall_of_thick_voxels_loses_what_is_stated(tau: float, mu0: float) -> None:
    density = np.zeros((8, 14, 14))
    density[1:7, 1:13, 1:13] = 1.0
    grid = VoxelGrid(density, np.zeros(3), np.array([14.0, 14.0, 8.0]))
    how = {
        "suns": Sun(np.array([np.sqrt(1.0 - mu0**2), 0.0, mu0])),
        "medium": Medium(tau, albedo=ALBEDO, phase="isotropic"),
    }
    ray = np.array([[7.2, 7.1, 30.0]]), np.array([[0.0, 0.0, -1.0]])
    once, _ = integrate(grid, *ray, **how)
    L, _ = integrate(grid, *ray, **how, scattering="multiple")
    exact = ALBEDO * mu0 / (1.0 + mu0)
    assert once[0, 0] == pytest.approx(exact, rel=1e-3)
    assert exact * (1.0 - 1e-3) <= L[0, 0] <= reflected(ALBEDO, 1.0, mu0)
    assert L[0, 0] >= (1.0 - LOST[tau]) * reflected(ALBEDO, 1.0, mu0)
