"""Noise one number at a time, in whole numbers of Python: hashes to sums of octaves.

Each function is the twin of the one of the same name in `refcloud.noise`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

Point = Sequence[float]  # x, y, z

PERIOD = 2**32  # lattice coordinates wrap here
WORD = 2**64
WEYL = 0x9E3779B97F4A7C15


def elias(m: int, shift: str = "plain", divisor: int = 2**30) -> float:
    """Hash 32 bits to a number: what eq 2 and document C share."""
    m %= PERIOD
    moved = m << 13
    if shift == "rotate":
        moved |= m >> 19
    n = (moved ^ m) % PERIOD
    return 1.0 - ((n * (n * n * 15731 + 789221) + 1376312589) & 0x7FFFFFFF) / divisor


def man2003(
    x: int, y: int, z: int, *, shift: str = "plain", divisor: int = 2**30
) -> float:
    """Give the paper's random number of a lattice point (eq 2)."""
    return elias(x + 57 * y + 57**2 * z, shift, divisor)


def elias2d(x: int, y: int, *, seed: int = 0) -> float:
    """Give the random number of a lattice point in the plane (document C)."""
    return elias(x + 57 * y + 131 * seed)


def mixed(h: int) -> int:
    """Mix 64 bits, one to one: the finaliser of SplitMix64."""
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9 % WORD
    h = (h ^ (h >> 27)) * 0x94D049BB133111EB % WORD
    return h ^ (h >> 31)


def hashed(words: Sequence[int], seed: int) -> int:
    """Hash whole numbers and a seed to 64 bits."""
    state = mixed((seed + WEYL) % WORD)
    for word in words:
        state = mixed((state + WEYL) % WORD ^ word % WORD)
    return state


def lattice_random(x: int, y: int, z: int, *, seed: int | None = 0) -> float:
    """Give the random number of a lattice point, in (-1, 1]."""
    if seed is None:
        return man2003(x, y, z)
    return 1.0 - (hashed((x % PERIOD, y % PERIOD, z % PERIOD), seed) >> 33) / 2**30


def uniform(*words: int, seed: int) -> float:
    """Give a random number in [0, 1)."""
    return (hashed(words, seed) >> 11) / 2**53


def smoothed(
    x: int, y: int, z: int, *, seed: int | None = 0, period: int = PERIOD
) -> float:
    """Give the weighted mean of a lattice point's 27 neighbours (eq 3)."""
    sums = [0.0, 0.0, 0.0, 0.0]  # centre, sides, dgSides, corners
    for dx in (-1, 0, 1):
        for dy in (-1, 0, 1):
            for dz in (-1, 0, 1):
                off_axes = abs(dx) + abs(dy) + abs(dz)
                near = ((x + dx) % period, (y + dy) % period, (z + dz) % period)
                sums[off_axes] += lattice_random(*near, seed=seed)
    centre, sides, edges, corners = sums
    return 9 / 18 * centre + 4 / 108 * sides + 3 / 216 * edges + 2 / 144 * corners


def linear(a: float, b: float, t: float) -> float:
    """Interpolate along the straight line (eq 4)."""
    return a * (1.0 - t) + b * t


def cosine(a: float, b: float, t: float) -> float:
    """Interpolate along half a wave (eq 5)."""
    F = 1.0 - math.cos(math.pi * t)
    return a * (1.0 - 0.5 * F) + 0.5 * b * F


def cubic(v0: float, v1: float, v2: float, v3: float, t: float) -> float:
    """Interpolate by the paper's cubic (eq 6)."""
    P = (v3 - v2) - (v0 - v1)
    Q = v0 - v1 - P
    R = v2 - v0
    return P * t**3 + Q * t**2 + R * t + v1


def hermite(a: float, b: float, t: float) -> float:
    """Interpolate along the cubic that is flat at both ends."""
    return linear(a, b, min(3.0 * t**2 - 2.0 * t**3, 1.0))


def quintic(a: float, b: float, t: float) -> float:
    """Interpolate along the quintic that is flat and straight at both ends."""
    return linear(a, b, min(6.0 * t**5 - 15.0 * t**4 + 10.0 * t**3, 1.0))


def catmull_rom(v0: float, v1: float, v2: float, v3: float, t: float) -> float:
    """Interpolate by the cubic of chord slopes."""
    second = 2.0 * v0 - 5.0 * v1 + 4.0 * v2 - v3
    third = 3.0 * (v1 - v2) + v3 - v0
    return v1 + 0.5 * ((v2 - v0) * t + second * t**2 + third * t**3)


TWO_POINT = {
    "linear": linear,
    "cosine": cosine,
    "hermite": hermite,
    "quintic": quintic,
}
FOUR_POINT = {"cubic": cubic, "catmull_rom": catmull_rom}


def interpolated(interpolant: str, values: Sequence[float], t: float) -> float:
    """Apply an interpolant to its two or four neighbours."""
    if interpolant in TWO_POINT:
        a, b = values
        return TWO_POINT[interpolant](a, b, t)
    v0, v1, v2, v3 = values
    return FOUR_POINT[interpolant](v0, v1, v2, v3, t)


def reach(interpolant: str) -> range:
    """Give the neighbours that an interpolant reads, from the cell's lower end."""
    return range(2) if interpolant in TWO_POINT else range(-1, 3)


def taps(interpolant: str, t: float) -> tuple[list[float], list[int]]:
    """Give an interpolant as weights: its value where one neighbour is 1."""
    offsets = list(reach(interpolant))
    weights = [
        interpolated(interpolant, [float(o == one) for o in offsets], t)
        for one in offsets
    ]
    return weights, offsets


def value(
    point: Point,
    *,
    seed: int | None = 0,
    interpolant: str = "cosine",
    smooth: bool = True,
    period: int | None = None,
) -> float:
    """Give value noise at one point (eq 7): along x, then y, then z."""
    if not all(math.isfinite(c) for c in point):
        return math.nan
    wrap = period or PERIOD
    place = [math.fmod(c, wrap) for c in point]
    x, y, z = (math.floor(c) for c in place)
    tx, ty, tz = (c - math.floor(c) for c in place)

    def f(*cell: int) -> float:
        if smooth:
            return smoothed(*cell, seed=seed, period=wrap)
        return lattice_random(*(c % wrap for c in cell), seed=seed)

    near = reach(interpolant)
    layers = []
    for k in near:
        rows = []
        for j in near:
            row = [f(x + i, y + j, z + k) for i in near]
            rows.append(interpolated(interpolant, row, tx))
        layers.append(interpolated(interpolant, rows, ty))
    return interpolated(interpolant, layers, tz)


def value_grid(
    x: Sequence[float], y: Sequence[float], z: Sequence[float], **how
) -> list[list[list[float]]]:
    """Give `value` at each place of a grid, as [z][y][x]."""
    return [[[value((a, b, c), **how) for a in x] for b in y] for c in z]


def octave_bound(octaves: int, persistence: float) -> float:
    """Give the largest sum of octaves of values in [-1, 1]."""
    return sum(persistence**i for i in range(octaves))


def octave_frame(
    octave: int, *, seed: int | None = 0
) -> tuple[int | None, tuple[float, float, float]]:
    """Give the seed and the shift of the origin that an octave uses."""
    if seed is None:
        return None, (0.0, 0.0, 0.0)
    x, y, z = (uniform(octave, axis, seed=seed) for axis in range(3))
    return hashed((octave,), seed) >> 1, (x, y, z)


def octave_sum(
    point: Point,
    *,
    seed: int | None = 0,
    octaves: int = 4,
    persistence: float = 0.5,
    interpolant: str = "cosine",
    normalize: str = "clip",
    absolute: bool = True,
    period: int | None = None,
    shown: int | None = None,
) -> float:
    """Give the paper's fractal noise at one point (eq 1), of the octaves shown."""
    if not all(math.isfinite(c) for c in point):
        return math.nan
    total = 0.0
    for i in range(octaves if shown is None else shown):
        own, shift = octave_frame(i, seed=seed)
        repeat = None if period is None else period << i
        wrap = repeat or PERIOD
        place = [
            math.fmod(math.fmod(c, wrap) * 2**i, wrap) + s
            for c, s in zip(point, shift, strict=True)
        ]
        octave = value(place, seed=own, interpolant=interpolant, period=repeat)
        total += persistence**i * octave
    if absolute:
        total = abs(total)
    if normalize == "clip":
        return min(max(total, -1.0), 1.0)
    if normalize == "none":
        return total
    peak = {"cubic": 1.5, "catmull_rom": 1.25}.get(interpolant, 1.0) ** 3
    return total / (octave_bound(octaves, persistence) * peak)


def octave_sum_grid(
    x: Sequence[float],
    y: Sequence[float],
    z: Sequence[float],
    *,
    octaves: int = 4,
    finest: float | None = None,
    **how,
) -> list[list[list[float]]]:
    """Give `octave_sum` on a grid, of octaves with a sample per cell or more."""
    shown = sum(finest is None or 2.0**-i >= finest for i in range(octaves))
    how |= {"octaves": octaves, "shown": shown}
    return [[[octave_sum((a, b, c), **how) for a in x] for b in y] for c in z]
