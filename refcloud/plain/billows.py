"""Worley noise carved out of a pile of ellipsoids, one place at a time.

Each function is the twin of the one of the same name in `refcloud.cloudmap`.
"""

from __future__ import annotations

from collections.abc import Sequence

from refcloud.plain.noise import octave_frame
from refcloud.plain.smooth import remap
from refcloud.plain.worley import worley

OCTAVES, PERSISTENCE = 3, 0.4
LOWEST, HIGHEST, MEAN = 0.12, 0.93, 0.48


def clamp(value: float, most: float = 1.0) -> float:
    """Cut a number at 0 and at some other."""
    return min(max(value, 0.0), most)


def lumps(point: Sequence[float], seed: int, finest: float) -> float:
    """Give the lumps at one place."""
    total = weights = 0.0
    for i in range(OCTAVES):
        own, shift = octave_frame(i, seed=seed)
        place = [2.0**i * p + s for p, s in zip(point, shift, strict=True)]
        height = 1.0 - worley(place, seed=own or 0, normalize="clip")
        total += PERSISTENCE**i * (height if 2.0**-i >= finest else MEAN)
        weights += PERSISTENCE**i
    return clamp(remap(total / weights, LOWEST, HIGHEST, 0.0, 1.0))


def lumps_grid(
    x: Sequence[float],
    y: Sequence[float],
    z: Sequence[float],
    seed: int = 0,
    finest: float = 0.0,
) -> list:
    """Give the lumps at each place of a grid, as [z][y][x]."""
    return [[[lumps((a, b, c), seed, finest) for a in x] for b in y] for c in z]


def carve(
    depth: float,
    lumps: float,
    detail: float,
    y: float,
    *,
    rise: float,
    cover: float,
    erosion: float,
    base: float,
    foot: float,
    gain: float,
) -> float:
    """Shape the density at one place."""
    coverage = clamp(depth / rise + cover, 1.25)
    if 1.0 - lumps >= coverage:
        return 0.0
    # remap(lumps, 1 - coverage, 1, 0, 1), which stays exact where coverage is small.
    b = 1.0 - (1.0 - lumps) / coverage
    u = clamp(y / base)
    bite = erosion * ((1.0 - detail) * u + detail * (1.0 - u))
    left = clamp(remap(b, bite, 1.0, 0.0, 1.0))
    return min(gain * left * clamp(y / foot), 1.0)
