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

    Source: document D (N30).

    Examples
    --------
    >>> grid = VoxelGrid([[[0.0, 1.0]]], [0, 0, 0], [2, 1, 1])
    >>> trilinear(grid, [[1.0, 0.5, 0.5], [0.1, 0.5, 0.5], [9.0, 0.5, 0.5]])
    array([0.5, 0. , 0. ])
    """
    inside = ((points >= grid.lower) & (points <= grid.upper)).all(axis=-1)
    # What lies outside is 0 whatever it is: from here on no number is too large.
    places = np.clip(points, grid.lower, grid.upper) - grid.lower
    x, y, z = np.moveaxis(places / cell_size(grid) - 0.5, -1, 0)
    return np.where(inside, clamped_trilinear(grid.density, x, y, z), 0.0)


def clamped_trilinear(values: Array, x: Array, y: Array, z: Array) -> Array:
    """Sample a table at cell coordinates, unchecked, clamped everywhere.

    Parameters
    ----------
    values
        Shape (D, H, W) as ``[z, y, x]``, or (D, H, W, C). Cell i has its centre at
        coordinate i.
    x, y, z
        Coordinates in cells; they broadcast to one shape (...,).

    Returns
    -------
    Shape (...,), or (..., C); a new array.
    """
    x, y, z = np.broadcast_arrays(x, y, z)
    D, H, W = values.shape[:3]
    # The table is read as one row of cells, so that each corner costs one gather.
    flat = values.reshape(-1, *values.shape[3:])
    places, fractions = [], []
    for coordinate, n in ((x, W), (y, H), (z, D)):
        c = np.asarray(np.maximum(coordinate, 0.0))  # an array at a single place too
        np.minimum(c, n - 1.0, out=c)
        cell = c.astype(np.intp)
        np.minimum(cell, max(n - 2, 0), out=cell)
        c -= cell
        places.append(cell)
        fractions.append(c[..., None] if values.ndim == 4 else c)
    (i, j, k), (u, v, w) = places, fractions
    step_x, step_y, step_z = int(W > 1), W * int(H > 1), W * H * int(D > 1)
    first = (k * H + j) * W + i
    # Along x on four edges, then y, then z: seven linear steps.
    edges = []
    for offset in (0, step_y, step_z, step_y + step_z):
        edge = first + offset if offset else first
        near = flat.take(edge, axis=0)
        far = flat.take(edge + step_x, axis=0)
        far -= near
        far *= u
        far += near
        edges.append(far)
    for a, b, t in ((0, 1, v), (2, 3, v), (0, 2, w)):
        edges[b] -= edges[a]
        edges[b] *= t
        edges[a] += edges[b]
    return edges[0]
