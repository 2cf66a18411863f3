"""Eroded footprints, one place at a time.

Each function is the twin of the one of the same name in `refcloud.lighting`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from refcloud.plain.camera import Point
from refcloud.plain.cloudmap import Grid, clamped_trilinear
from refcloud.plain.noise import octave_sum_grid


class Detail(NamedTuple):
    """A table of noise over a box of the world."""

    values: Grid
    lower: Point
    upper: Point


def eroded(weight: float, noise: float, *, erosion: float, soft: float) -> float:
    """Cut a footprint back where the noise is low."""
    low = erosion * (1.0 - noise)
    return (1.0 + soft) * max(weight - low, 0.0) / (1.0 + soft - low)


def lit_share(noise: float, ahead: float, *, relief: float) -> float:
    """Give the share of a sun's light that rising noise lets through."""
    return 1.0 - relief * (1.0 + ahead - noise) / 2.0


def detail_grid(
    lower: Point,
    upper: Point,
    *,
    cell: float,
    pixel: float,
    seed: int,
    octaves: int,
    persistence: float,
    nearly_all: float,
    samples: float,
    most_cells: float,
) -> Detail:
    """Tabulate the noise of footprints, on whole multiples of the spacing."""
    spacing = cell / 2 ** (octaves - 1) / samples
    while spacing < pixel:
        spacing *= 2.0
    edges = [b - a for a, b in zip(lower, upper, strict=True)]
    while math.prod(math.ceil(e / spacing) + 3.0 for e in edges) > most_cells:
        spacing *= 2.0
    ends = [
        (math.floor(a / spacing - 0.5), math.floor(b / spacing + 0.5) + 1)
        for a, b in zip(lower, upper, strict=True)
    ]
    x, y, z = ([(i + 0.5) * spacing / cell for i in range(*end)] for end in ends)
    how = {"persistence": persistence, "normalize": "none", "seed": seed}
    noise = octave_sum_grid(x, y, z, octaves=octaves, finest=spacing / cell, **how)
    values = [
        [[min(n / nearly_all, 1.0) for n in row] for row in layer] for layer in noise
    ]
    first, last = ([end[side] * spacing for end in ends] for side in (0, 1))
    return Detail(values, (first[0], first[1], first[2]), (last[0], last[1], last[2]))


def noise_at(detail: Detail, place: Point) -> float:
    """Sample the table of noise at one place of the world."""
    values, lower, upper = detail
    counts = len(values[0][0]), len(values[0]), len(values)
    at = [
        (p - a) / (b - a) * n - 0.5
        for p, a, b, n in zip(place, lower, upper, counts, strict=True)
    ]
    return clamped_trilinear(values, at)
