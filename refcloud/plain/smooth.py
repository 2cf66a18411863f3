"""Smooth noise, remap, and what document D makes of them, one place at a time.

Each function is the twin of the one of the same name in `refcloud.noise`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from refcloud.plain.gradient import gradient
from refcloud.plain.noise import PERIOD, Point, octave_frame, uniform
from refcloud.plain.worley import steps, worley


def one_octave(place: Point, seed: int, period: int | None) -> float:
    """Join the random numbers of the corners around: each by its share of the cell."""
    place = [math.fmod(c, period or PERIOD) for c in place]
    home = [math.floor(c) for c in place]
    total = 0.0
    for step in steps(len(place), 0, 1):
        share = 1.0
        for c, h, s in zip(place, home, step, strict=True):
            share *= c - h if s else 1.0 - (c - h)
        corner = [(h + s) % (period or PERIOD) for h, s in zip(home, step, strict=True)]
        total += share * uniform(*corner, seed=seed)
    return total


def octave_place(
    point: Point, octave: int, period: int | None, shift: Sequence[float]
) -> list[float]:
    """Give a point in cells of an octave."""
    return [
        math.fmod(c, period or PERIOD) * 2**octave + s
        for c, s in zip(point, shift, strict=False)
    ]


def smooth(
    point: Point,
    *,
    seed: int = 0,
    period: int | None = None,
    octaves: int = 1,
    normalize: str = "bound",
    origins: str = "own",
) -> float:
    """Give smooth noise, or a sum of its octaves, at one point."""
    if not all(math.isfinite(c) for c in point):
        return math.nan
    total = 0.0
    for i in range(octaves):
        own, shift = octave_frame(i, seed=seed)
        if origins == "shared" or own is None:
            own, shift = seed, (0.0, 0.0, 0.0)
        place = octave_place(point, i, period, shift)
        total += one_octave(place, own, period and period << i) * 0.5**i
    if normalize == "source":
        return 128.0 * total
    if normalize == "none":
        return total
    return min(total / sum(0.5**i for i in range(octaves)), 1.0)


def smooth_grid(
    x: Sequence[float], y: Sequence[float], z: Sequence[float] | None = None, **how
) -> list:
    """Give `smooth` at each place of a grid, as [z][y][x] or [y][x]."""
    if z is None:
        return [[smooth((a, b), **how) for a in x] for b in y]
    return [[[smooth((a, b, c), **how) for a in x] for b in y] for c in z]


def remap(
    value: float, l0: float, h0: float, ln: float, hn: float, *, empty: str = "refuse"
) -> float:
    """Carry a number from the range l0..h0 to the range ln..hn."""
    if l0 == h0 and empty == "step":
        return ln if value < l0 else hn
    return ln + (value - l0) * (hn - ln) / (h0 - l0)


def worley_smooth(
    point: Point,
    *,
    seed: int = 0,
    period: int | None = None,
    octaves: int = 3,
    detail: str = "smooth",
) -> float:
    """Give Worley noise as a scaffold, filled with a finer noise, at one point."""
    if not all(math.isfinite(c) for c in point):
        return math.nan
    w = 1.0 - worley(point, seed=seed, period=period, normalize="clip")
    place = [math.fmod(c, period or PERIOD) * 2 for c in point]
    finer = period and 2 * period
    if detail == "smooth":
        s = smooth(place, seed=seed, period=finer, octaves=octaves)
    else:
        s = 0.0
        for i in range(octaves):
            own, shift = octave_frame(i, seed=seed)
            moved = [c * 2**i + o for c, o in zip(place, shift, strict=False)]
            g = gradient(moved, seed=own or 0, period=finer and finer << i)
            s += g * 0.5**i
        s = 0.5 + 0.5 * s / sum(0.5**i for i in range(octaves))
    return min(max(remap(w, s - 1.0, 1.0, 0.0, 1.0), 0.0), 1.0)


def worley_smooth_grid(
    x: Sequence[float], y: Sequence[float], z: Sequence[float] | None = None, **how
) -> list:
    """Give `worley_smooth` at each place of a grid, as [z][y][x] or [y][x]."""
    if z is None:
        return [[worley_smooth((a, b), **how) for a in x] for b in y]
    return [[[worley_smooth((a, b, c), **how) for a in x] for b in y] for c in z]


def worley_smooth_texture(
    size: int,
    *,
    cells: int = 4,
    seed: int = 0,
    octaves: int = 3,
    threshold: float = 0.65,
    detail: str = "smooth",
) -> list:
    """Give the texture's densities, as [z][y][x]."""
    line = [(i + 0.5) * cells / size for i in range(size)]
    how = {"seed": seed, "period": cells, "octaves": octaves, "detail": detail}
    noise = worley_smooth_grid(line, line, line, **how)
    return [
        [[max(remap(v, threshold, 1.0, 0.0, 1.0), 0.0) for v in row] for row in layer]
        for layer in noise
    ]
