"""Document S's noise as shapes and textures: one texel, one place, one vertex.

Each function is the twin of the one of the same name in `refcloud.sky`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from refcloud.plain.camera import Point, dot, unit
from refcloud.plain.fbm import fbm
from refcloud.plain.noise import hashed, octave_bound, uniform
from refcloud.plain.simplex import simplex_derivative


def shown(size: int, cells: int, octaves: int) -> int:
    """Count the octaves with at least one texel per cell."""
    return sum(2.0**-i >= cells / size for i in range(octaves))


def fractal_texture(
    size: int, *, cells: int, time: float | None, octaves: int, **how
) -> list[list[float]]:
    """Draw fractal noise to a square texture that repeats."""
    line = [cells * (i + 0.5) / size for i in range(size)]
    how |= {"time": time, "octaves": octaves, "shown": shown(size, cells, octaves)}
    return [[fbm([u, v], period=cells, **how) for u in line] for v in line]


def fractal_volume(
    size: int, *, cells: int, time: float | None, octaves: int, **how
) -> list[list[list[float]]]:
    """Draw fractal noise to a texture in space."""
    line = [cells * (i + 0.5) / size for i in range(size)]
    how |= {"time": time, "octaves": octaves, "shown": shown(size, cells, octaves)}
    return [[[fbm([x, y, z], **how) for x in line] for y in line] for z in line]


class Puff(NamedTuple):
    """A puff, fields as `refcloud.sky.Puff`."""

    radius: float
    cell: float
    distortion: float
    softness: float
    combine: str
    octaves: int
    seed: int
    period: int


def puff_density(x: float, y: float, puff: Puff, time: float) -> float:
    """Give how dense a puff is at a place of its plane."""
    inside = 1.0 - math.hypot(x, y) / puff.radius
    noise = fbm(
        [x / puff.cell, y / puff.cell],
        time=time,
        seed=puff.seed,
        octaves=puff.octaves,
        period=puff.period,
    )
    if puff.combine == "multiply":
        circle = min(max(inside / puff.softness, 0.0), 1.0)
        return circle * (1.0 + noise) / 2.0
    return min(max((inside + puff.distortion * noise) / puff.softness, 0.0), 1.0)


class Displacement(NamedTuple):
    """How a sphere's vertices are moved, fields as `refcloud.sky.Displacement`."""

    amount: float
    frequency: float
    octaves: int
    persistence: float
    seed: int


def displaced_sphere(
    way: Point, displacement: Displacement, time: float
) -> tuple[Point, Point]:
    """Move one vertex along its direction, and give the normal there."""
    n, grad = 0.0, [0.0, 0.0, 0.0]
    for i in range(displacement.octaves):
        scale, weight = 2.0**i * displacement.frequency, displacement.persistence**i
        at = [*(scale * c for c in way), 2.0**i * time]
        at = [c + uniform(i, axis, seed=displacement.seed) for axis, c in enumerate(at)]
        value, slope = simplex_derivative(at, seed=hashed((i,), displacement.seed) >> 1)
        n += weight * value
        grad = [g + weight * scale * s for g, s in zip(grad, slope, strict=False)]
    share = displacement.amount / octave_bound(
        displacement.octaves, displacement.persistence
    )
    r = 1.0 + share * n
    grad = [share * g for g in grad]
    outward = dot((grad[0], grad[1], grad[2]), way)
    x, y, z = (r * d - (g - outward * d) for g, d in zip(grad, way, strict=True))
    return (r * way[0], r * way[1], r * way[2]), unit((x, y, z))
