"""Simplex noise in 2, 3 and 4 dimensions, one text for all: N + 1 corners, no blends.

Space is cut into simplices by skewing it, so that a cube's corner sums become whole.
Which simplex of the skewed cube a point lies in follows from the order of its
coordinates. Each corner adds a radial kernel times the dot of its gradient and the
offset: nothing is interpolated, and the derivative has a closed form.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Seed
from refcloud.noise.directions import SETS, USUAL, Radius
from refcloud.noise.mixing import Hash, _choice, lattice_bits
from refcloud.noise.scattered import (
    Dtype,
    Numbers,
    Places,
    _dimensions,
    _Room,
    _scattered,
)
from refcloud.noise.simplex_corners import (
    PEAKS,
    SQUARED,
    Columns,
    _broadcast,
    _corners,
    _dotted,
    _skews,
)

# Coordinates are taken modulo this: in space it is a period of the lattice and of its
# hash. Other dimensions have none along an axis, and a seam out there.
WRAP = 3 * 2**32


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
    room = _Room()
    return _scattered(
        points,
        lambda columns: _simplex(columns, seed, radius, hash, dtype, room),
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
    columns: Columns,
    seed: int,
    radius: Radius,
    hash: Hash,
    dtype: Dtype,
    room: _Room | None = None,
) -> Numbers:
    """Give simplex noise at finite places, one array per axis, which broadcast.

    The next call with the same room overwrites the result.
    """
    room = room or _Room()
    total = room.take("total", _broadcast(columns), dtype)
    part = room.take("part", total.shape, dtype)
    products = room.take("products", (len(columns), *total.shape), dtype)
    total[...] = 0.0
    for d, slope, kernel in _corners(columns, seed, radius, hash, dtype, room):
        kernel *= kernel
        kernel *= kernel
        kernel *= _dotted(slope, d, part, products)
        total += kernel
    return total


def _derivative(
    columns: Columns, seed: int, radius: Radius, hash: Hash, dtype: Dtype
) -> list[Numbers]:
    """Give simplex noise and its derivative along each axis."""
    results: list[Any] = [0.0] * (1 + len(columns))
    for d, slope, kernel in _corners(columns, seed, radius, hash, dtype):
        dot = _dotted(slope, d, np.empty_like(kernel), np.empty_like(d))
        fourth, change = kernel**4, 8.0 * kernel**3 * dot
        results[0] = results[0] + fourth * dot
        for k, (g, along) in enumerate(zip(slope, d, strict=True), 1):
            results[k] = results[k] + (fourth * g - change * along)
    return results
