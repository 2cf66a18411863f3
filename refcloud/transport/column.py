"""Column density toward the sun, exact: the definition that faster forms approximate.

Along a ray the trilinear field is a cubic polynomial between two planes through cell
centres, so two Gauss points in each such piece integrate it exactly.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.cloudmap.sample import clamped_trilinear
from refcloud.conventions import Array, Shape, Vector, unit_vector

GAUSS = 0.5 / math.sqrt(3.0)  # of a piece, from its middle
ROOM = 1 << 20  # numbers in one table of pieces: memory stays bounded


@checked
def column_density(
    grid: VoxelGrid, points: Annotated[Array, Shape("N", 3)], direction: Vector
) -> Array:
    """Integrate the density from points toward a light, exactly.

    Formula: integral of density(p + t direction) dt for t > 0

    Parameters
    ----------
    grid
        The cloud map.
    points
        Shape (N, 3), scene units, in the box or anywhere else.
    direction
        Toward the light, shape (3,), any length but 0.

    Returns
    -------
    Shape (N,), density times scene units; times sigma_t it is the optical depth.

    Source: document D (R05), with the step size that tends to 0.

    Examples
    --------
    >>> grid = VoxelGrid(np.ones((2, 2, 2)), [0, 0, 0], [2, 2, 2])
    >>> column_density(grid, [[1.0, 0.5, 1.0]], [0, 3, 0])
    array([1.5])
    """
    size, counts = cell_size(grid), np.array(grid.density.shape[::-1])
    step = unit_vector(direction) / size  # cells per scene unit
    places = (points - grid.lower) / size - 0.5  # in cells
    chunk = max(1, ROOM // (int(counts.sum()) + 2))
    parts = [
        _integrated(grid.density, places[first : first + chunk], step)
        for first in range(0, len(places), chunk)
    ]
    return np.concatenate([np.zeros(0), *parts])


def _integrated(density: Array, places: Array, step: Array) -> Array:
    """Integrate along rays from places in cells, which move by `step` per unit."""
    counts = np.array(density.shape[::-1])
    near, far = np.zeros(len(places)), np.full(len(places), np.inf)
    crossings = []
    for axis in range(3):
        start, n = places[:, axis], counts[axis]
        if step[axis] == 0.0:  # the ray stays in the slab, or never is in it
            far = np.where((start >= -0.5) & (start <= n - 0.5), far, -np.inf)
            continue
        with np.errstate(over="ignore"):  # never, in a direction that hardly moves
            # 1. Where the ray is between the two faces.
            ends = (np.array([-0.5, n - 0.5]) - start[:, None]) / step[axis]
            # 2. Where it crosses planes through cell centres.
            crossings.append((np.arange(n) - start[:, None]) / step[axis])
        near = np.maximum(near, ends.min(axis=1))
        far = np.minimum(far, ends.max(axis=1))
    hit = near < far  # a miss has no length, and may be without end away
    near, far = np.where(hit, near, 0.0), np.where(hit, far, 0.0)
    # 3. Pieces between crossings, and two Gauss points in each.
    cuts = [near[:, None], *crossings, far[:, None]]
    t = np.concatenate(cuts, axis=1)
    t = np.sort(np.clip(t, near[:, None], far[:, None]), axis=1)
    length, middle = np.diff(t), 0.5 * (t[:, 1:] + t[:, :-1])
    total = np.zeros(len(places))
    for side in (-GAUSS, GAUSS):
        at = middle + side * length
        x, y, z = (places[:, a, None] + at * step[a] for a in range(3))
        total += 0.5 * (clamped_trilinear(density, x, y, z) * length).sum(axis=1)
    return total
