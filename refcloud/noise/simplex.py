"""Simplex noise in 2, 3 and 4 dimensions, one text for all: N + 1 corners, no blends.

Space is cut into simplices by skewing it, so that a cube's corner sums become whole.
Which simplex of the skewed cube a point lies in follows from the order of its
coordinates. Each corner adds a radial kernel times the dot of its gradient and the
offset: nothing is interpolated, and the derivative has a closed form.
"""

from __future__ import annotations

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Seed
from refcloud.noise.directions import SETS, USUAL, Radius
from refcloud.noise.mixing import Hash, _axis_bits, _choice, _joined, lattice_bits
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
    root = np.sqrt(dimensions + 1.0)
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
    columns: Array, seed: int, radius: Radius, hash: Hash, dtype: Dtype
) -> Numbers:
    """Give simplex noise at finite points, coordinates in rows, shape (N, n)."""
    offsets, slopes, kernel = _corners(columns, seed, radius, hash, dtype)
    total = _dotted(slopes, offsets)
    kernel *= kernel
    kernel *= kernel
    total *= kernel
    return total.sum(axis=0)


def _derivative(
    columns: Array, seed: int, radius: Radius, hash: Hash, dtype: Dtype
) -> list[Numbers]:
    """Give simplex noise and its derivative along each axis."""
    offsets, slopes, kernel = _corners(columns, seed, radius, hash, dtype)
    dot = _dotted(slopes, offsets)
    fourth, change = kernel**4, 8.0 * kernel**3 * dot
    along = [
        (fourth * g - change * d).sum(axis=0)
        for g, d in zip(slopes, offsets, strict=True)
    ]
    return [(fourth * dot).sum(axis=0), *along]


def _corners(
    columns: Array, seed: int, radius: Radius, hash: Hash, dtype: Dtype
) -> tuple[list[Numbers], list[Numbers], Numbers]:
    """Give offsets and gradients of all corners, one array (N + 1, n) per axis.

    The third is what is left of the squared radius, not below 0, shape (N + 1, n).
    """
    n = len(columns)
    F, G = _skews(n)
    # Find the cube of the skewed lattice, and the place relative to its corner.
    cells = np.floor(columns + F * columns.sum(axis=0))
    first = (columns - cells + G * cells.sum(axis=0)).astype(dtype, copy=False)
    # Rank the axes, the longest first: corner c has stepped along those of rank < c.
    rank = np.zeros(first.shape, np.uint8)
    for i in range(n):
        for j in range(i + 1, n):
            longer = first[i] >= first[j]
            rank[j] += longer
            rank[i] += ~longer
    number = np.arange(n + 1, dtype=np.uint8)[:, np.newaxis]
    unskewed = (G * number).astype(dtype)
    words, offsets = [], []
    for k, cell in enumerate(cells.astype(np.int64)):
        stepped = rank[k] < number
        here, there = _axis_bits(np.stack((cell, cell + 1)), k, seed, hash)
        words.append(here + (there - here) * stepped)
        offset = first[k] + unskewed
        offset -= stepped
        offsets.append(offset)
    rows = (SETS[USUAL[n]].T / PEAKS[n, radius]).astype(dtype)
    pick = _choice(_joined(words, seed, hash), rows.shape[1])
    kernel = SQUARED[radius] - _dotted(offsets, offsets)
    slopes = [row.take(pick, mode="wrap") for row in rows]
    return offsets, slopes, np.maximum(kernel, 0.0, out=kernel)


def _dotted(a: list[Numbers], b: list[Numbers]) -> Numbers:
    """Sum the products along the axes."""
    first, *others = zip(a, b, strict=True)
    total = first[0] * first[1]
    for one, other in others:
        total += one * other
    return total
