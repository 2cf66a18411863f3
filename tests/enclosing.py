"""Branch and bound: enclose the largest value of a function over boxes."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np


def exceeds(
    bound: float,
    upper: Callable[[np.ndarray, float], np.ndarray],
    lows: np.ndarray,
    side: float,
    rounds: int = 12,
) -> bool:
    """Tell whether a function could exceed the bound on boxes of a side.

    `upper(middles, side)` bounds the function on boxes; those that stay below the bound
    are done with, the others are halved along every axis.
    """
    middles = lows + side / 2
    dimensions = lows.shape[1]
    corners = np.array(list(itertools.product((-0.25, 0.25), repeat=dimensions)))
    for _ in range(rounds):
        middles = middles[upper(middles, side) > bound]
        if not len(middles):
            return False
        middles = (middles[:, None] + corners * side).reshape(-1, dimensions)
        side /= 2
    return True


def boxes(low: np.ndarray, high: np.ndarray, side: float) -> np.ndarray:
    """Cover the space between two places by boxes: their lowest corners."""
    lines = [np.arange(a, b, side) for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, len(low))
