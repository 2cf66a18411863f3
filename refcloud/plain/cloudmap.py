"""Cloud maps, one point, one voxel or one ellipsoid at a time.

Each function is the twin of the one of the same name in `refcloud.cloudmap`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from refcloud.plain.noise import uniform

Point = Sequence[float]  # x, y, z
Grid = Sequence[Sequence[Sequence[float]]]  # [z][y][x]


def product(a: Sequence[Point], b: Sequence[Point]) -> list[list[float]]:
    """Multiply two 3 by 3 matrices."""
    return [[sum(row[k] * b[k][j] for k in range(3)) for j in range(3)] for row in a]


def rotation(turn: float, tilt: float, roll: float) -> list[list[float]]:
    """Turn about y, then tilt about x, then roll about z of the turned frame."""
    c, s = math.cos(turn), math.sin(turn)
    about_y = [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]
    c, s = math.cos(tilt), math.sin(tilt)
    about_x = [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]
    c, s = math.cos(roll), math.sin(roll)
    about_z = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
    return product(product(about_y, about_x), about_z)


def quadric(
    center: Point,
    radii: Point,
    *,
    turn: float = 0.0,
    tilt: float = 0.0,
    roll: float = 0.0,
) -> list[float]:
    """Expand 1 - |diag(1 / radii) M^T (p - center)|^2 into q0 ... q9 (eq 8)."""
    q = [1.0] + [0.0] * 9
    M = rotation(turn, tilt, roll)
    for axis in range(3):
        # This axis contributes -(a x + b y + c z + d)^2.
        a, b, c = (M[row][axis] / radii[axis] for row in range(3))
        d = -(a * center[0] + b * center[1] + c * center[2])
        squares = [d * d, a * a, b * b, c * c]
        doubles = [a * b, b * c, a * c, a * d, b * d, c * d]
        for i, term in enumerate(squares + [2.0 * term for term in doubles]):
            q[i] -= term
    return q


def evaluate_quadric(q: Sequence[float], point: Point) -> float:
    """Evaluate the ten terms at one point (eq 8)."""
    x, y, z = point
    terms = [1.0, x * x, y * y, z * z, x * y, y * z, x * z, x, y, z]
    return math.fsum(a * b for a, b in zip(q, terms, strict=True))


def modulate(
    Q: float, noise: float, *, threshold: float = 0.1, dynamics: float = 1.0
) -> float:
    """Give one point's density from quadric and noise (eq 9, 10; E15)."""
    if not 0.0 <= Q <= 1.0 or Q * noise < threshold:
        return 0.0
    return dynamics * Q * noise


def cell_size(density: Grid, lower: Point, upper: Point) -> list[float]:
    """Give one cell's edges."""
    counts = len(density[0][0]), len(density[0]), len(density)
    return [(b - a) / n for a, b, n in zip(lower, upper, counts, strict=True)]


def cell_centres(density: Grid, lower: Point, upper: Point) -> list[list[float]]:
    """List the coordinates of the cells' centres along x, y and z."""
    counts = len(density[0][0]), len(density[0]), len(density)
    return [
        [a + (i + 0.5) * (b - a) / n for i in range(n)]
        for a, b, n in zip(lower, upper, counts, strict=True)
    ]


def trilinear(density: Grid, lower: Point, upper: Point, point: Point) -> float:
    """Sample a grid at one point: eight centres, clamped, and 0 outside the box."""
    if not all(a <= p <= b for a, p, b in zip(lower, point, upper, strict=True)):
        return 0.0
    size = cell_size(density, lower, upper)
    at = [(p - a) / s - 0.5 for p, a, s in zip(point, lower, size, strict=True)]
    return clamped_trilinear(density, at)


def clamped_trilinear(density: Grid, at: Point) -> float:
    """Sample a grid at one place in cells."""
    counts = len(density[0][0]), len(density[0]), len(density)
    return sum(weight * density[k][j][i] for i, j, k, weight in corners(counts, at))


def corners(counts: Sequence[int], at: Point) -> list[tuple[int, int, int, float]]:
    """List the eight centres around a place in cells, and what each one weighs."""
    found = []
    at = [min(max(c, 0.0), n - 1.0) for c, n in zip(at, counts, strict=True)]
    for corner in range(8):
        cell, weight = [], 1.0
        for axis in range(3):
            low = math.floor(at[axis])
            upward = corner >> axis & 1
            cell.append(min(low + upward, counts[axis] - 1))
            weight *= at[axis] - low if upward else 1.0 - (at[axis] - low)
        found.append((cell[0], cell[1], cell[2], weight))
    return found


def largest_part(density: Grid) -> list[list[list[float]]]:
    """Keep the largest part that hangs together by faces: a flood fill.

    Of equal parts the one that holds the last cell stays.
    """
    D, H, W = len(density), len(density[0]), len(density[0][0])
    cells = [(k, j, i) for k in range(D) for j in range(H) for i in range(W)]
    seen: set[tuple[int, int, int]] = set()
    kept: set[tuple[int, int, int]] = set()
    for start in reversed(cells):
        if start in seen or not density[start[0]][start[1]][start[2]] > 0.0:
            continue
        part, waiting = {start}, [start]
        while waiting:
            k, j, i = waiting.pop()
            for dk, dj, di in (
                *((1, 0, 0), (-1, 0, 0), (0, 1, 0)),
                *((0, -1, 0), (0, 0, 1), (0, 0, -1)),
            ):
                near = k + dk, j + dj, i + di
                inside = 0 <= near[0] < D and 0 <= near[1] < H and 0 <= near[2] < W
                if inside and near not in part:
                    if density[near[0]][near[1]][near[2]] > 0.0:
                        part.add(near)
                        waiting.append(near)
        seen |= part
        if len(part) > len(kept):
            kept = part
    return [
        [
            [density[k][j][i] if (k, j, i) in kept else 0.0 for i in range(W)]
            for j in range(H)
        ]
        for k in range(D)
    ]


def drawn(
    number: int, generation: int, what: int, low: float, high: float, seed: int
) -> float:
    """Draw a number between two others for one ellipsoid of a generation."""
    return low + (high - low) * uniform(number, generation, what, seed=seed)


def base_ellipsoid(
    number: int, count: int, diameters: Point, crest: float, seed: int
) -> tuple[list[float], list[float]]:
    """Give centre and half axes of one ellipsoid of the base row."""
    width, height, depth = diameters

    def draw(what: int, low: float, high: float) -> float:
        return drawn(number, 0, what, low, high, seed)

    along = 0.55 * (2.0 * number / (count - 1) - 1.0) + draw(0, -0.08, 0.08)
    bulge = max(0.35, 1.0 - abs(along - crest) ** 1.3)
    radii = [
        0.24 * width * draw(1, 0.85, 1.1),
        0.48 * height * bulge * draw(2, 0.9, 1.05),
        0.38 * depth * draw(3, 0.8, 1.1),
    ]
    aside = 0.15 * depth * draw(4, -1.0, 1.0)
    return [0.5 * width * along, 0.55 * radii[1], aside], radii


def child_ellipsoid(
    number: int, generation: int, parent: Sequence[Point], shrink: float, seed: int
) -> tuple[list[float], list[float]]:
    """Give centre and half axes of one ellipsoid that sits on a parent."""

    def draw(what: int, low: float, high: float) -> float:
        return drawn(number, generation, what, low, high, seed)

    up, around = draw(0, -0.15, 1.0), draw(1, 0.0, 2.0 * math.pi)
    level = math.sqrt(1.0 - up**2)
    out = [level * math.cos(around), up, level * math.sin(around)]
    far = draw(2, 0.75, 0.95)
    center = [c + r * o * far for c, r, o in zip(*parent, out, strict=True)]
    size = math.prod(parent[1]) ** (1.0 / 3.0) * shrink * draw(3, 0.75, 1.25)
    return center, [1.08 * size, 0.95 * size, 1.08 * size]


def cumulus_ellipsoids(
    diameters: Point,
    *,
    seed: int,
    lobes: Sequence[int],
    shrink: Sequence[float],
    crest: float,
) -> list[tuple[list[float], list[float]]]:
    """Pile up ellipsoids in generations, one after the other: (centre, half axes)."""
    row = [
        base_ellipsoid(number, lobes[0], diameters, crest, seed)
        for number in range(lobes[0])
    ]
    pile = list(row)
    for generation in range(1, len(lobes)):
        each = lobes[generation]
        row = [
            child_ellipsoid(
                number, generation, row[number // each], shrink[generation - 1], seed
            )
            for number in range(each * len(row))
        ]
        pile += row
    return pile


def depth_inside(
    point: Point, ellipsoids: Sequence[tuple[Point, Point]], *, least: float = -1e300
) -> float:
    """Tell how deep one point lies inside a union of ellipsoids."""
    deepest = least
    for center, radii in ellipsoids:
        scaled = [(p - c) / r for p, c, r in zip(point, center, radii, strict=True)]
        deepest = max(deepest, min(radii) * (1.0 - math.hypot(*scaled)))
    return deepest


def displace(
    depth: float, noise: float, y: float, *, relief: float, edge: float, mean: float
) -> float:
    """Move the surface by the noise at one point, and cut it off at the base."""
    surface = (depth + relief * (abs(noise) - mean)) / edge
    base = y + noise / 2.0
    return min(max(surface, 0.0), 1.0) * min(max(base, 0.0), 1.0)
