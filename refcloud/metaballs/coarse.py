"""Fits on a coarser grid: large balls need not be told apart voxel by voxel.

A step of the fit costs as much as there are pairs of voxel and ball. On cells of twice
the edge there are an eighth of them, and a ball of many voxels hardly moves when it is
fitted to the means of 2 x 2 x 2 voxels. So the steps are made there, and a few on the
voxels themselves set right what the means have hidden.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from refcloud.metaballs.pairs import Work
from refcloud.metaballs.refine import Fit

# A grid is coarse enough where the mean ball's radius is at least so many cells.
LEAST_CELLS = 2.1


def coarsened(work: Work) -> Work:
    """Join 2 x 2 x 2 cells to one that has their mean density."""
    whole = np.pad(work.density, [(0, n % 2) for n in work.density.shape])
    deep, tall, wide = (n // 2 for n in whole.shape)
    blocks = whole.reshape(deep, 2, tall, 2, wide, 2)
    origin = work.origin + 0.5 * work.edges * work.edge
    return replace(
        work,
        density=blocks.mean(axis=(1, 3, 5)),
        edges=2.0 * work.edges,
        origin=origin,
        joined=2 * work.joined,
    )


def levels(work: Work, radius: float) -> list[Work]:
    """List the grids that serve balls of a mean radius, the coarsest first."""
    found = [work]
    while serves_coarser(found[0], radius):
        found.insert(0, coarsened(found[0]))
    return found


def serves_coarser(work: Work, radius: float) -> bool:
    """Say whether balls of a mean radius need no more than cells of twice the edge."""
    enough = radius >= LEAST_CELLS * 2.0 * float(work.edges.max())
    return enough and max(work.density.shape) >= 2


def moved(fit: Fit, work: Work, other: Work) -> Fit:
    """Say where balls stand on another grid of the same cloud."""
    return replace(fit, centers=fit.centers + (work.origin - other.origin) / work.edge)
