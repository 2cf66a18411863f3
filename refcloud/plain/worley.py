"""Worley noise one place at a time: every cell that can matter, and a sorted list.

Each function is the twin of the one of the same name in `refcloud.noise`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from refcloud.plain.noise import PERIOD, Point, uniform


def worley_bound(dimensions: int, feature: str) -> float:
    """Give the largest distance that Worley noise can take, in cells."""
    if feature == "F2" and dimensions == 2:
        return math.hypot(1.5, 0.5)
    return math.dist([0.0] * dimensions, [1.0] * dimensions)


def steps(dimensions: int, lowest: int, highest: int) -> list[tuple[int, ...]]:
    """List all steps whose length along each axis lies between two."""
    if dimensions == 0:
        return [()]
    along = range(lowest, highest + 1)
    return [(*s, a) for s in steps(dimensions - 1, lowest, highest) for a in along]


def worley_points(
    *cell: int, seed: int = 0, period: int | None = None
) -> tuple[float, ...]:
    """Give the random point of one cell, where it lies in it."""
    wrapped = [c % (period or PERIOD) for c in cell]
    return tuple(uniform(*wrapped, axis, seed=seed) for axis in range(len(cell)))


def worley(
    point: Point,
    *,
    seed: int = 0,
    period: int | None = None,
    feature: str = "F1",
    search: str = "exact",
    normalize: str = "none",
) -> float:
    """Give Worley noise at one point of the plane or of space."""
    if not all(math.isfinite(c) for c in point):
        return math.nan
    place = [math.fmod(c, period or PERIOD) for c in point]
    home = [math.floor(c) for c in place]
    t = [c - h for c, h in zip(place, home, strict=True)]
    reach = 2 if search == "exact" else 1
    distances = []
    for step in steps(len(t), -reach, reach):
        cell = [h + s for h, s in zip(home, step, strict=True)]
        q = worley_points(*cell, seed=seed, period=period)
        distances.append(math.dist(t, [s + c for s, c in zip(step, q, strict=True)]))
    found = sorted(distances)[0 if feature == "F1" else 1]
    if normalize == "none":
        return found
    if normalize == "clip":
        return min(found, 1.0)
    share = found / worley_bound(len(t), feature)
    return 1.0 - share if normalize == "inverted" else share


def worley_grid(
    x: Sequence[float], y: Sequence[float], z: Sequence[float] | None = None, **how
) -> list:
    """Give `worley` at each place of a grid, as [z][y][x] or [y][x]."""
    if z is None:
        return [[worley((a, b), **how) for a in x] for b in y]
    return [[[worley((a, b, c), **how) for a in x] for b in y] for c in z]


def worley_drawn(
    width: int, height: int, *, count: int = 64, seed: int = 0, inverted: bool = False
) -> list[list[float]]:
    """Give document D's first picture: 255 d / max d, or 255 less that."""
    drawn = [
        (uniform(i, 0, seed=seed) * width, uniform(i, 1, seed=seed) * height)
        for i in range(count)
    ]
    d = [
        [min(math.dist((i + 0.5, j + 0.5), q) for q in drawn) for i in range(width)]
        for j in range(height)
    ]
    farthest = max(max(row) for row in d) or 1.0
    shown = [[255.0 * v / farthest for v in row] for row in d]
    return [[255.0 - v for v in row] for row in shown] if inverted else shown
