"""Gradient noise at scattered points: two corners of a cell in every look-up.

The ends of a cell along x have one gradient each, of 12 at most: 144 pairs. A pair is
one number, and every look-up by it brings what belongs to both ends, side by side:

1. find the number of the pair at each of the cell's four edges along x, from a table of
   the lattice box around all points where that is small, else by hashing;
2. look up both gradients of each edge along one axis, times the offset, and add;
3. blend along z and y, two ends at a time, and along x last.

Per point in space, in float32: 4 look-ups of a byte at 1.2 ns, 12 of two floats at 0.6,
and 6 passes over 8 corners at 0.1: a floor of 17 ns. Splitting and numbering the cells
take 8, fades 2, writing offsets and fades side by side 4, blends 3, and the box 2 to 3.
Numbers and their order are those of single corners, so the bits are the same.
"""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.noise.mixing import Bits, Hash, _axis_bits, _chosen, _joined
from refcloud.noise.scattered import Numbers, _bounds, _index, _Room

MOST_LATTICE = 1 << 21  # bytes of a box: beyond, the cache misses cost what it saves
WORTH = 2  # lattice points hashed for a box take less time than one point's corners
SLAB = 1 << 15  # lattice points hashed at a time

Pairs = NDArray[np.uint8]


@dataclass(frozen=True)
class Lattice:
    """Which gradient each lattice point has: the count, and how one is chosen."""

    gradients: int
    seed: int
    hash: Hash
    period: int | None

    def words(self, line: NDArray[np.int64], axis: int) -> Bits:
        """Mix lattice coordinates along an axis, modulo the period."""
        most = 1 << 32 if self.period is None else self.period
        return _axis_bits(np.mod(line, most), axis, self.seed, self.hash)

    def picks(self, words: list[Bits]) -> NDArray[np.uint8]:
        """Choose gradients where axes' words, which broadcast, meet."""
        bits = _joined(words, self.seed, self.hash)
        return _chosen(bits, self.gradients).astype(np.uint8)


@dataclass(frozen=True)
class PairBox:
    """The number of the pair at every lattice point of a box and its neighbour along x.

    Attributes
    ----------
    low
        The lowest cell's coordinates, one per axis.
    steps
        How much further on the next pair along each axis stands.
    pairs
        The numbers, flat.
    """

    low: list[int]
    steps: NDArray[np.int64]
    pairs: NDArray[np.uint8]

    def at(self, cells: Array, room: _Room) -> Pairs:
        """Look up the pairs of whole numbers (N, n), shape (..., 2, n) as [y, z, n]."""
        start = _index(cells, self.low, self.steps)
        _, *across = (int(step) for step in self.steps)
        edges = room.take("edges", (2 ** len(across), start.size), np.uint8)
        for edge, corner in zip(edges, _corners(len(across)), strict=True):
            # A view that starts further on spares adding to every index.
            ahead = sum(s * c for s, c in zip(across, corner, strict=True))
            self.pairs[ahead:].take(start, None, edge, "wrap")
        return edges.reshape(*[2] * len(across), -1)


def _pair_box(points: Array, lattice: Lattice) -> PairBox | None:
    """Give the numbered pairs of the box around all points, if that is less work.

    Points that are far apart, or not finite, have no box.
    """
    count = points.size // points.shape[-1]
    for cells in _bounds(points, lattice.period):
        counts = [int(high - low) + 2 for low, high in cells]
        size = math.prod(counts)
        if size <= min(MOST_LATTICE, WORTH * count):
            return _filled(lattice, [int(low) for low, _ in cells], counts)
    return None


def _filled(lattice: Lattice, low: list[int], counts: list[int]) -> PairBox:
    """Hash every lattice point of a box once; count lines from low along each axis."""
    words = [
        lattice.words(np.arange(first, first + count), axis).reshape(
            (-1,) + (1,) * axis
        )
        for axis, (first, count) in enumerate(zip(low, counts, strict=True))
    ]
    *inner, outer = words
    pairs = np.empty((*counts[:0:-1], counts[0] - 1), np.uint8)
    planes = max(1, SLAB // math.prod(counts[:-1]))
    for first in range(0, len(outer), planes):
        part = slice(first, first + planes)
        pick = lattice.picks([*inner, outer[part]])
        np.multiply(pick[..., :-1], lattice.gradients, out=pairs[part])
        pairs[part] += pick[..., 1:]
    steps = np.cumprod([1, counts[0] - 1, *counts[1:-1]])
    return PairBox(low, steps, pairs.reshape(-1))


def _corners(axes: int) -> list[tuple[int, ...]]:
    """List the ends of all axes but x, those of the last one beside each other."""
    return list(itertools.product((0, 1), repeat=axes))


def _hashed_pairs(lows: Array, lattice: Lattice) -> Pairs:
    """Hash the corners of cells (N, n) and number their pairs: [y, z, n]."""
    cells, words = lows.astype(np.int64), []
    for axis, cell in enumerate(cells):
        shape = [2 if k == axis else 1 for k in range(len(cells))]
        both = np.stack((cell, cell + 1))
        words.append(lattice.words(both, axis).reshape(*shape, -1))
    pick = lattice.picks(words)
    pair = pick[0]
    pair *= lattice.gradients
    pair += pick[1]
    return pair


@functools.lru_cache(maxsize=32)
def _pair_table(rows: bytes, count: int, dtype: str) -> Numbers:
    """Give both gradients of every pair, (N, count^2, 2), from rows (N, count)."""
    each = np.frombuffer(rows).reshape(-1, count).astype(dtype)
    table = np.stack(
        (np.repeat(each, count, axis=1), np.tile(each, (1, count))), axis=-1
    )
    table.setflags(write=False)
    return table


def _paired(
    places: Numbers, fades: Numbers, pairs: Pairs, rows: Array, room: _Room
) -> Numbers:
    """Blend the corners' gradients times the offsets from them, places (N, n).

    The next call with the same room overwrites the result.
    """
    n, dtype = places.shape[1], places.dtype
    table = _pair_table(rows.tobytes(), rows.shape[1], dtype.str)
    # Both ends of x lie side by side; along the other axes they have the same offset.
    offset = _side_by_side(places, room.take("offset", (*places.shape, 2), dtype))
    fade = _side_by_side(fades[1:], room.take("fade", (len(table) - 1, n, 2), dtype))
    offset[0, 1::2] -= 1.0
    beyond = np.subtract(
        offset[1:], 1.0, out=room.take("beyond", fade.shape, dtype)
    )  # from the other ends
    # One end along y after the other, each with both ends along z where there are.
    pairs = pairs.reshape(2, -1, n)
    total = room.take("total", (*pairs.shape[:2], 2 * n), dtype)
    slope = room.take("slope", total.shape[1:], dtype)
    pair = room.take("pair", pairs.shape[1:], np.intp)
    for both, edges, along_y in zip(total, pairs, (offset[1], beyond[0]), strict=True):
        pair[...] = edges
        _look_up(table[0], pair, both)
        both *= offset[0]
        _look_up(table[1], pair, slope)
        slope *= along_y
        both += slope
        if len(table) == 3:
            _look_up(table[2], pair, slope)
            slope[0] *= offset[2]
            slope[1] *= beyond[1]
            both += slope
            _blend(both[0], both[1], fade[1])
    # What was blended along z stands where its upper end was.
    low, high = total[:, -1]
    _blend(low, high, fade[0])
    low, high = high[0::2], high[1::2]
    blended = np.subtract(high, low, out=room.take("blended", (n,), dtype))
    blended *= fades[0]
    blended += low
    return blended


def _look_up(both: Numbers, pair: NDArray[np.intp], out: Numbers) -> None:
    """Write the two numbers of every pair side by side, (..., n) to (..., 2n)."""
    # The method: numpy's function of that name takes a microsecond more.
    both.take(pair, 0, out.reshape(*pair.shape, 2), "wrap")


def _blend(low: Numbers, high: Numbers, fade: Numbers) -> None:
    """Go from low to high as far as the fade says, in place of high."""
    high -= low
    high *= fade
    high += low


def _side_by_side(rows: Numbers, out: Numbers) -> Numbers:
    """Write every number twice, (N, n) to (N, 2n)."""
    out[..., 0] = rows
    out[..., 1] = rows
    return out.reshape(len(rows), -1)
