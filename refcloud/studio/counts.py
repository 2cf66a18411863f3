"""What a pixel costs: samples along its ray, or balls drawn over it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import AnyCamera, project, rays
from refcloud.cloudmap import VoxelGrid, trilinear
from refcloud.lighting.shining import shining_of
from refcloud.march import ray_box
from refcloud.metaballs import Metaballs
from refcloud.noise import uniform

Counts = NDArray[np.int64]
MOST_BALLS = 20_000  # drawn one after the other


def steps_per_pixel(
    grid: VoxelGrid,
    camera: AnyCamera,
    *,
    sigma_t: float,
    step: float,
    least: float = 0.0,
    seed: int = 0,
) -> tuple[Counts, Counts]:
    """Count the samples that `refcloud.lighting.march_shining` takes and leaves out.

    Parameters
    ----------
    grid
        The cloud map.
    camera
        The eye.
    sigma_t
        Extinction at density 1, 1 / scene unit.
    step
        Between two samples of a ray, scene units.
    least
        A ray ends where its transmittance is at most this.
    seed
        Chooses the starts of the rays.

    Returns
    -------
    Samples taken and samples left out, each of shape (H, W): those between empty voxels
    and those behind an opaque front.
    """
    # 1. Where the rays meet the box, and how many samples lie in it.
    occupied = shining_of(grid, sigma_t, "float64").occupied
    origins, directions = (a.reshape(-1, 3) for a in rays(camera))
    t0, t1 = ray_box(origins, directions, lower=grid.lower, upper=grid.upper)
    row, column = np.divmod(np.arange(len(origins)), camera.width)
    start = t0 + uniform(row, column, seed=seed) * step
    inside = t1 > t0
    length = np.where(inside, t1 - np.where(inside, start, 0.0), 0.0)
    steps = np.maximum(np.ceil(length / step), 0.0).astype(np.int64)
    steps[~inside] = 0

    # 2. Take them, all rays at once.
    taken = np.zeros(len(origins), np.int64)
    tau = np.zeros(len(origins))
    size = (grid.upper - grid.lower) / np.array(grid.density.shape[::-1])
    last = np.array(occupied.shape[::-1]) - 1
    going = np.flatnonzero(steps > 0)
    for k in range(int(steps.max(initial=0))):
        place = origins[going] + (start[going] + k * step)[:, None] * directions[going]
        np.clip(place, grid.lower, grid.upper, out=place)
        cell = np.clip((place - grid.lower) / size + 0.5, 0.0, last).astype(np.int64)
        here = occupied[cell[:, 2], cell[:, 1], cell[:, 0]]
        met = going[here]
        taken[met] += 1
        tau[met] += sigma_t * step * trilinear(grid, place[here])
        going = going[(steps[going] > k + 1) & (np.exp(-tau[going]) > least)]
    shape = camera.height, camera.width
    return taken.reshape(shape), (steps - taken).reshape(shape)


def balls_per_pixel(balls: Metaballs, camera: AnyCamera) -> Counts:
    """Count the balls whose footprint covers a pixel's centre.

    Parameters
    ----------
    balls
        At most 20,000 of them count, the first.
    camera
        The eye.

    Returns
    -------
    Shape (H, W).
    """
    counts = np.zeros((camera.height, camera.width), np.int64)
    x, y, _, scale = project(camera, balls.centers)
    for where, inside in discs(x, y, balls.radii * scale, camera.width, camera.height):
        counts[where] += inside
    return counts


def discs(x, y, radius, width: int, height: int):
    """Give the window and the mask of every disc that touches the picture, in order.

    Parameters
    ----------
    x, y, radius
        Pixels, shape (N,).
    width, height
        Size of the picture.

    Yields
    ------
    Rows and columns as slices, and which of their pixels' centres lie inside.
    """
    for cx, cy, r in zip(
        x[:MOST_BALLS].tolist(), y[:MOST_BALLS].tolist(), radius.tolist(), strict=False
    ):
        if not (r > 0.0 and -r < cx < width + r and -r < cy < height + r):
            continue
        left, right = max(int(cx - r), 0), min(int(cx + r) + 1, width)
        top, bottom = max(int(cy - r), 0), min(int(cy + r) + 1, height)
        across = np.arange(left, right) + 0.5 - cx
        down = np.arange(top, bottom)[:, None] + 0.5 - cy
        window = slice(top, bottom), slice(left, right)
        yield window, across * across + down * down <= r * r
