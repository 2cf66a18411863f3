"""Fractal sums at one point, of value, gradient and simplex noise.

Each function is the twin of the one of the same name in `refcloud.noise`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from refcloud.plain.gradient import gradient
from refcloud.plain.noise import hashed, octave_bound, uniform, value
from refcloud.plain.simplex import WRAP, simplex

PERIOD = 2**32


def one(kind: str, place: Sequence[float], seed: int, period: int | None) -> float:
    """Give one octave of a kind of noise."""
    if kind == "value":
        return value(place, seed=seed, interpolant="quintic", period=period)
    if kind == "gradient":
        return gradient(place, seed=seed, period=period)
    return simplex(place, seed=seed)


def summed(
    point: Sequence[float],
    absolute: bool,
    *,
    kind: str = "gradient",
    time: float | None = None,
    seed: int = 0,
    octaves: int = 4,
    persistence: float = 0.5,
    normalize: str = "bound",
    period: int | None = None,
    shown: int | None = None,
) -> float:
    """Sum octaves at one point, each with or without its absolute value."""
    point = [*point] if time is None else [*point, time]
    if not all(math.isfinite(c) for c in point):
        return math.nan
    total = 0.0
    for i in range(octaves if shown is None else shown):
        repeat = period * 2**i if period else None
        wrap = repeat or (WRAP if kind == "simplex" else PERIOD)
        place = []
        for axis, c in enumerate(point):
            scaled = math.fmod(math.fmod(c, wrap) * 2**i, wrap)
            place.append(math.fmod(scaled + uniform(i, axis, seed=seed), wrap))
        n = one(kind, place, hashed((i,), seed) >> 1, repeat)
        total += persistence**i * (abs(n) if absolute else n)
    if normalize == "bound":
        return total / octave_bound(octaves, persistence)
    return min(max(total, -1.0), 1.0) if normalize == "clip" else total


def fbm(point: Sequence[float], **how) -> float:
    """Give fractional Brownian motion at one point."""
    return summed(point, False, **how)


def turbulence(point: Sequence[float], **how) -> float:
    """Give turbulence at one point: absolute values summed."""
    return summed(point, True, **how)


def grid(one_point, x, y, z, finest: float | None, octaves: int, how: dict) -> list:
    """Give a sum at each place of a grid, of octaves with a sample per cell or more."""
    shown = sum(finest is None or 2.0**-i >= finest for i in range(octaves))
    how |= {"octaves": octaves, "shown": shown}
    if z is None:
        return [[one_point((a, b), **how) for a in x] for b in y]
    return [[[one_point((a, b, c), **how) for a in x] for b in y] for c in z]


def fbm_grid(x, y, z=None, *, octaves: int = 4, finest=None, **how) -> list:
    """Give `fbm` at each place of a grid, as [z][y][x] or [y][x]."""
    return grid(fbm, x, y, z, finest, octaves, how)


def turbulence_grid(x, y, z=None, *, octaves: int = 4, finest=None, **how) -> list:
    """Give `turbulence` at each place of a grid, as [z][y][x] or [y][x]."""
    return grid(turbulence, x, y, z, finest, octaves, how)
