"""Gauss points on pieces of rays: columns of density exactly, radiance nearly so."""

from __future__ import annotations

import numpy as np

from refcloud.cloudmap import VoxelGrid, cell_centres
from refcloud.conventions import Array
from refcloud.march.cells import Lattice, Numbers, cut, density_at, lattice, most_rays

# Two points integrate third degree exactly: the density of a piece.
PAIR = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)


def gauss(count: int) -> tuple[Array, Array]:
    """Give Gauss-Legendre points on [0, 1] and their weights.

    K of them integrate polynomials up to degree 2 K - 1 exactly.
    """
    points, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 + 0.5 * points, 0.5 * weights


def integrals_up_to(ends: Array, points: Array) -> Array:
    """Give integrals from 0 to some ends, as weights of values at some points.

    Parameters
    ----------
    ends
        Shape (E,), in [0, 1].
    points
        K of them, shape (K,): polynomials up to degree K - 1 are integrated exactly.

    Returns
    -------
    Shape (E, K).
    """
    degrees = np.arange(len(points))
    values = points[:, None] ** degrees  # of each power at each point
    primitives = ends[:, None] ** (degrees + 1) / (degrees + 1)
    found = np.linalg.solve(values.T, primitives.T).T
    return np.asarray(found, dtype=np.float64)


def columns(grid: Lattice, origins: Array, directions: Array) -> Array:
    """Integrate the density along rays from their origins on, exactly.

    Parameters
    ----------
    grid
        The cloud map.
    origins, directions
        Shape (N, 3), scene units; directions are unit vectors, or one for all, (3,).

    Returns
    -------
    Shape (N,): the integral of rho ds.
    """
    directions = np.broadcast_to(directions, origins.shape)
    found = np.empty(len(origins))
    most = most_rays(grid)
    for start in range(0, len(origins), most):
        part = slice(start, start + most)
        pieces = cut(grid, origins[part], directions[part])
        mass = pieces.length * density_at(pieces, PAIR).mean(axis=1)
        found[part] = per_ray(pieces.ray, mass, len(found[part]))
    return found


def per_ray(ray: Numbers, amounts: Array, count: int) -> Array:
    """Sum amounts of pieces over each ray, in their order along it."""
    return np.bincount(ray, amounts, minlength=count).astype(np.float64, copy=False)


def before_each(ray: Numbers, amounts: Array, count: int) -> Array:
    """Sum what lies in front of each piece on its ray.

    Parameters
    ----------
    ray
        Which ray, ascending, shape (P,).
    amounts
        Shape (P,).
    count
        Number of rays.

    Returns
    -------
    Shape (P,). Each ray is summed by itself, so that a thin one keeps its digits beside
    a thick one.
    """
    pieces = np.bincount(ray, minlength=count)
    first = np.cumsum(pieces) - pieces
    number = np.arange(len(ray)) - first[ray]
    table = np.zeros((count, int(pieces.max(initial=0)) + 1))
    table[ray, number + 1] = amounts
    return np.cumsum(table, axis=1)[ray, number]


def grid_through_the_middle(grid: VoxelGrid) -> float:
    """Give a cloud map's mean column along x, y and z through its centre of mass.

    Parameters
    ----------
    grid
        The cloud map.

    Returns
    -------
    Density times scene units, at least 0; 0 for an empty cloud.
    """
    peak = float(grid.density.max())
    if not peak > 0.0:
        return 0.0
    shares = grid.density / peak  # no sum of them overflows
    middle = np.empty(3)
    for axis, places in enumerate(cell_centres(grid)):
        across = tuple(k for k in range(3) if k != 2 - axis)
        mass = shares.sum(axis=across)
        middle[axis] = (mass / mass.sum()) @ places
    # From the middle to the faces on both sides.
    ways = np.concatenate([np.eye(3), -np.eye(3)])
    found = columns(lattice(grid), np.broadcast_to(middle, (6, 3)), ways)
    total = float(found.sum() / 3.0)
    return total if np.isfinite(total) else 0.0
