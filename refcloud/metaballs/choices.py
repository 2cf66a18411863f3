"""Every random choice of the clustering: where centres start, and who is visited."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.noise.hashing import uniform

Labels = NDArray[np.integer]

# First word of each hash, so that no two choices share their numbers.
START, VISIT, SPREAD = 1, 2, 3
# k-means++ draws a batch of new centres at once: this share of those it has.
BATCH = 8
# Distances worked out at a time: few enough for a matrix product on one thread, since
# threads that wait for one another cost more than they save.
BLOCK = 1 << 16
# Squared distances below this share of the cloud's are rounding of equal points.
SAME = 1e-13


def start_patterns(total: int, count: int, seed: int) -> Labels:
    """Choose patterns at random, none of them twice (E18)."""
    keys = uniform(START, np.arange(total), seed=seed)
    return np.argsort(keys, kind="stable")[:count]


def visits(total: int, epoch: int, seed: int, order: str) -> Labels:
    """Give the order in which an epoch visits the patterns."""
    if order == "raster":
        return np.arange(total)
    keys = uniform(VISIT, epoch, np.arange(total), seed=seed)
    return np.argsort(keys, kind="stable")


def spread_start(points: Array, weights: Array, count: int, seed: int) -> Labels:
    """Draw starting points by weight times squared distance to those drawn before."""
    chosen = _drawn(weights, 0, 1, seed)
    own = np.einsum("ij,ij->i", points, points)
    squares = np.full(len(points), np.inf)
    new = chosen
    while len(new) and len(chosen) < count:
        # Keep the distance to the nearest of all that are drawn.
        rows = max(1, BLOCK // len(new))
        for start in range(0, len(points), rows):
            part = slice(start, start + rows)
            away = own[part, None] - 2.0 * points[part] @ points[new].T + own[new]
            np.minimum(squares[part], away.min(axis=1), out=squares[part])
        squares[squares < SAME] = 0.0
        squares[new] = 0.0
        size = min(count - len(chosen), max(1, len(chosen) // BATCH))
        new = _drawn(weights * squares, len(chosen), size, seed)
        chosen = np.concatenate([chosen, new])
    return chosen


def _drawn(mass: Array, word: int, size: int, seed: int) -> Labels:
    """Draw one point from each of equal shares of the mass, so that they spread."""
    cumulative = np.cumsum(mass)
    if not len(mass) or cumulative[-1] <= 0.0:
        return np.zeros(0, dtype=np.intp)
    draws = uniform(SPREAD, word, np.arange(size), seed=seed)
    targets = (np.arange(size) + draws) / size * cumulative[-1]
    drawn = np.unique(np.searchsorted(cumulative, targets, "right"))
    return drawn[drawn < len(mass)]  # rounding may end beyond the last
