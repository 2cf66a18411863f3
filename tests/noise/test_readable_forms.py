"""The readable form of each noise, beside the fast one in its file, is the same noise.

Gradient, simplex and value noise at points: see their own tests.
"""

from __future__ import annotations

import importlib

import numpy as np
import pytest
from twins.noise import INTERPOLANTS

from refcloud import noise
from refcloud.noise import uniform

# Sums in another order: worst seen 3e-15, times 33.
SAME = 1e-13
PERSISTENCE = 0.6


def literal(name: str):
    """Give the readable form in a file of the room."""
    return importlib.import_module(f"refcloud.noise.{name}")._literal


def places(n: int) -> np.ndarray:
    return 40.0 * uniform(np.arange(300)[:, None], np.arange(n), seed=n) - 20.0


def lines(n: int) -> list[np.ndarray]:
    """Give axes of different lengths, in no order."""
    return [
        30.0 * uniform(np.arange(size), k, seed=5) - 15.0
        for k, size in enumerate((17, 13, 11, 5)[:n])
    ]


def mesh(axes: list[np.ndarray]) -> np.ndarray:
    return np.stack(np.meshgrid(*axes[::-1], indexing="ij")[::-1], axis=-1)


def same(fast, readable) -> None:
    assert np.shape(fast) == readable.shape
    assert readable.std() > 0.05  # something is compared
    np.testing.assert_allclose(fast, readable, rtol=0, atol=SAME)


@pytest.mark.parametrize("interpolant", INTERPOLANTS)
@pytest.mark.parametrize("smooth", [True, False])
@pytest.mark.parametrize("seed", [3, None])
def test_value_noise_on_a_grid(interpolant, smooth: bool, seed: int | None) -> None:
    how = {"seed": seed, "interpolant": interpolant, "smooth": smooth}
    same(noise.value_grid(*lines(3), **how), literal("value_grid")(lines(3), **how))


@pytest.mark.parametrize("n", [2, 3, 4])
@pytest.mark.parametrize("radius", ["continuous", "usual"])
def test_simplex_noise_on_a_grid(n: int, radius) -> None:
    readable = literal("simplex_grid")(lines(n), 3, radius)
    same(noise.simplex_grid(*lines(n), seed=3, radius=radius), readable)
    # A whole number of samples per unit goes the way of the kernels.
    regular = [np.arange(20) / 4.0 - 2.3] * 3
    readable = literal("simplex_grid")(regular, 3, radius)
    same(noise.simplex_grid(*regular, seed=3, radius=radius), readable)


@pytest.mark.parametrize("n", [2, 3])
@pytest.mark.parametrize("period", [None, 3])
@pytest.mark.parametrize("feature", ["F1", "F2"])
def test_worley_noise(n: int, period: int | None, feature) -> None:
    how = {"seed": 3, "period": period, "feature": feature}
    same(noise.worley(places(n), **how), literal("worley")(places(n), **how))
    readable = literal("worley_grid")(lines(n), **how)
    same(noise.worley_grid(*lines(n), **how), readable)


@pytest.mark.parametrize("n", [2, 3])
@pytest.mark.parametrize("octaves", [1, 3])
def test_smooth_noise(n: int, octaves: int) -> None:
    how = {"seed": 3, "octaves": octaves}
    same(noise.smooth(places(n), **how), literal("smooth")(places(n), **how))
    same(noise.smooth_grid(*lines(n), **how), literal("smooth")(mesh(lines(n)), **how))


@pytest.mark.parametrize("n", [2, 3])
@pytest.mark.parametrize("period", [None, 3])
def test_worley_and_smooth_noise_combined(n: int, period: int | None) -> None:
    how = {"seed": 3, "period": period, "octaves": 2}
    readable = literal("worley_smooth")
    same(noise.worley_smooth(places(n), **how), readable(places(n), **how))
    grid = noise.worley_smooth_grid(*lines(n), **how)
    same(grid, readable(mesh(lines(n)), **how))


KINDS = {
    "gradient": (noise.gradient, noise.gradient_grid, {}),
    "simplex": (noise.simplex, noise.simplex_grid, {}),
    "value": (noise.value, noise.value_grid, {"interpolant": "quintic"}),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("absolute", [False, True])
def test_sums_of_octaves(kind: str, absolute: bool) -> None:
    at_points, on_grid, more = KINDS[kind]
    how = {"seed": 3, "octaves": 3, "persistence": PERSISTENCE}
    scattered = noise.turbulence if absolute else noise.fbm
    found = scattered(places(3), kind=kind, normalize="none", **how)
    same(
        found,
        literal("fbm")(
            places(3),
            lambda p, seed: at_points(p, seed=seed, **more),
            **how,
            absolute=absolute,
        ),
    )
    grid = noise.turbulence_grid if absolute else noise.fbm_grid
    found, _ = grid(*lines(3), kind=kind, normalize="none", **how)
    same(
        found,
        literal("fbm_grid")(
            lines(3),
            lambda *axes, seed: on_grid(*axes, seed=seed, **more),
            **how,
            absolute=absolute,
        ),
    )


@pytest.mark.parametrize("seed", [3, None])
def test_the_paper_s_sum(seed: int | None) -> None:
    how = {"seed": seed, "octaves": 3, "persistence": PERSISTENCE}
    how["interpolant"] = "cosine"
    readable = literal("fractal")
    same(
        noise.octave_sum(places(3), normalize="none", **how),
        readable(places(3), **how),
    )
    grid, _ = noise.octave_sum_grid(*lines(3), normalize="none", **how)
    same(grid, readable(mesh(lines(3)), **how))
