"""How far a set of metaballs is from the cloud map that it stands for."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from refcloud.checking import checked
from refcloud.cloudmap.voxels import VoxelGrid, cell_centres
from refcloud.conventions import Array
from refcloud.metaballs.balls import Metaballs
from refcloud.metaballs.field import field_grid


@dataclass(frozen=True)
class FitErrors:
    """Relative root mean square errors of a fit; 0 is exact, 1 as bad as no balls.

    Attributes
    ----------
    density
        Of the density, over all voxels, empty ones included.
    occupied
        The same, over the occupied voxels only: the paper's H.
    projected
        Of the optical depth along x, y and z.
    """

    density: float
    occupied: float
    projected: tuple[float, float, float]


@checked
def errors_of_fit(grid: VoxelGrid, balls: Metaballs) -> FitErrors:
    """Measure how far metaballs are from their cloud map.

    Formula: sqrt(sum (y - g)^2 / sum y^2)

    Parameters
    ----------
    grid
        The cloud map y.
    balls
        The metaballs, whose density g is taken at the cells' centres.

    Returns
    -------
    The errors. For an empty map: 0 where the balls are empty too, else infinite.

    Source: paper M, eq 20, relative.

    Examples
    --------
    >>> grid = VoxelGrid(np.ones((1, 1, 1)), [0, 0, 0], [1, 1, 1])
    >>> errors_of_fit(grid, Metaballs([[0.5, 0.5, 0.5]], [0.5], [0.75])).density
    0.25
    """
    x, y, z = cell_centres(grid)
    found = field_grid(balls, x, y=y, z=z)
    occupied = grid.density > 0.0
    along = [
        _relative(grid.density.sum(axis=axis), found.sum(axis=axis))
        for axis in (2, 1, 0)
    ]
    return FitErrors(
        _relative(grid.density, found),
        _relative(grid.density[occupied], found[occupied]),
        (along[0], along[1], along[2]),
    )


def _relative(expected: Array, actual: Array) -> float:
    peak = float(expected.max(initial=0.0))
    if peak == 0.0:
        return 0.0 if not actual.any() else math.inf
    # Divided by the peak first: squares neither overflow nor vanish.
    off = float(np.linalg.norm((actual - expected) / peak))
    return off / float(np.linalg.norm(expected / peak))
