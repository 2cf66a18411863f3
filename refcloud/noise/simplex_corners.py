"""The corners of a place's simplex, visited one after the other, a chunk at a time."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.noise.directions import SETS, USUAL, Radius
from refcloud.noise.mixing import (
    Bits,
    Hash,
    _axis_bits,
    _chosen,
    _finished,
    _joined,
)
from refcloud.noise.scattered import Dtype, Numbers, _Room

# A chunk's cells share their hashed lines where an axis has fewer: 16 KiB of them.
MOST_LINES = 1 << 12
SPARE = 8  # lines more at both ends: the next chunk's cells reach a little further

Columns = Sequence[Array] | Array  # coordinates by axis

# Squared radius of the kernel. A corner's opposite face lies at a distance whose square
# is 1/2 in each dimension: a larger kernel is cut there, and jumps (E30).
SQUARED: dict[Radius, float] = {"continuous": 0.5, "usual": 0.6}

# Largest sum of kernels times the best gradients, by dimension and radius: what noise
# is divided by, so that it stays in [-1, 1]. Each encloses the true supremum from above
# by 0.5 % in the plane and space and 3 % in four dimensions, see the tests.
PEAKS: dict[tuple[int, Radius], float] = {
    (2, "continuous"): 0.010131,
    (2, "usual"): 0.029026,
    (3, "continuous"): 0.013073,
    (3, "usual"): 0.030738,
    (4, "continuous"): 0.016410,
    (4, "usual"): 0.037830,
}


def _skews(dimensions: int) -> tuple[float, float]:
    """Give the factors F and G of the coordinates' sum: to the cubes, and back."""
    root = math.sqrt(dimensions + 1.0)
    return (root - 1.0) / dimensions, (1.0 - 1.0 / root) / dimensions


def _corners(
    columns: Columns,
    seed: int,
    radius: Radius,
    hash: Hash,
    dtype: Dtype,
    room: _Room | None = None,
) -> Iterator[tuple[Numbers, Numbers, Numbers]]:
    """Visit the N + 1 corners: offsets and gradients by axis, and what is left of r^2.

    All are overwritten by the next corner's. What is left is not below 0.

    The walk: from a corner to the next it is one step along one axis, the longest not
    yet taken. So offsets and hashed words are not made anew but moved along. Every
    pass reads and writes arrays of a chunk, which stay in the cache, at 0.1 ns a number
    in float32 and 0.2 in float64. In space, in ns: 7 for the place in float64 (25
    passes), 6 for the hashed lines, 4 for the steps, 16 for hashes, kernels and dots
    (28 passes by 4 corners), and 6 for 12 look-ups: 39, of measured 45.
    """
    n, shape = len(columns), _broadcast(columns)
    room = room or _Room()
    F, G = _skews(n)
    # 1. Find the cube of the skewed lattice, and the place relative to its corner.
    cells, shift = room.take("cells", (n, *shape), float), room.take("x", shape, float)
    _sum(columns, shift)
    shift *= F
    for column, cell in zip(columns, cells, strict=True):
        np.add(column, shift, out=cell)
    np.floor(cells, out=cells)
    _sum(cells, shift)
    shift *= G
    start, first = room.take("d0", (n, *shape), dtype), room.take("first", shape, float)
    for k, (column, cell) in enumerate(zip(columns, cells, strict=True)):
        np.subtract(column, cell, out=first)
        first += shift
        start[k] = first
    # 2. Rank the axes, the longest first: each comparison moves one of two back.
    rank = room.take("rank", (n, *shape), np.uint8)
    taken = room.take("taken", rank.shape, bool)
    flag = taken[0]
    rank[...] = 0
    for i in range(n):
        for j in range(i + 1, n):
            rank[j] += np.greater_equal(start[i], start[j], out=flag).view(np.uint8)
            rank[i] += np.logical_not(flag, out=flag).view(np.uint8)
    # 3. Choose the gradients of all corners.
    rows = (SETS[USUAL[n]].T / PEAKS[n, radius]).astype(dtype)
    picks = _picks(cells, rank, seed, hash, rows.shape[1], room)
    d, slope = (room.take(name, (n, *shape), dtype) for name in ("d", "slope"))
    kernel, nothing = room.take("kernel", shape, dtype), room.take("zero", shape, dtype)
    nothing[...] = 0.0  # the maximum with an array is quicker than with a number
    number, pick = (
        room.take("number", d.shape, dtype),
        room.take("pick", shape, np.intp),
    )
    for corner in range(n + 1):
        # 4. Step along the longest axis left. Booleans are cast before they are
        # subtracted: otherwise numpy casts them through small buffers.
        if corner == 0:
            d[...] = start
        elif corner == n:
            np.subtract(start, 1.0 - n * G, out=d)
        else:
            number[...] = np.equal(rank, corner - 1, out=taken)
            d += G
            d -= number
        # 5. Look up the gradient, and see how far the corner's kernel reaches.
        pick[...] = picks[corner]
        rows.take(pick, axis=1, mode="wrap", out=slope)
        np.subtract(SQUARED[radius], _dotted(d, d, kernel, number), out=kernel)
        yield d, slope, np.maximum(kernel, nothing, out=kernel)


def _picks(
    cells: Array,
    rank: NDArray[np.uint8],
    seed: int,
    hash: Hash,
    count: int,
    room: _Room,
) -> NDArray[np.uint8]:
    """Choose one of `count` gradients for each corner, shape (N + 1, ...).

    From a corner to the next the word of one axis changes to that of its next line. The
    mixed hash adds the axes' words before it mixes them: the sum is all that it needs,
    and those of all corners are mixed together. The cells are overwritten.
    """
    n, shape = len(cells), cells.shape[1:]
    words, ahead = _lines(cells, seed, hash, room)
    taken = room.take("taken", rank.shape, bool)
    change = room.take("change", words.shape, np.uint32)
    picks = room.take("picks", (n + 1, *shape), np.uint8)
    if hash == "table":
        for corner in range(n + 1):
            np.less(rank, corner, out=taken)
            stepped = words + taken * ahead
            picks[corner] = _chosen(_joined(list(stepped), seed, hash), count)
        return picks
    sums = room.take("sums", (n + 1, *shape), np.uint32)
    _sum(words, sums[0])
    for corner in range(1, n):
        change[...] = np.equal(rank, corner - 1, out=taken)
        change *= ahead
        _sum(change, sums[corner])
        sums[corner] += sums[corner - 1]
    _sum(ahead, sums[n])
    sums[n] += sums[0]
    bits = _finished(sums, room.take("high", sums.shape, np.uint32))
    picks[...] = _chosen(bits, count, out=bits)
    return picks


def _lines(cells: Array, seed: int, hash: Hash, room: _Room) -> tuple[Bits, Bits]:
    """Hash the lattice lines of cells by axis, and give what to add for the next line.

    Cells close together share few lines: those are hashed once for all chunks, and
    looked up. The cells are overwritten.
    """
    words, ahead = (room.take(s, cells.shape, np.uint32) for s in ("words", "ahead"))
    spread = tuple(range(1, cells.ndim))
    low, high = cells.min(axis=spread), cells.max(axis=spread)
    if (high - low).max() < MOST_LINES:
        low = _hash_lines(low, high, seed, hash, room)
        cells -= low.reshape(-1, *[1] * len(spread))
        index = room.take("index", cells.shape, np.intp)
        index[...] = cells
        for k, (bits, change) in enumerate(room.lines):
            bits.take(index[k], mode="wrap", out=words[k])
            change.take(index[k], mode="wrap", out=ahead[k])
    else:
        for k, cell in enumerate(cells):
            at = cell.astype(np.int64)
            words[k] = _axis_bits(at, k, seed, hash)
            ahead[k] = _axis_bits(at + 1, k, seed, hash) - words[k]
    return words, ahead


def _hash_lines(low: Array, high: Array, seed: int, hash: Hash, room: _Room) -> Array:
    """Keep the hashed lines from low to high in the room, and say where they begin."""
    if room.lines and (low >= room.ends[0]).all() and (high <= room.ends[1]).all():
        return room.ends[0]
    low, high = low - SPARE, high + SPARE
    if room.lines:
        wide = np.minimum(low, room.ends[0]), np.maximum(high, room.ends[1])
        # Places that wander off leave their first lines behind.
        low, high = wide if (wide[1] - wide[0]).max() < 2 * MOST_LINES else (low, high)
    room.ends = low, high
    room.lines = []
    for k, (first, last) in enumerate(zip(low, high, strict=True)):
        bits = _axis_bits(np.arange(int(first), int(last) + 2), k, seed, hash)
        room.lines.append((bits, np.diff(bits)))
    return low


def _broadcast(columns: Columns) -> tuple[int, ...]:
    if isinstance(columns, np.ndarray):
        return columns.shape[1:]
    return np.broadcast_shapes(*(column.shape for column in columns))


def _sum(columns: Columns | Bits, out: Numbers) -> None:
    """Add the axes' arrays, which broadcast."""
    np.add(columns[0], columns[1], out=out)
    for column in columns[2:]:
        out += column


def _dotted(a: Numbers, b: Numbers, out: Numbers, product: Numbers) -> Numbers:
    """Sum the products along the axes."""
    np.multiply(a, b, out=product)
    np.add(product[0], product[1], out=out)
    for other in product[2:]:
        out += other
    return out
