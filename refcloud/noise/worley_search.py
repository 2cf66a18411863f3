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
from refcloud.noise.worley_lists import Lists, _paying_parts
from refcloud.noise.worley_ring import (
    Doubtful,
    _doubtful,
    _joined,
    _keep,
    _meet_ring,
    _squared_length,
)

CHUNK = 1 << 15  # scattered points at a time: their temporaries fit a core's cache
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
    out: Reals = np.full(len(points), np.nan, dtype)
    finite = np.isfinite(points[:, 0])
    for column in points.T[1:]:
        finite = finite & np.isfinite(column)
    where = np.flatnonzero(finite)
    if not where.size:
        return out
    whole = points if where.size == len(points) else points[where]
    found = np.empty(where.size, dtype)
    table = _table(whole, seed, period, dtype)
    lists = _lists(table, where.size, second) if table else None
    step = CHUNK if table else HASHED_CHUNK
    doubtful: list[Doubtful] = []
    for first in range(0, where.size, step):
        axes = np.ascontiguousarray(whole[first : first + step].T)
        cells, places = zip(*(_split(c, period) for c in axes), strict=True)
        t = [place.astype(dtype, copy=False) for place in places]
        if lists:
            squares = lists.nearest(cells, t, second)
        else:
            squares = _nearest(cells, t, table, seed, period, second)
        if exact:
            doubtful.append(_doubtful(squares, cells, t, first))
        found[first : first + step] = np.sqrt(squares[-1])
    if doubtful:
        far = _joined(doubtful)
        _meet_ring(far, seed, period)
        found[far.place] = np.sqrt(far.found[-1])
    out[where] = found
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
        self.counts = counts
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
    most = WHOLE if period is None else period
    lows, counts = [], []
    for low, high in ((float(c.min()), float(c.max())) for c in points.T):
        if max(-low, high) >= most:  # reduced, with their sign, into (-most, most)
            low, high = (-most if low < 0.0 else 0), (most if high > 0.0 else 0)
        lows.append(math.floor(low) - 1)
        counts.append(math.floor(high) + 2 - lows[-1])
    size = math.prod(counts)
    if size > min(MOST_TABLE, max(FEW, 4 * len(points))):
        return None
    return _Table(lows, counts, seed, period, dtype)


def _lists(table: _Table, samples: int, second: bool) -> Lists | None:
    """Cut the cells of the table in parts with short lists, where it pays."""
    n = len(table.counts)
    inner = [count - 2 for count in table.counts]  # without the outermost neighbours
    parts = _paying_parts(samples, math.prod(inner), n)
    if parts is None:
        return None
    corner = [low + 1 for low in table.lows]
    inside = np.indices(inner[::-1]).reshape(n, -1)[::-1]
    home = table.index(tuple(c + k for c, k in zip(inside, corner, strict=True)))
    steps = np.array(_offsets(n, 1))
    moves = np.array([sum(step * np.array(table.strides)) for step in steps])
    near = [
        axis.take(home[:, np.newaxis] + moves) + steps[:, i]
        for i, axis in enumerate(table.places)
    ]
    near = [q.astype(table.places.dtype, copy=False) for q in near]
    return Lists(near, corner, inner, parts, second)


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
    home = table.index(cells) if table else None
    found: list[Reals] = []
    for step in steps:
        if table and home is not None:
            move = sum(s * k for s, k in zip(step, table.strides, strict=True))
            q = [axis.take(home + move, mode="clip") for axis in table.places]
        else:
            near = [c + s for c, s in zip(cells, step, strict=True)]
            q = list(_hashed(near, seed, period, t[0].dtype))
        for component, s, place in zip(q, step, t, strict=True):
            component += s
            component -= place
        _keep(found, _squared_length(q), second)
    return found


def _hashed(
    cells: list[Cells], seed: int, period: int | None, dtype: np.dtype
) -> Reals:
    """Give the points of cells, axis first."""
    words = [_wrapped(c, period).astype(np.uint64) for c in cells]
    return _places(words, seed).astype(dtype, copy=False)
