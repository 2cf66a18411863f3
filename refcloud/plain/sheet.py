"""Document C's cloud sheet, loop by loop as it is printed.

Each function is the twin of the one of the same name in `refcloud.noise`. Maps are
lists of rows, ``values[y][x]``; the document stores its small map column by column.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from refcloud.plain.noise import elias2d, lattice_random

Rows = Sequence[Sequence[float]]


def wrap_halo(values: Rows) -> list[list[float]]:
    """Give a map with one more sample on each side, from the side opposite."""
    height, width = len(values), len(values[0])
    temp = [[0.0] * (width + 2) for _ in range(height + 2)]
    for y in range(1, height + 1):
        for x in range(1, width + 1):
            temp[y][x] = values[y - 1][x - 1]
    for x in range(1, width + 1):
        temp[0][x] = temp[height][x]
        temp[height + 1][x] = temp[1][x]
    for y in range(1, height + 1):
        temp[y][0] = temp[y][width]
        temp[y][width + 1] = temp[y][1]
    temp[0][0] = temp[height][width]
    temp[height + 1][width + 1] = temp[1][1]
    temp[height + 1][0] = temp[1][width]
    temp[0][width + 1] = temp[height][1]
    return temp


def sheet_map(
    size: int = 32, *, seed: int = 0, numbers: str = "elias"
) -> list[list[float]]:
    """Give document C's small map (SetNoise)."""

    def noise(x: int, y: int) -> float:
        if numbers == "elias":
            return elias2d(x, y, seed=seed)
        return lattice_random(x, y, 0, seed=seed)

    sides = range(1, size + 1)
    temp = wrap_halo([[128.0 + noise(x, y) * 128.0 for x in sides] for y in sides])
    out = []
    for y in sides:
        row = []
        for x in sides:
            centre = temp[y][x] / 4.0
            beside = temp[y][x + 1] + temp[y][x - 1] + temp[y + 1][x] + temp[y - 1][x]
            corners = temp[y + 1][x + 1] + temp[y - 1][x + 1]
            corners += temp[y + 1][x - 1] + temp[y - 1][x - 1]
            row.append(centre + beside / 8.0 + corners / 16.0)
        out.append(row)
    return out


def wrapped_bilinear(values: Rows, x: float, y: float) -> float:
    """Interpolate in a map that repeats (Interpolate)."""
    height, width = len(values), len(values[0])
    x, y = math.fmod(x, width), math.fmod(y, height)
    x_int, y_int = math.floor(x), math.floor(y)
    x_frac, y_frac = x - x_int, y - y_int
    x0, x1 = x_int % width, (x_int + 1) % width
    y0, y1 = y_int % height, (y_int + 1) % height
    bot = values[y0][x0] + x_frac * (values[y0][x1] - values[y0][x0])
    top = values[y1][x0] + x_frac * (values[y1][x1] - values[y1][x0])
    return bot + y_frac * (top - bot)


def overlap_octaves(
    values: Rows, size: int = 256, *, octaves: int = 4
) -> list[list[float]]:
    """Sum octaves of a map that repeats (OverlapOctaves)."""
    height, width = len(values), len(values[0])
    out = [[0.0] * size for _ in range(size)]
    for octave in range(octaves):
        for x in range(size):
            for y in range(size):
                scale = 2**octave / size
                noise = wrapped_bilinear(values, x * scale * width, y * scale * height)
                out[y][x] += noise / 2**octave
    return out


def exponential_filter(
    value: float, *, cover: float = 20.0, sharpness: float = 0.95
) -> float:
    """Turn one sum of octaves into cloud (ExpFilter)."""
    c = max(value - (255.0 - cover), 0.0)
    return 255.0 - sharpness**c * 255.0


def cloud_sheet(
    size: int = 256,
    *,
    seed: int = 0,
    map_size: int = 32,
    octaves: int = 4,
    cover: float = 20.0,
    sharpness: float = 0.95,
    numbers: str = "elias",
) -> list[list[float]]:
    """Give document C's cloud."""
    small = sheet_map(map_size, seed=seed, numbers=numbers)
    total = overlap_octaves(small, size, octaves=octaves)
    how = {"cover": cover, "sharpness": sharpness}
    return [[exponential_filter(v, **how) for v in row] for row in total]
