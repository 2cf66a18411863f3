"""Balls that float alone: beads beside the cloud."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.conventions import Array, Positive, Range, Skipped
from refcloud.metaballs.balls import Metaballs

BLOCK = 1 << 20  # distances at a time: 8 MB of float64


@checked
def prune(
    balls: Metaballs,
    *,
    neighbour: Annotated[int, Range(1)] = 5,
    reach: Annotated[float, Positive] = 1.9,
) -> Metaballs:
    """Drop the balls that have too few others near.

    Formula: kept where |c - c_5| <= 1.9 R, c_5 the centre of the fifth neighbour

    Parameters
    ----------
    balls
        The cloud.
    neighbour
        Which neighbour has to be near. With no more balls than this, all are kept.
    reach
        How near: distance over the ball's own radius.

    Returns
    -------
    The balls kept, in their order, with a row of ``skipped`` where any are dropped.

    Source: an extension of paper M, section 3.

    Examples
    --------
    >>> beads = Metaballs([[0, 0, 0], [1, 0, 0], [9, 0, 0]], [1, 1, 1], [1, 1, 1])
    >>> prune(beads, neighbour=1).centers[:, 0]
    array([0., 1.])
    """
    total = len(balls)
    if total <= neighbour:
        return balls
    near = neighbour_distance(balls.centers, neighbour)
    kept = near <= reach * balls.radii
    dropped = total - int(kept.sum())
    if not dropped:
        return balls
    bound = _overlapping(balls, ~kept)
    row = Skipped("prune", "balls that float alone", dropped, total, bound, "density")
    return replace(
        balls,
        centers=balls.centers[kept],
        radii=balls.radii[kept],
        densities=balls.densities[kept],
        skipped=(*balls.skipped, row),
    )


def _overlapping(balls: Metaballs, chosen: NDArray[np.bool_]) -> float:
    """Bound the density that chosen balls have together at any point.

    All balls that cover a point overlap each other, so that none of them overlaps less.
    """
    c, R, density = balls.centers[chosen], balls.radii[chosen], balls.densities[chosen]
    most = 0.0
    for center, radius in zip(c, R, strict=True):
        near = np.sqrt(np.square(c - center).sum(axis=1)) <= R + radius
        most = max(most, float(density[near].sum()))
    return most


def neighbour_distance(centers: Array, neighbour: int) -> Array:
    """Give each centre's distance to its n-th nearest other centre, shape (N,)."""
    scale = float(np.abs(centers - centers[0]).max()) or 1.0
    places = (centers - centers[0]) / scale  # squares cannot overflow
    rows = max(1, BLOCK // len(places))
    near = []
    for start in range(0, len(places), rows):
        part = places[start : start + rows]
        squares = sum((part[:, axis, None] - places[:, axis]) ** 2 for axis in range(3))
        # The ball itself is the nearest, at distance 0.
        near.append(np.partition(squares, neighbour, axis=1)[:, neighbour])
    return np.sqrt(np.concatenate(near)) * scale
