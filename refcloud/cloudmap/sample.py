"""Sampling a voxel grid between its cells' centres."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.cloudmap.voxels import VoxelGrid, cell_size
from refcloud.conventions import Array, Shape


@checked
def trilinear(grid: VoxelGrid, points: Annotated[Array, Shape("...", 3)]) -> Array:
    """Sample the density at points.

    Formula: the eight surrounding centres, weighted by (1 - |dx|) (1 - |dy|) (1 - |dz|)
    in cells; clamped at the outermost centres, 0 outside the box

    Parameters
    ----------
    grid
        The cloud map.
    points
        Shape (..., 3), scene units.

    Returns
    -------
    Shape (...,).

    Source: "Clouds on Demand" (N30); design.md, section 4.

    Examples
    --------
    >>> grid = VoxelGrid([[[0.0, 1.0]]], [0, 0, 0], [2, 1, 1])
    >>> trilinear(grid, [[1.0, 0.5, 0.5], [0.1, 0.5, 0.5], [9.0, 0.5, 0.5]])
    array([0.5, 0. , 0. ])
    """
    inside = ((points >= grid.lower) & (points <= grid.upper)).all(axis=-1)
    x, y, z = np.moveaxis((points - grid.lower) / cell_size(grid) - 0.5, -1, 0)
    return np.where(inside, clamped_trilinear(grid.density, x, y, z), 0.0)


def clamped_trilinear(values: Array, x: Array, y: Array, z: Array) -> Array:
    """Sample ``values[z, y, x]`` at cell coordinates, unchecked, clamped everywhere.

    Cell i has its centre at coordinate i. The arrays are flattened once, so that each
    corner costs one gather.
    """
    flat = values.ravel()
    places, fractions = [], []
    for coordinate, n in zip((x, y, z), values.shape[::-1], strict=True):
        c = np.minimum(np.maximum(coordinate, 0.0), n - 1.0)
        cell = np.minimum(c.astype(np.intp), max(n - 2, 0))
        places.append(cell)
        fractions.append(c - cell)
    D, H, W = values.shape
    (i, j, k), (u, v, w) = places, fractions
    step_x, step_y, step_z = int(W > 1), W * int(H > 1), W * H * int(D > 1)
    first = (k * H + j) * W + i
    # Along x on four edges, then y, then z: seven linear steps.
    edges = []
    for offset in (0, step_y, step_z, step_y + step_z):
        a = flat.take(first + offset)
        edges.append(a + u * (flat.take(first + (offset + step_x)) - a))
    near = edges[0] + v * (edges[1] - edges[0])
    far = edges[2] + v * (edges[3] - edges[2])
    return near + w * (far - near)
