"""The search for the nearest points of Worley noise at scattered places.

The own cell and its neighbours (9 or 27) hold the nearest point nearly always, but not
always (E32). Where the distance found exceeds that to the neighbours' outer faces, the
exact search meets one ring of cells more (25 or 125 in all): no distance reaches beyond
those, see `refcloud.noise.worley_bound`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.noise.lattice import Cells
from refcloud.noise.worley_cells import (
    WHOLE,
    Reals,
    _offsets,
    _places,
    _split,
    _wrapped,
)
from refcloud.noise.worley_ring import _keep, _look_further, _squared_length

CHUNK = 1 << 13  # scattered points at a time: their temporaries fit a core's cache
HASHED_CHUNK = 1 << 11  # of them, where each hashes the points of its own cells
MOST_TABLE = 1 << 20  # cells whose points are kept in a table: 24 MB in space
FEW = 64  # cells that are worth a table, however few the points


def _scattered(
    points: Array,
    seed: int,
    period: int | None,
    second: bool,
    exact: bool,
    dtype: np.dtype,
) -> Reals:
    """Give F1, or F2 where second, at points of shape (N, n)."""
    out = np.full(len(points), np.nan, dtype)
    finite = np.asarray(np.isfinite(points).all(axis=1))
    table = _table(points[finite], seed, period, dtype)
    step = CHUNK if table else HASHED_CHUNK
    for first in range(0, len(points), step):
        chosen = finite[first : first + step]
        axes = points[first : first + step][chosen].T
        if axes.size:
            cells, places = zip(*(_split(c.copy(), period) for c in axes), strict=True)
            t = [place.astype(dtype) for place in places]
            found = _nearest(cells, t, table, seed, period, second)
            if exact:
                _look_further(found, np.array(cells), np.array(t), seed, period)
            out[first : first + step][chosen] = np.sqrt(found[-1])
    return out


class _Table:
    """The points of a box of cells, and where each cell stands in it."""

    def __init__(
        self,
        lows: list[int],
        counts: list[int],
        seed: int,
        period: int | None,
        dtype: np.dtype,
    ) -> None:
        lines = [
            _wrapped(np.arange(low, low + count), period)
            for low, count in zip(lows, counts, strict=True)
        ]
        self.places = _lattice(lines, seed, dtype).reshape(len(lows), -1)
        self.lows = lows
        self.strides = [math.prod(counts[:axis]) for axis in range(len(counts))]

    def index(self, cells: tuple[Cells, ...]) -> NDArray[np.intp]:
        """Give the places of cells in the table."""
        index = np.zeros(cells[0].shape, np.intp)
        for c, low, stride in zip(cells, self.lows, self.strides, strict=True):
            index += (c - low) * stride
        return index


def _table(
    points: Array, seed: int, period: int | None, dtype: np.dtype
) -> _Table | None:
    """Hash the box of all points once, if it is small beside their number."""
    if not points.size:
        return None
    most = WHOLE if period is None else period
    lows, counts = [], []
    for low, high in zip(points.min(axis=0), points.max(axis=0), strict=True):
        if max(-low, high) >= most:  # reduced, with their sign, into (-most, most)
            low, high = (-most if low < 0.0 else 0), (most if high > 0.0 else 0)
        lows.append(math.floor(low) - 1)
        counts.append(math.floor(high) + 2 - lows[-1])
    size = math.prod(counts)
    if size > min(MOST_TABLE, max(FEW, 4 * len(points))):
        return None
    return _Table(lows, counts, seed, period, dtype)


def _lattice(lines: list[Cells], seed: int, dtype: np.dtype) -> Reals:
    """Give the points of all cells on lines along x, y (and z) as [axis, (z,) y, x]."""
    wide = [
        line.reshape(-1, *(1,) * axis).astype(np.uint64)
        for axis, line in enumerate(lines)
    ]
    return _places(wide, seed).astype(dtype, copy=False)


def _nearest(
    cells: tuple[Cells, ...],
    t: list[Reals],
    table: _Table | None,
    seed: int,
    period: int | None,
    second: bool,
) -> list[Reals]:
    """Give the squares of F1 (and F2) among the own cell and its neighbours."""
    steps = _offsets(len(cells), 1)
    relative = [[-place - 1, -place, 1 - place] for place in t]
    home = table.index(cells) if table else None
    found: list[Reals] = []
    for step in steps:
        if table and home is not None:
            move = sum(s * k for s, k in zip(step, table.strides, strict=True))
            q = [axis.take(home + move, mode="clip") for axis in table.places]
        else:
            near = [c + s for c, s in zip(cells, step, strict=True)]
            q = list(_hashed(near, seed, period, t[0].dtype))
        for axis, s in enumerate(step):
            q[axis] += relative[axis][s + 1]
        _keep(found, _squared_length(q), second)
    return found


def _hashed(
    cells: list[Cells], seed: int, period: int | None, dtype: np.dtype
) -> Reals:
    """Give the points of cells, axis first."""
    words = [_wrapped(c, period).astype(np.uint64) for c in cells]
    return _places(words, seed).astype(dtype, copy=False)
