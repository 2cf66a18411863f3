"""Lattice values of a table around all points, where those lie close together.

Two kinds of table serve. Every hash has that of the box around the points: x, y and z
apart. The paper's hash sees no more than m = x + 57 y + 3249 z (E09), so a table of the
m that occur will do: the box of 100 cells a side holds a million lattice points but
340,000 of these, which stay in the cache.

In both a neighbour is a fixed step away. So a place in the table is a sum of steps, and
each neighbour is read through a view of the table that begins its step further on.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.noise.hashing import ROW, _lattice_random
from refcloud.noise.lattice import Cells, _block, _smoothed_row
from refcloud.noise.scattered import Dtype, Numbers, _index, _Room, _wrapped
from refcloud.noise.weights import Interpolant, _reach

MOST_LATTICE = 1 << 21  # lattice values at a time: 16 MB, held some three times
SLAB = 1 << 16  # of them in one step over a row
STEPS = (1, ROW, ROW * ROW)  # of the paper's m


@dataclass(frozen=True)
class How:
    """How value noise is made."""

    seed: int | None
    interpolant: Interpolant
    smooth: bool
    period: int | None = None
    dtype: Dtype = "float64"


@dataclass(frozen=True)
class Table:
    """The lattice values around points that lie close together.

    Attributes
    ----------
    low
        The cell whose first neighbour stands at 0.
    steps
        How much further on the next lattice value along x, y and z stands.
    values
        f, in one row.
    taps
        How many neighbours a point has along each axis.
    """

    low: list[int]
    steps: tuple[int, int, int]
    values: Numbers
    taps: int

    def layers(self, cells: Array, room: _Room) -> Iterator[Numbers]:
        """Look up f around whole numbers (3, n): layer by layer, [y, x, point].

        Each layer overwrites the one before. The cells are read at once.
        """
        start = _index(cells, self.low, np.array(self.steps))
        return self._layers(start, room)

    def _layers(self, start: NDArray[np.intp], room: _Room) -> Iterator[Numbers]:
        x, y, z = self.steps
        f = room.take("f", (self.taps, self.taps, start.size), self.values.dtype)
        for k in range(self.taps):
            for j, i in np.ndindex(f.shape[:2]):
                # A view that starts further on spares adding to every index.
                ahead = self.values[k * z + j * y + i * x :]
                ahead.take(start, None, f[j, i], "wrap")
            yield f


def _ends(cells: Array) -> Cells:
    """Give the lowest and the highest of cells (3, n) along each axis, (3, 2)."""
    ends = np.stack((cells.min(axis=1), cells.max(axis=1)), axis=1)
    return ends.astype(np.int64)


def _table(ends: Cells, points: int, how: How) -> Table | None:
    """Hash around cells from ends[:, 0] to ends[:, 1], if that is less work."""
    reach = _reach(how.interpolant)
    halo = int(how.smooth)
    lows = [int(low) + reach[0] for low, _ in ends]
    counts = [int(high) - int(low) + len(reach) for low, high in ends]
    box = math.prod(count + 2 * halo for count in counts)
    row = sum(
        s * (count - 1 + 2 * halo) for s, count in zip(STEPS, counts, strict=True)
    )
    linear = how.seed is None and how.period is None and row < box
    size = row + 1 if linear else box
    if 2 * size > points * (len(reach) + 2 * halo) ** 3 or size > MOST_LATTICE:
        return None
    low = [first - reach[0] for first in lows]
    if linear:
        first = sum(s * c for s, c in zip(STEPS, lows, strict=True))
        values = _row(first, row + 1 - 2 * halo * sum(STEPS), how)
        return Table(low, STEPS, values, len(reach))
    lines = (
        _wrapped(np.arange(first - halo, first + count + halo), how.period)
        for first, count in zip(lows, counts, strict=True)
    )
    x, y, _ = counts
    values = _block(*lines, seed=how.seed, smooth=how.smooth, dtype=how.dtype)
    return Table(low, (1, x, x * y), values.reshape(-1), len(reach))


def _row(first: int, count: int, how: How) -> Numbers:
    """Give f for the paper's m from first on."""
    halo = sum(STEPS) if how.smooth else 0
    values = np.empty(count, how.dtype)
    for start in range(0, count, SLAB):
        part = values[start : start + SLAB]
        low = first + start - halo
        m = np.arange(low, low + part.size + 2 * halo).astype(np.uint64)
        zero = np.zeros(1, np.uint64)
        g = _lattice_random(m, zero, zero, None)
        part[...] = _smoothed_row(g, STEPS) if how.smooth else g
    return values
