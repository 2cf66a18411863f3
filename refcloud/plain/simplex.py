"""Simplex noise at one point: skew, order the coordinates, sum N + 1 corners.

Each function is the twin of the one of the same name in `refcloud.noise`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from refcloud.plain.gradient import chosen, gradient_set, lattice_bits

WRAP = 3 * 2**32
SQUARED = {"continuous": 0.5, "usual": 0.6}
PEAKS = {
    (2, "continuous"): 0.010131,
    (2, "usual"): 0.029026,
    (3, "continuous"): 0.013073,
    (3, "usual"): 0.030738,
    (4, "continuous"): 0.016410,
    (4, "usual"): 0.037830,
}


def corners(point: Sequence[float]) -> list[tuple[list[int], list[float]]]:
    """Give the lattice cells of a point's simplex, and the offsets from them."""
    n = len(point)
    skew = (math.sqrt(n + 1.0) - 1.0) / n
    back = (1.0 - 1.0 / math.sqrt(n + 1.0)) / n
    cells = [math.floor(c + skew * sum(point)) for c in point]
    first = [p - c + back * sum(cells) for p, c in zip(point, cells, strict=True)]
    order = sorted(range(n), key=lambda k: -first[k])
    found = []
    for corner in range(n + 1):
        step = [int(k in order[:corner]) for k in range(n)]
        lattice = [c + s for c, s in zip(cells, step, strict=True)]
        away = [d - s + corner * back for d, s in zip(first, step, strict=True)]
        found.append((lattice, away))
    return found


def simplex_derivative(
    point: Sequence[float],
    *,
    seed: int = 0,
    radius: str = "continuous",
    hash: str = "mixed",
) -> tuple[float, list[float]]:
    """Give simplex noise and its derivative at one point."""
    n = len(point)
    if not all(math.isfinite(c) for c in point):
        return math.nan, [math.nan] * n
    rows = gradient_set(dimensions=n)
    noise, slope = 0.0, [0.0] * n
    for lattice, d in corners([math.fmod(c, WRAP) for c in point]):
        g = chosen(lattice_bits(*lattice, seed=seed, hash=hash), rows)
        kernel = max(SQUARED[radius] - sum(c * c for c in d), 0.0)
        dot = sum(a * b for a, b in zip(g, d, strict=True))
        noise += kernel**4 * dot
        for k in range(n):
            slope[k] += kernel**4 * g[k] - 8.0 * kernel**3 * dot * d[k]
    peak = PEAKS[n, radius]
    return noise / peak, [s / peak for s in slope]


def simplex(point: Sequence[float], **how) -> float:
    """Give simplex noise at one point."""
    return simplex_derivative(point, **how)[0]


def simplex_grid(
    x: Sequence[float],
    y: Sequence[float],
    z: Sequence[float] | None = None,
    w: Sequence[float] | None = None,
    **how,
) -> list:
    """Give `simplex` at each place of a grid, as [w][z][y][x] or with fewer axes."""
    if z is None:
        return [[simplex((a, b), **how) for a in x] for b in y]
    if w is None:
        return [[[simplex((a, b, c), **how) for a in x] for b in y] for c in z]
    return [
        [[[simplex((a, b, c, d), **how) for a in x] for b in y] for c in z] for d in w
    ]
