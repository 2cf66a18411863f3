"""Columns toward a sun on a lattice that leans with its rays, for sharp clouds.

A light volume that is interpolated linearly is off where light changes within a voxel:
in sharp clouds by hundredths of white. Along a sun ray the column falls smoothly, and
beside it its slope is continuous. So it is tabulated at K samples per cell on a lattice
whose w axis is the sun's ray, and interpolated by Catmull-Rom: an error of third order.

1. *lean*: cells (u, v, w) become (u - a w, v - b w, w), where a sun ray stands still;
2. *stretch*: between two levels of w, Gauss points; at each a slice is resampled by two
   matrix products with tents, which is trilinear interpolation;
3. *sum* the stretches from the sun on;
4. *look up*: 4 x 4 x 4 samples around a place.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.conventions import Array
from refcloud.march.cubics import PLACES, RIM, read_cubics
from refcloud.march.quadrature import gauss

STRETCH = 2  # Gauss points between two levels
MOST = 1 << 25  # samples of one lattice: 128 MB


@dataclass(frozen=True)
class Shafts:
    """Column densities to one sun on a leaning lattice.

    Attributes
    ----------
    lower, size
        The grid's lower corner and edges of a cell, shape (3,), scene units.
    axes
        w, v and u, as numbers of x, y and z.
    lean
        By how many cells of v and u a sun ray moves while it moves one along w.
    begin
        Where the first samples of w, v and u are, cells.
    finer
        Samples per cell.
    table
        Columns, shape (w, v, u).
    """

    lower: Array
    size: Array
    axes: tuple[int, int, int]
    lean: tuple[float, float]
    begin: tuple[float, float, float]
    finer: int
    table: NDArray[np.float32]

    def columns(self, points: Array) -> Array:
        """Interpolate the columns from points (M, 3) on, shape (M,)."""
        found = np.empty(len(points))
        for start in range(0, len(points), PLACES):
            part = slice(start, start + PLACES)
            found[part] = read_cubics(self.table, self._places(points[part]))
        return found

    def _places(self, points: Array) -> list[Array]:
        # Where among the samples, in the leaning coordinates.
        w_axis, *across = self.axes
        cells = (points - self.lower) / self.size - 0.5
        w = cells[:, w_axis]
        leaning = [
            w,
            *(cells[:, k] - a * w for k, a in zip(across, self.lean, strict=True)),
        ]
        return [
            (place - first) * self.finer
            for place, first in zip(leaning, self.begin, strict=True)
        ]


def shafts(cloud: VoxelGrid, sun: Array, finer: int) -> Shafts | None:
    """Tabulate a cloud's columns toward a sun.

    Parameters
    ----------
    cloud
        The cloud map, with no density on a face of its box.
    sun
        Toward it, a unit vector, shape (3,).
    finer
        Samples per cell, along each axis.

    Returns
    -------
    The columns; None where there would be too many.
    """
    # 1. Lean: rays move along w by the most cells.
    size = cell_size(cloud)
    cells = sun / size
    w = int(np.argmax(np.abs(cells)))
    v, u = (k for k in (2, 1, 0) if k != w)
    lean = [float(cells[k] / cells[w]) for k in (v, u)]
    counts = cloud.density.shape[::-1]
    deep = counts[w] - 1.0
    begin, shape = [-RIM / finer], [int(deep * finer) + 2 * RIM + 1]
    for k, a in zip((v, u), lean, strict=True):
        low, high = min(0.0, -a * deep), counts[k] - 1.0 + max(0.0, -a * deep)
        begin.append(low - RIM / finer)
        shape.append(int(np.ceil((high - low) * finer)) + 2 * RIM + 1)
    if np.prod(shape, dtype=float) > MOST:
        return None
    slices = cloud.density.transpose(2 - w, 2 - v, 2 - u).astype(np.float32)
    q_v, q_u = (
        b + np.arange(n) / finer for b, n in zip(begin[1:], shape[1:], strict=True)
    )

    # 2. Stretches: table[k] holds what lies between levels k and k + 1.
    table = np.zeros(shape, np.float32)
    step = float(size[w]) / (abs(float(sun[w])) * finer)
    for k in range(RIM, shape[0] - RIM - 1):
        for share, weight in zip(*gauss(STRETCH), strict=True):
            at = begin[0] + (k + share) / finer
            low = min(int(at), counts[w] - 2)
            part = at - low
            plane = (1.0 - part) * slices[low] + part * slices[low + 1]
            rows = tents(q_v + lean[0] * at, counts[v])
            aside = tents(q_u + lean[1] * at, counts[u])
            table[k] += (rows @ plane.astype(np.float32) @ aside.T) * (step * weight)

    # 3. Sum from the sun on.
    if cells[w] > 0.0:
        table = np.cumsum(table[::-1], axis=0)[::-1]
    else:
        table[1:] = np.cumsum(table[:-1], axis=0)
        table[0] = 0.0
    return Shafts(
        cloud.lower,
        size,
        (w, v, u),
        (lean[0], lean[1]),
        (begin[0], begin[1], begin[2]),
        finer,
        np.ascontiguousarray(table),
    )


def tents(places: Array, count: int) -> NDArray[np.float32]:
    """Give the weights of `count` cells at places (n,), shape (n, count)."""
    away = np.abs(places[:, None] - np.arange(count))
    return np.maximum(1.0 - away, 0.0).astype(np.float32)
