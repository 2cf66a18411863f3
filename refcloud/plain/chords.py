"""Columns through balls along one ray, in closed form.

The twin of the function of the same name in `refcloud.march`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from refcloud.plain.camera import Point, along, between, dot, unit


def ball_columns(
    balls: Sequence[tuple[Point, float, float]], origin: Point, direction: Point
) -> float:
    """Integrate the density of Wyvill balls (centre, radius, density) along one ray.

    The kernel on the chord is p^2 (5 + 4 p) / 9, p = 1 - b^2 / R^2 - u^2.
    """
    direction = unit(direction)
    total = 0.0
    for center, R, density in balls:
        offset = between(center, origin)
        u = dot(offset, direction)
        foot = along(offset, (-u, direction))
        p = 1.0 - dot(foot, foot) / R**2
        if p <= 0.0:
            continue
        s = math.sqrt(p)
        ends = []
        for x in (min(max(u / R, -s), s), s):
            fifth = p**2 * x - 2.0 / 3.0 * p * x**3 + x**5 / 5.0
            seventh = p**3 * x - p**2 * x**3 + 3.0 / 5.0 * p * x**5 - x**7 / 7.0
            ends.append((5.0 * fifth + 4.0 * seventh) / 9.0)
        total += density * R * (ends[1] - ends[0])
    return total
