"""Plans keep the errors that `plan_for` counts with, and those that the issue asks."""

from __future__ import annotations

import numpy as np
import pytest

from refcloud.bench.scattering import SUN, apart, lumpy, view
from refcloud.march import integrate
from refcloud.optics import Medium, Sun, phase
from refcloud.transport import PLANS, scattered_light, trace_paths
from refcloud.transport.plans import ERRORS, FEW, error_of, plan_for


def picture(grid, sun: Sun, medium: Medium, plan: str) -> np.ndarray:
    light = scattered_light(grid, sun, medium=medium, plan=plan)
    how = {"suns": sun, "medium": medium, "scattering": light}
    return integrate(grid, *view(16), **how)[0][:, 0]


def test_a_tolerance_takes_the_cheapest_plan_that_keeps_it() -> None:
    medium, sun = Medium(1.0, phase="isotropic"), (Sun([0, 1, 0]),)
    tolerances = (0.0, 1e-5, 1e-3, 0.01, 0.03, 0.06)
    for depth, expected in (
        (0.125, ("finest", "finer", "fine", "reference", "standard", "quick")),
        (1.0, ("finest", "finest", "finer", "fine", "reference", "reference")),
    ):
        chosen = [plan_for(t, sun, medium, depth) for t in tolerances]
        assert chosen == [PLANS[name] for name in expected]
    narrow = Medium(1.0, g=0.85, phase="hg")
    assert plan_for(1.0, sun, narrow) == PLANS["reference"]


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
    for name in ERRORS:
        if name not in FEW or g <= 0.6:
            off = np.abs(picture(grid, light, medium, name) - exact).max()
            assert off <= error_of(name, 0.25) * max(most, 1.0), name


@pytest.mark.slow
@pytest.mark.parametrize(("n", "sigma"), [(8, 20.0), (12, 20.0), (24, 20.0)])
@pytest.mark.parametrize("g", [-0.3, 0.0, 0.6])
def test_thick_voxels_keep_the_errors_that_are_counted(n, sigma, g) -> None:
    grid, sun = lumpy(n, 7), Sun([0.62, 0.55, -0.1])
    medium = Medium(sigma, g=g, phase="hg")
    depth = sigma * float(grid.density.max()) * 2.0 / n
    exact = picture(grid, sun, medium, "finest")
    most = float(phase(medium, np.array(1.0 if g >= 0 else -1.0)))
    most *= float(sun.irradiance.max())
    for name in ERRORS:
        off = np.abs(picture(grid, sun, medium, name) - exact).max()
        assert off <= error_of(name, depth) * max(most, 1.0), name


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
