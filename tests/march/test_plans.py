"""Plans keep the errors that `plan_for` counts with, and those that the issue asks."""

from __future__ import annotations

import numpy as np
import pytest

from refcloud.bench.scattering import SUN, apart, lumpy, view
from refcloud.cloudmap import VoxelGrid
from refcloud.march import integrate
from refcloud.optics import Medium, Sun, phase
from refcloud.transport import PLANS, scattered_light, trace_paths
from refcloud.transport.plans import ERRORS, FEW, plan_for


def picture(grid, sun: Sun, medium: Medium, plan: str) -> np.ndarray:
    light = scattered_light(grid, sun, medium=medium, plan=plan)
    how = {"suns": sun, "medium": medium, "scattering": light, "tolerance": 0.02}
    return integrate(grid, *view(16), **how)[0][:, 0]


def test_a_tolerance_takes_the_cheapest_plan_that_keeps_it() -> None:
    medium, sun = Medium(1.0, phase="isotropic"), (Sun([0, 1, 0]),)
    thin, thick = (cube(8, edge) for edge in (1.0, 8.0))  # depth 1/8 and 1 in a voxel
    tolerances = (0.0, 1e-5, 1e-3, 0.01, 0.03, 0.06)
    for grid, expected in (
        (thin, ("finest", "finer", "fine", "reference", "standard", "quick")),
        (thick, ("finest", "finer", "fine", "reference", "reference", "reference")),
    ):
        chosen = [plan_for(t, sun, medium, grid) for t in tolerances]
        assert chosen == [PLANS[name] for name in expected]
    narrow = Medium(1.0, g=0.85, phase="hg")
    assert plan_for(1.0, sun, narrow, thin) == PLANS["reference"]


def cube(n: int, edge: float) -> VoxelGrid:
    """Fill a cube of that edge."""
    return VoxelGrid(np.ones((n, n, n)), np.zeros(3), np.full(3, edge))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 5])
@pytest.mark.parametrize(
    "sun", [(0.62, 0.55, -0.1), (-0.5, 0.7, 0.4), (0.3, 0.5, -0.8)]
)
@pytest.mark.parametrize("g", [0.0, 0.6, 0.85])
def test_plans_keep_their_errors(seed: int, sun: tuple, g: float) -> None:
    grid, light = lumpy(32, seed), Sun(sun)
    medium = Medium(4.0, g=g, phase="hg")
    exact = picture(grid, light, medium, "finest")
    most = float(phase(medium, np.array(1.0))) * float(light.irradiance.max())
    for name, (error, _) in ERRORS.items():
        if name not in FEW or g <= 0.6:
            off = np.abs(picture(grid, light, medium, name) - exact).max()
            assert off <= error * max(most, 1.0), name


@pytest.mark.slow
def test_what_the_plans_must_reach_against_random_paths() -> None:
    """64 voxels' edge, g .6, albedo 1, .25 per voxel, a cloud and sun not tuned on."""
    grid, medium = lumpy(64), Medium(8.0, g=0.6, phase="hg")
    found = trace_paths(grid, *view(16), suns=SUN, medium=medium, paths=3000)
    L, error = found.radiance[:, 0], found.error[:, 0]
    noise = float(np.sqrt(np.square(error).sum() / np.square(L).sum()))
    # Squares of errors and noise add up; that of noise over n pixels is known to a
    # share of sqrt(2 / n).
    n = np.count_nonzero(L > 0.1 * L.max())
    doubtful = noise * noise * (1.0 + 4.0 * np.sqrt(2.0 / n))
    for name, most in (("quick", 0.02), ("standard", 0.015), ("reference", 0.008)):
        drawn = picture(grid, SUN, medium, name)
        off = apart(drawn, np.append(0.0, L))
        assert off * off <= most * most + doubtful, name
        total, doubt = L.sum(), np.sqrt(np.square(error).sum())
        share = {"quick": 0.015, "standard": 0.01, "reference": 0.003}[name]
        assert abs(drawn.sum() - total) <= share * total + 4.0 * doubt, name
