"""Every random choice of the clustering: where centres start, and who is visited."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.noise.hashing import uniform
from refcloud.products import ONE_THREAD

Labels = NDArray[np.integer]

# First word of each hash, so that no two choices share their numbers.
START, VISIT, SPREAD = 1, 2, 3
# k-means++ draws a batch of new centres at once: this share of those it has.
BATCH = 8
# The start is drawn from so many points for each centre, at least LEAST_DRAWN.
DRAWN_FROM, LEAST_DRAWN = 24, 2048
# Squared distances below this share of the cloud's are rounding of equal points.
SAME = 1e-13


def start_patterns(total: int, count: int, seed: int) -> Labels:
    """Choose patterns at random, none of them twice (E18)."""
    keys = uniform(START, np.arange(total), seed=seed)
    return np.argsort(keys, kind="stable")[:count]


def spaced_patterns(cells: Labels, count: int) -> Labels:
    """Choose cells, shape (K, 3) of whole numbers, evenly along the Z-order curve.

    The curve passes near cells one after the other, so that equal parts of it are
    compact: the cells in their middles are spread as evenly as a lattice.
    """
    key = np.zeros(len(cells), dtype=np.int64)
    for bit in range(int(cells.max(initial=0)).bit_length()):
        for axis in range(3):
            key |= (cells[:, axis] >> bit & 1).astype(np.int64) << (3 * bit + axis)
    count = min(count, len(cells))
    places = ((2 * np.arange(count) + 1) * len(cells)) // (2 * max(count, 1))
    return np.sort(np.argsort(key, kind="stable")[places])


def visits(total: int, epoch: int, seed: int, order: str) -> Labels:
    """Give the order in which an epoch visits the patterns."""
    if order == "raster":
        return np.arange(total)
    keys = uniform(VISIT, epoch, np.arange(total), seed=seed)
    return np.argsort(keys, kind="stable")


def spread_start(points: Array, weights: Array, count: int, seed: int) -> Labels:
    """Draw starting points by weight times squared distance to those drawn before."""
    share = max(DRAWN_FROM * count, LEAST_DRAWN) / max(len(points), 1)
    few = np.flatnonzero(uniform(START, np.arange(len(points)), seed=seed) < share)
    points, weights = points[few], weights[few]
    draws = uniform(SPREAD, np.arange(min(count, len(points))), seed=seed)
    chosen = new = _drawn(weights, draws[:1])
    # |x - c|^2 as a product of the rows [-2c, |c|^2, 1] with the columns [x, 1, |x|^2].
    own = np.einsum("ij,ij->i", points, points)
    columns = np.stack([*points.T, np.ones_like(own), own])
    squares = np.full(len(points), np.inf)
    while len(new) and len(chosen) < count:
        # Keep the distance to the nearest of all that are drawn.
        rows = np.stack([*(-2.0 * points[new].T), own[new], np.ones(len(new))], axis=1)
        step = max(1, ONE_THREAD // rows.size)
        for start in range(0, len(points), step):
            part = slice(start, start + step)
            away = (rows @ columns[:, part]).min(axis=0)
            np.minimum(squares[part], away, out=squares[part])
        squares[squares < SAME] = 0.0
        squares[new] = 0.0
        size = min(count - len(chosen), max(1, len(chosen) // BATCH))
        new = _drawn(weights * squares, draws[len(chosen) :][:size])
        chosen = np.concatenate([chosen, new])
    return few[chosen]


def _drawn(mass: Array, draws: Array) -> Labels:
    """Draw one point from each of equal shares of the mass, so that they spread."""
    cumulative = np.cumsum(mass)
    if not len(mass) or cumulative[-1] <= 0.0:
        return np.zeros(0, dtype=np.intp)
    targets = (np.arange(len(draws)) + draws) / len(draws) * cumulative[-1]
    drawn = np.unique(np.searchsorted(cumulative, targets, "right"))
    return drawn[drawn < len(mass)]  # rounding may end beyond the last
