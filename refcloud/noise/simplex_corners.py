"""The corners of a place's simplex, visited one after the other, a chunk at a time."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from refcloud.conventions import Array
from refcloud.noise.directions import SETS, USUAL, Radius
from refcloud.noise.mixing import Bits, Hash, _axis_bits, _choice, _joined
from refcloud.noise.scattered import Dtype, Numbers, _Room

# A chunk's cells share their hashed lines where an axis has fewer: 16 KiB of them.
MOST_LINES = 1 << 12

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
    pass reads and writes arrays of a chunk, which stay in the cache, at 0.2 ns a number
    in float32. In space, in ns: 8 for the place in float64 (25 passes), 10 for the
    hashed lines, 12 for the steps (7 passes by 3 axes by 3), 24 for hashes, kernels
    and dots (30 passes by 4 corners), and 9 for 12 look-ups: 63, of measured 70.
    """
    n, shape = len(columns), _broadcast(columns)
    room = room or _Room()
    F, G = _skews(n)
    # 1. Find the cube of the skewed lattice, and the place relative to its corner.
    cells, shift = room.take("cells", (n, *shape), float), room.take("x", shape, float)
    _sum(columns, shift)
    shift *= F
    for column, cell in zip(columns, cells, strict=True):
        np.floor(np.add(column, shift, out=cell), out=cell)
    _sum(cells, shift)
    shift *= G
    d, first = room.take("d", (n, *shape), dtype), room.take("first", shape, float)
    for k, (column, cell) in enumerate(zip(columns, cells, strict=True)):
        np.subtract(column, cell, out=first)
        first += shift
        d[k] = first
    # 2. Rank the axes, the longest first: each comparison moves one of two back.
    rank = room.take("rank", (n, *shape), np.uint8)
    taken = room.take("taken", rank.shape, bool)
    flag = taken[0]
    rank[...] = 0
    for i in range(n):
        for j in range(i + 1, n):
            rank[j] += np.greater_equal(d[i], d[j], out=flag).view(np.uint8)
            rank[i] += np.logical_not(flag, out=flag).view(np.uint8)
    # 3. Hash the lines through the corner, and how the hash changes one line on.
    words, ahead = _lines(cells, seed, hash, room)
    rows = (SETS[USUAL[n]].T / PEAKS[n, radius]).astype(dtype)
    slope = room.take("slope", (n, *shape), dtype)
    kernel, nothing = room.take("kernel", shape, dtype), room.take("zero", shape, dtype)
    nothing[...] = 0.0  # the maximum with an array is quicker than with a number
    number, whole = (room.take(str(t), d.shape, t) for t in (dtype, words.dtype))
    for corner in range(n + 1):
        # 4. Step along the longest axis left. Booleans are cast before they are
        # multiplied: otherwise numpy casts them through small buffers.
        if corner:
            np.equal(rank, corner - 1, out=taken)
            number[...] = taken
            d += G
            d -= number
            whole[...] = taken
            whole *= ahead
            words += whole
        # 5. Look up the gradient, and see how far the corner's kernel reaches.
        pick = _choice(_joined(list(words), seed, hash), rows.shape[1])
        rows.take(pick, axis=1, mode="wrap", out=slope)
        np.subtract(SQUARED[radius], _dotted(d, d, kernel, number), out=kernel)
        yield d, slope, np.maximum(kernel, nothing, out=kernel)


def _lines(cells: Array, seed: int, hash: Hash, room: _Room) -> tuple[Bits, Bits]:
    """Hash the lattice lines of cells by axis, and give what to add for the next line.

    Cells close together share few lines: those are hashed once, and looked up. The
    cells are overwritten.
    """
    words, ahead = (room.take(s, cells.shape, np.uint32) for s in ("words", "ahead"))
    index = room.take("index", cells.shape[1:], np.intp)
    for k, cell in enumerate(cells):
        low, high = int(cell.min()), int(cell.max())
        if high - low < MOST_LINES:
            bits = _axis_bits(np.arange(low, high + 2), k, seed, hash)
            cell -= low
            index[...] = cell
            bits.take(index, mode="wrap", out=words[k])
            np.diff(bits).take(index, mode="wrap", out=ahead[k])
        else:
            at = cell.astype(np.int64)
            words[k] = _axis_bits(at, k, seed, hash)
            ahead[k] = _axis_bits(at + 1, k, seed, hash) - words[k]
    return words, ahead


def _broadcast(columns: Columns) -> tuple[int, ...]:
    return np.broadcast_shapes(*(column.shape for column in columns))


def _sum(columns: Columns, out: Array) -> None:
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
