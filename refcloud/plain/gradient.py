"""Gradient noise at one point: 32 hashed bits choose each corner's gradient.

Each function is the twin of the one of the same name in `refcloud.noise`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from refcloud.plain.noise import hashed, uniform

Point = Sequence[float]
DOMAIN = 0x6C617474
LOW = 2**32 - 1
HALF = math.sqrt(0.5)


def product(values: Sequence, count: int) -> list[tuple]:
    """List all tuples of so many of the values, in order."""
    rows: list[tuple] = [()]
    for _ in range(count):
        rows = [(*row, value) for row in rows for value in values]
    return rows


def axis_bits(cell: int, axis: int, seed: int) -> int:
    """Mix one lattice coordinate under the two keys of its axis."""
    keys = hashed((DOMAIN, axis), seed)
    bits = cell % 2**32 ^ keys >> 32
    bits = (bits ^ bits >> 16) * 0x21F0AAAD & LOW
    bits = (bits ^ bits >> 15) + (keys & LOW) & LOW
    bits = bits * 0xD35A2D97 & LOW
    return bits ^ bits >> 15


def lattice_bits(*cells: int, seed: int = 0, hash: str = "mixed") -> int:
    """Give the 32 random bits of a lattice point."""
    if hash == "table":
        table = permutation_table(seed)
        entry = 0
        for cell in reversed(cells):
            entry = table[(cell + entry) % 256]
        return entry << 24
    bits = sum(axis_bits(cell, k, seed) for k, cell in enumerate(cells)) & LOW
    bits = (bits ^ bits >> 16) * 0x21F0AAAD & LOW
    return (bits ^ bits >> 15) * 0xD35A2D97 & LOW


def permutation_table(seed: int = 0) -> list[int]:
    """Give 0 to 255 in an order shuffled by a seed."""
    table = list(range(256))
    for i in range(255, 0, -1):
        j = int(uniform(DOMAIN, i, seed=seed) * (i + 1))
        table[i], table[j] = table[j], table[i]
    return table


def gradient_set(name: str | None = None, *, dimensions: int = 3) -> list[tuple]:
    """Give the gradients that a lattice point's bits choose from."""
    name = name or {2: "directions8", 3: "edges12", 4: "edges32"}[dimensions]
    if name == "directions8":
        axes = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)]
        turned = [(HALF, HALF), (-HALF, HALF), (-HALF, -HALF), (HALF, -HALF)]
        return axes + turned
    zeros = 1 if name.startswith("edges") else 0
    every = product((-1.0, 0.0, 1.0), dimensions)
    return [vector for vector in every if vector.count(0.0) == zeros]


def chosen(bits: int, rows: Sequence[tuple]) -> tuple:
    """Choose a gradient by the upper 16 bits."""
    return rows[(bits >> 16) * len(rows) >> 16]


def peak(name: str, fade: str) -> float:
    """Give the bound that gradient noise is divided by."""
    if name == "edges12":
        return 1.047 if fade == "quintic" else 1.0555
    if name == "edges32":
        return 1.565 if fade == "quintic" else 1.575
    return {"directions8": HALF, "diagonals4": 1.0, "corners8": 1.5}[name]


def faded(t: float, fade: str) -> tuple[float, float]:
    """Give the fade from 0 to 1 at t, and its slope there."""
    if fade == "hermite":
        return 3.0 * t**2 - 2.0 * t**3, 6.0 * t - 6.0 * t**2
    slope = 30.0 * t**4 - 60.0 * t**3 + 30.0 * t**2
    return 6.0 * t**5 - 15.0 * t**4 + 10.0 * t**3, slope


def gradient_derivative(
    point: Point,
    *,
    seed: int = 0,
    fade: str = "quintic",
    gradients: str | None = None,
    period: int | None = None,
    hash: str = "mixed",
) -> tuple[float, list[float]]:
    """Give gradient noise and its derivative at one point, corner by corner."""
    n = len(point)
    if not all(math.isfinite(c) for c in point):
        return math.nan, [math.nan] * n
    name = gradients or {2: "directions8", 3: "edges12", 4: "edges32"}[n]
    rows = gradient_set(name, dimensions=n)
    reduced = [math.fmod(c, period or 2**32) for c in point]
    cells = [math.floor(c) for c in reduced]
    noise, slope = 0.0, [0.0] * n
    for corner in product((0, 1), n):
        ends = [c + end for c, end in zip(cells, corner, strict=True)]
        lattice = [c % period for c in ends] if period else ends
        g = chosen(lattice_bits(*lattice, seed=seed, hash=hash), rows)
        away = [c - end for c, end in zip(reduced, ends, strict=True)]
        dot = sum(a * b for a, b in zip(g, away, strict=True))
        # Each axis weighs the corner by 1 - w of its distance.
        w, dw = zip(*(faded(abs(d), fade) for d in away), strict=True)
        weight = math.prod(1.0 - one for one in w)
        noise += weight * dot
        for k, d in enumerate(away):
            others = math.prod(1.0 - one for j, one in enumerate(w) if j != k)
            slope[k] += weight * g[k] - others * math.copysign(dw[k], d) * dot
    scale = 1.0 / peak(name, fade)
    return scale * noise, [scale * s for s in slope]


def gradient(point: Point, **how) -> float:
    """Give gradient noise at one point."""
    return gradient_derivative(point, **how)[0]


def gradient_grid(
    x: Sequence[float], y: Sequence[float], z: Sequence[float] | None = None, **how
) -> list:
    """Give `gradient` at each place of a grid, as [z][y][x] or [y][x]."""
    if z is None:
        return [[gradient((a, b), **how) for a in x] for b in y]
    return [[[gradient((a, b, c), **how) for a in x] for b in y] for c in z]
