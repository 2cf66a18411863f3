"""Metaballs one number at a time: kernels, density sums, and the network's phases.

Each function is the twin of the one of the same name in `refcloud.metaballs`. A ball is
(centre, radius, density).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

Point = Sequence[float]  # x, y, z
Ball = tuple[Point, float, float]
Grid = Sequence[Sequence[Sequence[float]]]  # [z][y][x]


def wyvill(r: float, R: float) -> float:
    """Evaluate eq 12 with the sign that makes it fall (E01), 1 at the centre."""
    if r > R:
        return 0.0
    a = r / R
    return 1.0 - 22.0 / 9.0 * a**2 + 17.0 / 9.0 * a**4 - 4.0 / 9.0 * a**6


def printed_wyvill(r: float, R: float) -> float:
    """Evaluate eq 12 as printed, times k."""
    if r > R:
        return 0.0
    a = r / R
    return 1.0 + 22.0 / 9.0 * a**2 + 17.0 / 9.0 * a**4 - 4.0 / 9.0 * a**6


def gaussian(r: float, sigma: float) -> float:
    """Evaluate eq 15."""
    return math.exp(-((r / sigma) ** 2))


def profile(q: float, kernel: str = "wyvill") -> float:
    """Evaluate a ball's kernel from q = (r/R)^2; a Gaussian ends at R = 2 sigma."""
    if q >= 1.0:
        return 0.0
    r = math.sqrt(q)
    return wyvill(r, 1.0) if kernel == "wyvill" else gaussian(r, 0.5)


def chord(q: float, kernel: str = "wyvill") -> float:
    """Integrate a ball's kernel along a line that passes at q = (b/R)^2, in radii."""
    if q >= 1.0:
        return 0.0
    s = math.sqrt(1.0 - q)
    if kernel == "wyvill":
        return 16.0 / 27.0 * s**5 + 128.0 / 315.0 * s**7
    return math.sqrt(math.pi) / 2.0 * math.exp(-4.0 * q) * math.erf(2.0 * s)


def integral(kernel: str, dimension: int, *, R: float = 1.0) -> float:
    """Integrate a ball's kernel over a diameter, a central disc, or the ball."""
    if kernel == "wyvill":
        disc, ball = 8.0 / 27.0 * math.pi, 736.0 / 2835.0 * math.pi
        return {1: 944.0 / 945.0 * R, 2: disc * R**2, 3: ball * R**3}[dimension]
    sigma, root = R / 2.0, math.sqrt(math.pi)
    if dimension == 1:
        return root * sigma * math.erf(2.0)
    if dimension == 2:
        return math.pi * sigma**2 * (1.0 - math.exp(-4.0))
    inside = math.erf(2.0) - 4.0 * math.exp(-4.0) / root
    return root**3 * sigma**3 * inside


def normalisation(kernel: str, normalize: str = "peak", *, R: float = 1.0) -> float:
    """Give the k that divides a kernel with peak 1 (E02, E03)."""
    if normalize == "volume":
        return integral(kernel, 3, R=R)
    if normalize == "paper" and kernel == "wyvill":
        return 748.0 / 405.0 * math.pi * R
    return 1.0


def axis_depth(
    sigma_t: float, density: float, radius: float, kernel: str = "wyvill"
) -> float:
    """Give the optical depth of one ball along its axis."""
    return sigma_t * density * radius * chord(0.0, kernel)


def field(balls: Sequence[Ball], point: Point, kernel: str = "wyvill") -> float:
    """Sum the densities of all balls at one point (eq 13)."""
    total = 0.0
    for center, radius, density in balls:
        q = sum(((p - c) / radius) ** 2 for p, c in zip(point, center, strict=True))
        total += density * profile(q, kernel)
    return total


def field_grid(
    balls: Sequence[Ball], x: float, *, y: float, z: float, kernel: str = "wyvill"
) -> float:
    """Sum the densities of all balls at one sample of a grid."""
    return field(balls, (x, y, z), kernel)


def voxel_balls(
    density: float, edges: Point, *, kernel: str = "wyvill"
) -> tuple[float, float]:
    """Give radius and density of the ball that stands for one voxel."""
    volume = edges[0] * edges[1] * edges[2]
    radius = 1.5 * volume ** (1.0 / 3.0)
    return radius, density * volume / integral(kernel, 3, R=radius)


def placed(ball: Ball, offset: Point, *, turn: float = 0.0, scale: float = 1.0) -> Ball:
    """Turn one ball about the y axis, scale it, and move it."""
    (x, y, z), radius, density = ball
    c, s = math.cos(turn), math.sin(turn)
    turned = (c * x + s * z, y, c * z - s * x)
    center = [scale * p + o for p, o in zip(turned, offset, strict=True)]
    return center, scale * radius, density / scale


def prune(
    balls: Sequence[Ball], *, neighbour: int = 5, reach: float = 1.9
) -> list[bool]:
    """Tell which balls are kept: those whose n-th neighbour is near."""
    if len(balls) <= neighbour:
        return [True] * len(balls)
    return [
        sorted(math.dist(center, other) for other, _, _ in balls)[neighbour]
        <= reach * radius
        for center, radius, _ in balls
    ]


def depth(density: Grid, edges: Point, x: int, y: int, z: int) -> float:
    """Give one voxel's distance to the centre of the nearest empty one."""
    nearest = math.inf
    for k in range(-1, len(density) + 1):
        for j in range(-1, len(density[0]) + 1):
            for i in range(-1, len(density[0][0]) + 1):
                inside = (
                    0 <= k < len(density)
                    and 0 <= j < len(density[0])
                    and 0 <= i < len(density[0][0])
                )
                if not (inside and density[k][j][i] > 0.0):
                    steps = (i - x, j - y, k - z)
                    squares = [(n * e) ** 2 for n, e in zip(steps, edges, strict=True)]
                    nearest = min(nearest, math.sqrt(sum(squares)))
    return nearest


def nearest(point: Point, centers: Sequence[Point]) -> int:
    """Find the nearest centre, the first where several are."""
    return min(range(len(centers)), key=lambda k: math.dist(point, centers[k]))


def adaptive_kmeans(
    points: Sequence[Point], start: Sequence[int], orders: Sequence[Sequence[int]]
) -> list[list[float]]:
    """Move the nearest centre toward each visited point (eq 21-22)."""
    centers = [list(points[j]) for j in start]
    hits = [0] * len(centers)
    for order in orders:
        for j in order:
            k = nearest(points[j], centers)
            hits[k] += 1
            rate = 1.0 / math.sqrt(hits[k])
            pairs = zip(centers[k], points[j], strict=True)
            centers[k] = [c + rate * (x - c) for c, x in pairs]
    return centers


def lloyd(
    points: Sequence[Point],
    weights: Sequence[float],
    start: Sequence[int],
    rounds: int,
) -> list[list[float]]:
    """Move every centre to the weighted mean of its points, again and again."""
    centers = [list(points[j]) for j in start]
    for _ in range(rounds):
        sums = [[0.0, 0.0, 0.0, 0.0] for _ in centers]
        for point, weight in zip(points, weights, strict=True):
            group = sums[nearest(point, centers)]
            for axis in range(3):
                group[axis] += weight * point[axis]
            group[3] += weight
        for k, group in enumerate(sums):
            if group[3] > 0.0:
                centers[k] = [group[axis] / group[3] for axis in range(3)]
    return centers


def rms_radii(
    points: Sequence[Point],
    center: Point,
    *,
    spacing: float,
    weights: Sequence[float] | None = None,
) -> float:
    """Give one cluster's root mean square distance (eq 23, E18)."""
    counts = [1.0] * len(points) if weights is None else weights
    squares = sum(
        w * math.dist(p, center) ** 2 for p, w in zip(points, counts, strict=True)
    )
    mean = squares / sum(counts) if sum(counts) > 0.0 else 0.0
    return math.sqrt(mean + spacing**2 / 4.0)


def largest_eigenvalue(gram: Sequence[Sequence[float]], steps: int = 2000) -> float:
    """Estimate the largest eigenvalue by repeated products."""
    v = [1.0 + 0.1 * i for i in range(len(gram))]
    length = 0.0
    for _ in range(steps):
        w = [sum(g * x for g, x in zip(row, v, strict=True)) for row in gram]
        length = math.hypot(*w)
        if length == 0.0:
            return 0.0
        v = [x / length for x in w]
    return length


def gradient_descent(
    design: Sequence[Sequence[float]], y: Sequence[float], *, rate: float, steps: int
) -> list[float]:
    """Learn the heights by eq 24, step by step."""
    count = len(design[0])
    v = [0.0] * count
    for _ in range(steps):
        left = [
            target - sum(a * height for a, height in zip(row, v, strict=True))
            for row, target in zip(design, y, strict=True)
        ]
        for k in range(count):
            down = 2.0 * sum(r * row[k] for r, row in zip(left, design, strict=True))
            v[k] += rate * down
    return v


def non_negative_least_squares(
    gram: Sequence[Sequence[float]], right: Sequence[float], rounds: int = 2000
) -> list[float]:
    """Find the heights from 0 that fit best, one height at a time."""
    v = [0.0] * len(right)
    for _ in range(rounds):
        for k, row in enumerate(gram):
            if row[k] > 0.0:
                others = sum(g * x for g, x in zip(row, v, strict=True)) - row[k] * v[k]
                v[k] = max((right[k] - others) / row[k], 0.0)
    return v


def errors_of_fit(expected: Sequence[float], actual: Sequence[float]) -> float:
    """Give the relative root mean square error of some numbers."""
    off = sum((y - g) ** 2 for y, g in zip(expected, actual, strict=True))
    return math.sqrt(off / sum(y**2 for y in expected))
