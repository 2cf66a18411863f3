"""Simplex noise in 2, 3 and 4 dimensions, one text for all: N + 1 corners, no blends.

Space is cut into simplices by skewing it, so that a cube's corner sums become whole.
Which simplex of the skewed cube a point lies in follows from the order of its
coordinates. Each corner adds a radial kernel times the dot of its gradient and the
offset: nothing is interpolated, and the derivative has a closed form.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Seed
from refcloud.noise.directions import SETS, USUAL, Radius
from refcloud.noise.mixing import Bits, Hash, _axis_bits, _choice, _joined, lattice_bits
from refcloud.noise.scattered import (
    Dtype,
    Numbers,
    Places,
    _dimensions,
    _scattered,
)

# Coordinates are taken modulo this: in space it is a period of the lattice and of its
# hash. Other dimensions have none along an axis, and a seam out there.
WRAP = 3 * 2**32
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


@checked
def simplex(
    points: Places,
    *,
    seed: Seed = 0,
    radius: Radius = "continuous",
    hash: Hash = "mixed",
    dtype: Dtype = "float64",
) -> Numbers:
    """Give simplex noise at scattered points.

    Formula: n(p) = sum over the simplex's corners c of max(0, r^2 - |d|^2)^4 g(c) . d,
    d = p - c, scaled

    Parameters
    ----------
    points
        Shape (..., 2), (..., 3) or (..., 4). The lattice's shortest edge is about 0.8
        to 0.9 of a unit. NaN or infinity gives NaN.
    seed
        Which pattern. Patterns of two seeds have nothing in common.
    radius
        How far a corner reaches. "continuous" is r^2 = 1/2, "usual" is r^2 = 0.6, which
        jumps between simplices by up to some thousandths (E30).
    hash
        How a lattice point chooses its gradient. "table" is the shuffled table, with
        its period of 256 lattice points (N03).
    dtype
        Precision of the arithmetic and the result; offsets are found in float64.

    Returns
    -------
    Shape (...,), in [-1, 1].

    Source: document S (N22); E30.

    Examples
    --------
    >>> simplex(np.zeros((5, 2, 4)), seed=7).shape
    (5, 2)
    """
    _dimensions(points, (2, 3, 4))
    return _scattered(
        points,
        lambda columns: _simplex(columns, seed, radius, hash, dtype),
        dtype,
        WRAP,
    )


@checked
def simplex_derivative(
    points: Places,
    *,
    seed: Seed = 0,
    radius: Radius = "continuous",
    hash: Hash = "mixed",
    dtype: Dtype = "float64",
) -> tuple[Numbers, Numbers]:
    """Give simplex noise and its derivative, from one visit of the corners.

    Formula: dn/dp = sum over c of k^4 g - 8 k^3 (g . d) d, k = max(0, r^2 - |d|^2)

    Parameters
    ----------
    points
        Shape (..., 2), (..., 3) or (..., 4). NaN or infinity gives NaN.
    seed
        Which pattern.
    radius
        How far a corner reaches.
    hash
        How a lattice point chooses its gradient.
    dtype
        Precision of the arithmetic and the result.

    Returns
    -------
    The noise, shape (...,), and its derivative, shape (..., N).

    Source: document S (N23).

    Examples
    --------
    >>> noise, slope = simplex_derivative(np.zeros((5, 3)), seed=7)
    >>> noise.shape, slope.shape
    ((5,), (5, 3))
    """
    count = _dimensions(points, (2, 3, 4))
    both = _scattered(
        points,
        lambda columns: _derivative(columns, seed, radius, hash, dtype),
        dtype,
        WRAP,
        results=1 + count,
    )
    return both[..., 0], both[..., 1:]


def _skews(dimensions: int) -> tuple[float, float]:
    """Give the factors F and G of the coordinates' sum: to the cubes, and back."""
    root = math.sqrt(dimensions + 1.0)
    return (root - 1.0) / dimensions, (1.0 - 1.0 / root) / dimensions


def _literal(points: Array, seed: int, radius: Radius) -> Array:
    """Give simplex noise as its formula says it: corner by corner, whole at once."""
    n = points.shape[-1]
    F, G = _skews(n)
    rows = SETS[USUAL[n]]
    cells = np.floor(points + F * points.sum(axis=-1, keepdims=True))
    first = points - cells + G * cells.sum(axis=-1, keepdims=True)
    rank = np.argsort(np.argsort(-first, axis=-1, kind="stable"), axis=-1)
    total = np.zeros(points.shape[:-1])
    for corner in range(n + 1):
        step = rank < corner  # one more axis for each corner, the longest first
        d = first - step + corner * G
        lattice = np.moveaxis((cells + step).astype(np.int64), -1, 0)
        slope = rows[_choice(lattice_bits(*lattice, seed=seed), len(rows))]
        kernel = np.maximum(SQUARED[radius] - np.sum(d * d, axis=-1), 0.0)
        total += kernel**4 * np.sum(slope * d, axis=-1)
    return total / PEAKS[n, radius]


def _simplex(
    columns: Columns, seed: int, radius: Radius, hash: Hash, dtype: Dtype
) -> Numbers:
    """Give simplex noise at finite places, one array per axis, which broadcast."""
    total: Any = 0.0
    for d, slope, kernel in _corners(columns, seed, radius, hash, dtype):
        part = _dotted(slope, d)
        kernel *= kernel
        kernel *= kernel
        part *= kernel
        part += total
        total = part
    return total


def _derivative(
    columns: Columns, seed: int, radius: Radius, hash: Hash, dtype: Dtype
) -> list[Numbers]:
    """Give simplex noise and its derivative along each axis."""
    results: list[Any] = [0.0] * (1 + len(columns))
    for d, slope, kernel in _corners(columns, seed, radius, hash, dtype):
        dot = _dotted(slope, d)
        fourth, change = kernel**4, 8.0 * kernel**3 * dot
        results[0] = results[0] + fourth * dot
        for k, (g, along) in enumerate(zip(slope, d, strict=True), 1):
            results[k] = results[k] + (fourth * g - change * along)
    return results


def _corners(
    columns: Columns, seed: int, radius: Radius, hash: Hash, dtype: Dtype
) -> Iterator[tuple[list[Numbers], list[Numbers], Numbers]]:
    """Visit the N + 1 corners: offsets and gradients by axis, and what is left of r^2.

    The offsets are overwritten by the next corner's. What is left is not below 0.

    The walk: from a corner to the next it is one step along one axis, the longest not
    yet taken. So offsets and hashed words are not made anew but moved along. Every
    pass reads and writes arrays of a chunk, which stay in the cache, at about 0.1 ns
    a number in float32: in space some 25 passes in float64 for the place, 6 for each
    corner's step along each axis, 25 for its hash, kernel and dot, and 3 look-ups of
    0.6 ns each: 40 ns.
    """
    n = len(columns)
    F, G = _skews(n)
    # 1. Find the cube of the skewed lattice, and the place relative to its corner.
    skewed = F * _sum(columns)
    cells = [np.floor(column + skewed) for column in columns]
    back = G * _sum(cells)
    d = []
    for column, cell in zip(columns, cells, strict=True):
        first = column - cell
        first += back
        d.append(first.astype(dtype, copy=False))
    # 2. Rank the axes, the longest first: each comparison moves one of two back.
    rank = np.zeros((n, *d[0].shape), np.uint8)
    for i in range(n):
        for j in range(i + 1, n):
            longer = (d[i] >= d[j]).view(np.uint8)
            rank[j] += longer
            rank[i] += longer ^ 1
    # 3. Hash the lines through the corner, and how the hash changes one line on.
    words, ahead = _lines(cells, seed, hash)
    rows = (SETS[USUAL[n]].T / PEAKS[n, radius]).astype(dtype)
    for corner in range(n + 1):
        # 4. Step along the longest axis left. Booleans are cast before they are
        # multiplied: otherwise numpy casts them through small buffers.
        for k in range(n if corner else 0):
            step = rank[k] == corner - 1
            d[k] += G
            d[k] -= step.astype(dtype)
            words[k] += ahead[k] * step.astype(words[k].dtype)
        # 5. Look up the gradient, and see how far the corner's kernel reaches.
        pick = _choice(_joined(words, seed, hash), rows.shape[1])
        slope = [row.take(pick, mode="wrap") for row in rows]
        kernel = _dotted(d, d)
        np.subtract(SQUARED[radius], kernel, out=kernel)
        yield d, slope, np.maximum(kernel, 0.0, out=kernel)


def _lines(cells: list[Array], seed: int, hash: Hash) -> tuple[list[Bits], list[Bits]]:
    """Hash the lattice lines of cells by axis, and give what to add for the next line.

    Cells close together share few lines: those are hashed once, and looked up.
    """
    words, ahead = [], []
    for k, cell in enumerate(cells):
        low, high = int(cell.min()), int(cell.max())
        if high - low < MOST_LINES:
            bits = _axis_bits(np.arange(low, high + 2), k, seed, hash)
            at = (cell - low).astype(np.intp)
            words.append(bits.take(at, mode="clip"))
            ahead.append(np.diff(bits).take(at, mode="clip"))
        else:
            at = cell.astype(np.int64)
            words.append(_axis_bits(at, k, seed, hash))
            ahead.append(_axis_bits(at + 1, k, seed, hash) - words[k])
    return words, ahead


def _sum(columns: Columns) -> Array:
    """Add the axes' arrays, which broadcast."""
    first, *others = columns
    return functools.reduce(np.add, others, first)


def _dotted(a: list[Numbers], b: list[Numbers]) -> Numbers:
    """Sum the products along the axes."""
    first, *others = zip(a, b, strict=True)
    total = first[0] * first[1]
    product = np.empty_like(total)
    for one, other in others:
        total += np.multiply(one, other, out=product)
    return total
