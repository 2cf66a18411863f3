"""The scattering benchmark: every way to light a cloud, time against error.

Errors are relative RMSEs of a picture. Against "finest", solved on the same grid, they
tell what a plan leaves out; the rows "paths" hold plans against random paths of
`trace_paths`, an unbiased estimate. Its own noise, from its standard errors, stands in
the task's name and is taken off in quadrature (what is below a quarter of it cannot be
seen).
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from refcloud.bench.subject import MS, Subject
from refcloud.bench.timing import Contender
from refcloud.camera import Camera, rays
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Array
from refcloud.march import integrate
from refcloud.noise import fbm_grid
from refcloud.optics import Medium, Sun
from refcloud.scattering_pictures import WAYS
from refcloud.transport import (
    PLANS,
    ScatteredLight,
    diffused_light,
    scattered_light,
    trace_paths,
)

# Unseen: plans were chosen on the cloud of seed 1 under another sun.
SEED, SUN = 2, Sun(np.array([0.62, 0.55, -0.1]), np.ones(3))
EYE, FOV = (-1.2, -0.9, 3.8), 0.47
SIGMA = 8.0  # optical depth .25 per voxel at 64 voxels' edge, 8 through the middle
MARCH = 0.002  # tolerance of the pictures
PIXELS, QUICK_PIXELS = 24, 12
PATHS, QUICK_PATHS = 2048, 64


@functools.cache
def lumpy(n: int, seed: int = SEED) -> VoxelGrid:
    """Make a soft cloud of noise in a cube of edge 2, an eighth of it occupied."""
    at = (np.arange(n) + 0.5) / n * 2.0 - 1.0
    noise, _ = fbm_grid(2.5 * at, 2.5 * at, 2.5 * at, seed=seed, octaves=4)
    r2 = (
        np.square(at / 0.9)[None, None]
        + np.square(at / 0.7)[None, :, None]
        + np.square(at / 0.8)[:, None, None]
    )
    density = np.clip(1.8 * ((0.6 - r2) + 1.6 * noise), 0.0, 1.0)
    edge = max(n // 20, 1)
    for axis in range(3):
        np.moveaxis(density, axis, 0)[:edge] = 0.0
        np.moveaxis(density, axis, 0)[-edge:] = 0.0
    return VoxelGrid(density, -np.ones(3), np.ones(3))


def view(pixels: int) -> tuple[Array, Array]:
    """Give the rays of the benchmark's eye."""
    camera = Camera(np.array(EYE), np.zeros(3), fov_y=FOV, width=pixels, height=pixels)
    origins, directions = rays(camera)
    return origins.reshape(-1, 3), directions.reshape(-1, 3)


def pixels_for(n: int) -> int:
    """Give the picture's edge: a quick benchmark looks at a small one."""
    return PIXELS if n >= 48 else QUICK_PIXELS


def picture(grid: VoxelGrid, light: ScatteredLight, medium: Medium) -> Array:
    """March a picture under solved light, first channel."""
    L, _ = integrate(
        grid,
        *view(pixels_for(grid.density.shape[0])),
        suns=SUN,
        medium=medium,
        scattering=light,
        tolerance=MARCH,
    )
    return L[:, 0]


def apart(found: Array, exact: Array) -> float:
    """Give the relative RMSE, less the noise of the truth, its first number."""
    noise, true = float(exact[0]), exact[1:]
    raw = float(np.square(found - true).sum() / np.square(true).sum())
    return float(np.sqrt(max(raw - noise * noise, 0.0)))


def plans(
    task: str, n: int, medium: Medium, truth: Callable[[], Array]
) -> list[Contender]:
    """Enter every plan: timed is the solution, its suns and norms with it."""
    grid = lumpy(n)

    def error(light: Any, exact: Array) -> float:
        return apart(picture(grid, light.item(), medium), exact)

    return [
        Contender(
            task,
            f"refcloud {name}",
            1,
            functools.partial(scattered_light, grid, SUN, medium=medium, plan=plan),
            truth,
            distance=error,
        )
        for name, plan in PLANS.items()
        if name != "finest"
    ]


@functools.cache
def finest(n: int, sigma: float, g: float) -> Array:
    """Draw the benchmark's cloud under its finest light; in front stands no noise."""
    grid, medium = lumpy(n), Medium(sigma, g=g, phase="hg")
    light = scattered_light(grid, SUN, medium=medium, plan="finest")
    return np.append(0.0, picture(grid, light, medium))


@functools.cache
def by_paths(n: int, sigma: float, g: float) -> Array:
    """Estimate the same picture by random paths; in front stands its relative noise."""
    grid, medium = lumpy(n), Medium(sigma, g=g, phase="hg")
    count = PATHS if n >= 48 else QUICK_PATHS
    found = trace_paths(
        grid, *view(pixels_for(n)), suns=SUN, medium=medium, paths=count
    )
    L, error = found.radiance[:, 0], found.error[:, 0]
    return np.append(np.sqrt(np.square(error).sum() / np.square(L).sum()), L)


def solutions(n: int) -> list[Contender]:
    """List plans and stand-ins on one cloud, against its finest light."""
    medium = Medium(SIGMA, g=0.6, phase="hg")
    exact = functools.partial(finest, n, SIGMA, 0.6)
    entered = plans(f"{n}^3 to finest", n, medium, exact)
    grid = lumpy(n)
    entered.append(
        Contender(
            f"{n}^3 to finest",
            "P1 diffusion, solution alone",
            1,
            functools.partial(diffused_light, grid, SUN, medium=medium),
        )
    )
    for name, way in WAYS.items():
        if "directions" not in name:
            entered.append(
                Contender(
                    f"{n}^3 pictures to finest",
                    name,
                    1,
                    functools.partial(way, grid, *view(pixels_for(n)), SUN, medium),
                    exact,
                    distance=apart,
                )
            )
    return entered


def against_paths(n: int) -> list[Contender]:
    """List plans against random paths, on thin and on thick voxels."""
    entered = []
    for sigma, g in ((SIGMA, 0.0), (SIGMA, 0.6), (5.0 * SIGMA, 0.6)):
        tau = sigma * 2.0 / n
        task = f"{n}^3, g {g:g}, depth {tau:.2g} per voxel, {to_paths(n, sigma, g)}"
        medium = Medium(sigma, g=g, phase="hg")
        entered += plans(task, n, medium, functools.partial(by_paths, n, sigma, g))
    return entered


def to_paths(n: int, sigma: float, g: float) -> str:
    """Say that the truth is random paths, and their relative noise."""
    return f"to paths of noise {by_paths(n, sigma, g)[0]:.2g}"


def large(n: int) -> list[Contender]:
    """List the two quick plans on a larger cloud, against random paths."""
    medium = Medium(SIGMA, g=0.6, phase="hg")
    truth = functools.partial(by_paths, n, SIGMA, 0.6)
    task = f"{n}^3, g 0.6, {to_paths(n, SIGMA, 0.6)}"
    return plans(task, n, medium, truth)[:2]


SCATTERING = Subject(
    name="scattering",
    title="light of every order: plans and stand-ins",
    about="CPU time of a solution or a picture, medians; error: relative RMSE of a"
    " picture against the finest solution, or against random paths less their noise",
    lists=((solutions, 64, 12), (against_paths, 64, 12), (large, 128, 16)),
    unit=MS,
    digits=2,
    reference="the finest plan, 0.005 from an unbiased estimate at a depth of 0.25 in a"
    " voxel; or random paths, whose noise is taken off",
)
