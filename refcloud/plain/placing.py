"""Where balls go, by the methods that the paper names beside its own (A13)."""

from __future__ import annotations

from collections.abc import Sequence

from refcloud.plain.metaballs import Grid, Point, profile


def spaced_patterns(cells: Sequence[Sequence[int]], count: int) -> list[int]:
    """Choose cells evenly along the curve that interleaves the bits of x, y and z."""

    def key(k: int) -> int:
        place = 0
        for bit in range(max(max(cell) for cell in cells).bit_length()):
            for axis in range(3):
                place += (cells[k][axis] // 2**bit % 2) * 8**bit * 2**axis
        return place

    order = sorted(range(len(cells)), key=key)
    count = min(count, len(cells))
    return sorted(order[(2 * i + 1) * len(cells) // (2 * count)] for i in range(count))


def orthogonal_least_squares(
    design: Sequence[Sequence[float]], y: Sequence[float], count: int
) -> list[int]:
    """Choose columns one by one, each time taking the chosen one out of the others."""
    columns = [list(column) for column in zip(*design, strict=True)]
    own = [sum(a * a for a in column) for column in columns]
    chosen: list[int] = []
    while len(chosen) < min(count, len(columns)):
        gains = []
        for k, w in enumerate(columns):
            power = sum(a * a for a in w)
            part = sum(a * b for a, b in zip(w, y, strict=True))
            free = k not in chosen and power > 1e-10 * own[k]
            gains.append(part**2 / power if free else 0.0)
        best = max(range(len(gains)), key=lambda k: gains[k])
        if gains[best] == 0.0:
            break
        chosen.append(best)
        w = list(columns[best])
        power = sum(a * a for a in w)
        for column in columns:
            share = sum(a * b for a, b in zip(column, w, strict=True)) / power
            column[:] = [a - share * b for a, b in zip(column, w, strict=True)]
    return chosen


def place_and_subtract(
    density: Grid, edges: Point, radii: Sequence[float], *, count: int
) -> list[list[float]]:
    """Put a ball where most is missing, take it away, and look again."""
    left = {
        (x, y, z): value
        for z, layer in enumerate(density)
        for y, line in enumerate(layer)
        for x, value in enumerate(line)
    }
    balls: list[list[float]] = []
    least = 1e-9 * max(left.values())
    while len(balls) < count and max(left.values()) > least:
        place = max(left, key=lambda p: (left[p], -p[2], -p[1], -p[0]))
        best, gain = (0.0, 0.0), 0.0
        for R in radii:
            ball = {p: _at(p, place, edges, R) for p in left}
            product = sum(left[p] * k for p, k in ball.items())
            power = sum(k * k for k in ball.values())
            if product > least * power and product**2 / power > gain:
                best, gain = (R, product / power), product**2 / power
        if gain == 0.0:
            left[place] = 0.0
            continue
        R, height = best
        for p in left:
            left[p] -= height * _at(p, place, edges, R)
        balls.append([*(c * e for c, e in zip(place, edges, strict=True)), R, height])
    return balls


def _at(p: Point, place: Point, edges: Point, R: float) -> float:
    """Evaluate a ball on one voxel at another."""
    pairs = zip(p, place, edges, strict=True)
    return profile(sum(((a - b) * e / R) ** 2 for a, b, e in pairs))
