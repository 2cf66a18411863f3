"""Short lists of points that can be nearest, for each part of a cell.

Where many samples fall in few cells it pays to cut each cell in parts, and to keep for
each part only those points that are nearest for some place in it: a point whose nearest
place of the part is farther than another point's farthest place is left out.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from refcloud.noise.lattice import Cells
from refcloud.noise.worley_cells import Reals
from refcloud.noise.worley_ring import _keep, _squared_length

PARTS = 4  # parts of a cell along each axis; halves never paid
# Lists save on a sample what it takes to look at three points for one part: measured,
# they pay from some 600 samples to a cell on in space, and 50 in the plane.
PAYS = 3
BLOCK = 1 << 16  # parts times points in one step: temporaries of half a MB
# A place in float32 may lie outside of its part by a last bit: keep a little more.
MARGIN = 1.0 + 2.0**-18


def _paying_parts(samples: int, cells: int, n: int) -> int | None:
    """Say into how many parts to cut cells along each axis, if that pays."""
    return PARTS if PAYS * samples >= cells * (3 * PARTS) ** n else None


class Lists:
    """The points worth looking at from each part of each cell of a box.

    They stand part by part, x, y (and z) apart, counted from the corner of the cell.
    `near` holds the points of each cell's 9 or 27 neighbours, shape (cells, 3^n), and
    `corner` and `shape` are those of the box, in cells.
    """

    def __init__(
        self,
        near: list[Reals],
        corner: list[int],
        shape: list[int],
        parts: int,
        second: bool,
    ) -> None:
        n, cells = len(near), len(near[0])
        self.parts, self.corner = parts, corner
        self.strides = [math.prod(shape[:axis]) * parts**n for axis in range(n)]
        step = max(1, BLOCK // (near[0].shape[1] * parts**n))
        kept = [
            _kept([q[first : first + step] for q in near], parts, second)
            for first in range(0, cells, step)
        ]
        worth = np.concatenate(kept)
        part, which = np.nonzero(worth)
        self.points = [q[part // parts**n, which] for q in near]
        self.counts = worth.sum(axis=1)
        self.starts = np.cumsum(self.counts) - self.counts

    def nearest(
        self, cells: tuple[Cells, ...], t: list[Reals], second: bool
    ) -> list[Reals]:
        """Give the squares of F1 (and F2) of samples in the box."""
        part = np.zeros(t[0].shape, np.intp)
        for axis, (c, place) in enumerate(zip(cells, t, strict=True)):
            # A place of 1, by rounding, is still of the last part.
            own = np.minimum((place * self.parts).astype(np.intp), self.parts - 1)
            own *= self.parts**axis
            own += (c - self.corner[axis]) * self.strides[axis]
            part += own
        at, left = self.starts.take(part), self.counts.take(part)
        found: list[Reals] = []
        for _ in range(1 + second):  # every list has as many
            _keep(found, self._squared(at, t), second)
            at += 1
        left -= len(found)
        # Go down the lists with those samples whose lists go on.
        rows = np.flatnonzero(left)
        on = rows
        while on.size:
            at, left, t = at[on], left[on], [place[on] for place in t]
            better = [f[rows] for f in found]
            _keep(better, self._squared(at, t), second)
            for f, b in zip(found, better, strict=True):
                f[rows] = b
            at += 1
            left -= 1
            on = np.flatnonzero(left)
            rows = rows[on]
        return found

    def _squared(self, at: NDArray[np.intp], t: list[Reals]) -> Reals:
        q = [axis.take(at) for axis in self.points]
        for component, place in zip(q, t, strict=True):
            component -= place
        return _squared_length(q)


def _kept(near: list[Reals], parts: int, second: bool) -> NDArray[np.bool_]:
    """Say which points are worth looking at from each part, shape (parts, 3^n)."""
    n, (cells, points) = len(near), near[0].shape
    low, high = 0.0, 0.0
    edges = (np.arange(parts) / parts)[:, np.newaxis]
    for axis, q in enumerate(near):
        before = edges - q[:, np.newaxis]
        beyond = -before - 1.0 / parts
        nearest = np.maximum(np.maximum(before, beyond), 0.0) ** 2
        farthest = np.maximum(np.abs(before), np.abs(beyond)) ** 2
        # Parts are [z, y, x] within their cell, as cells are within their box.
        along = [1] * n
        along[n - 1 - axis] = parts
        low = low + nearest.reshape(cells, *along, points)
        high = high + farthest.reshape(cells, *along, points)
    low = np.asarray(low).reshape(-1, points)
    high = np.asarray(high).reshape(-1, points)
    if second:
        limit = np.partition(high, 1, axis=1)[:, 1:2]
    else:
        limit = high.min(axis=1, keepdims=True)
    return low <= limit * MARGIN
