"""Light inside a voxel grid, one ray and one sample at a time.

Each function is the twin of the one of the same name in `refcloud.transport`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from refcloud.plain.camera import unit
from refcloud.plain.cloudmap import Grid, Point, cell_size, clamped_trilinear


def column_density(
    density: Grid, lower: Point, upper: Point, point: Point, direction: Point
) -> float:
    """Integrate the density from one point toward a light, piece by piece.

    Between planes through cell centres the field along the ray is a cubic polynomial:
    two Gauss points integrate it exactly.
    """
    counts = len(density[0][0]), len(density[0]), len(density)
    size = cell_size(density, lower, upper)
    toward = unit((direction[0], direction[1], direction[2]))
    step = [d / h for d, h in zip(toward, size, strict=True)]
    start = [(p - a) / h - 0.5 for p, a, h in zip(point, lower, size, strict=True)]
    near, far = 0.0, math.inf
    crossings = []
    for n, at, move in zip(counts, start, step, strict=True):
        if move == 0.0:
            if not -0.5 <= at <= n - 0.5:
                return 0.0
            continue
        ends = sorted(((-0.5 - at) / move, (n - 0.5 - at) / move))
        near, far = max(near, ends[0]), min(far, ends[1])
        crossings += [(i - at) / move for i in range(n)]
    if far <= near:
        return 0.0
    cuts = [near, *sorted(t for t in crossings if near < t < far), far]
    total = 0.0
    for i in range(len(cuts) - 1):
        a, b = cuts[i], cuts[i + 1]
        for side in (-1.0, 1.0):
            t = 0.5 * (a + b) + side * 0.5 * (b - a) / math.sqrt(3.0)
            place = [s + t * move for s, move in zip(start, step, strict=True)]
            total += 0.5 * (b - a) * clamped_trilinear(density, place)
    return total


class Slices(NamedTuple):
    """A grid turned so that light comes down through slices, number 0 first."""

    cell: Callable[[int, int, int], float]  # slice, v, u
    counts: tuple[int, int, int]  # slices, cells along v and u
    slopes: tuple[float, float]  # cells that a ray moves up v and u, a slice
    length: float  # of a ray between slices
    scale: int  # samples per cell
    filled: bool  # whether there is cloud on a side that rays leave aslant

    def field(self, at: Sequence[float]) -> float:
        """Give the density at slice, v and u, as `clamped_trilinear`."""
        total = 0.0
        held = [min(max(a, 0.0), n - 1.0) for a, n in zip(at, self.counts, strict=True)]
        for corner in range(8):
            weight, place = 1.0, []
            for axis, a in enumerate(held):
                low, upward = math.floor(a), corner >> axis & 1
                weight *= a - low if upward else 1.0 - (a - low)
                place.append(min(low + upward, self.counts[axis] - 1))
            total += weight * self.cell(*place) if weight else 0.0
        return total


def passed(
    slices: Slices, m: int, c: tuple[int, int], axes: Sequence[int] = (0, 1)
) -> float:
    """Sum what the light on one column has passed when it reaches sample slice m.

    Column c is the ray through sample c of slice 0. Where cloud fills the box to its
    border, columns beyond the sides that face the sun are carried on from inside.
    """
    for number, axis in enumerate(axes if slices.filled else ()):
        cells, slope = slices.counts[1 + axis], slices.slopes[axis]
        last = slices.scale * cells - 1 + math.floor(m * slope)
        if c[axis] > last:
            return beyond(slices, m, c, axes[number:], last)
    return passed_inside(slices, m, c)


def passed_inside(slices: Slices, m: int, c: tuple[int, int]) -> float:
    """Sum the steps of one column: the field in the middle of each, if in the box."""
    s, total = slices.scale, 0.0
    for i in range(m + 1):
        step = 0.5 if i == 0 else 1.0  # the box begins half a step before slice 0
        middle = i - 0.5 * step
        place, shares = [(middle + 0.5) / s - 0.5], []
        for axis in (0, 1):
            n, slope = slices.counts[1 + axis], slices.slopes[axis]
            at = (c[axis] - middle * slope + 0.5) / s - 0.5
            inside = s * (n - 0.5 - at)  # samples from the side that faces the sun
            place.append(at)
            across = slope * step  # samples; half the least number is 0
            if across == 0.0:
                shares.append(float(inside > 0.0))
            else:
                shares.append(min(max(0.5 + inside / across, 0.0), 1.0))
        total += step * min(shares) * slices.field(place)
    return total * slices.length / s


def beyond(
    slices: Slices, m: int, c: tuple[int, int], axes: Sequence[int], last: int
) -> float:
    """Give what stands for a column beyond the side that faces the sun, along axes[0].

    A straight line from the last column inside: at the last sample it has the mean
    density of that column, times the sample's own length in the box. The column itself
    comes in as the side moves beyond it.
    """
    axis, *others = axes
    near, next_ = (
        (column, c[1]) if axis == 0 else (c[0], column) for column in (last, last + 1)
    )
    inside = passed(slices, m, near, others)
    own = max(2.0 * (m * slices.slopes[axis] % 1.0) - 1.0, 0.0)
    first = own * passed(slices, m, next_, others)
    first += (1.0 - own) * border_factor(slices, m, axis, c[1 - axis]) * inside
    return first + (c[axis] - last - 1) * (first - inside)


def border_factor(slices: Slices, m: int, axis: int, other: int) -> float:
    """Give a column just beyond a side, per value of the last one inside."""
    slope, across = slices.slopes[axis], slices.slopes[1 - axis]
    f = m * slope - math.floor(m * slope)
    if slope == 0.0 or f == 0.0:
        return 1.0
    steps = m + 0.5
    if across > 0.0:
        side = slices.scale * slices.counts[2 - axis] - 0.5
        steps = min(steps, max(side - (other - m * across), 0.5) / across)
    inner = min(steps, (0.5 + f) / slope)
    return (min(steps, 0.5 / slope) / inner - (1.0 - f)) / f


def catmull_rom(t: float) -> list[float]:
    """Weigh the values at -1, 0, 1 and 2 for a place t in [0, 1)."""
    return [
        (-t + 2.0 * t**2 - t**3) / 2.0,
        (2.0 - 5.0 * t**2 + 3.0 * t**3) / 2.0,
        (t + 4.0 * t**2 - 3.0 * t**3) / 2.0,
        (-(t**2) + t**3) / 2.0,
    ]


def sun_depths(
    density: Grid,
    lower: Point,
    upper: Point,
    direction: Point,
    sample: tuple[int, int, int],
    *,
    scale: int,
) -> float:
    """Read one sample's column density between the columns; sample is x, y, z.

    Cubic, since this is the one place that blurs.
    """
    slices, order, flip = turned(density, lower, upper, direction, scale)
    m, *j = (
        scale * n - 1 - sample[axis] if back else sample[axis]
        for n, axis, back in zip(slices.counts, order, flip, strict=True)
    )
    moved = [m * slope for slope in slices.slopes]
    weights = [catmull_rom(a - math.floor(a)) for a in moved]
    total = 0.0
    for v in range(4):
        for u in range(4):
            c = j[0] + math.floor(moved[0]) + v - 1, j[1] + math.floor(moved[1]) + u - 1
            weight = weights[0][v] * weights[1][u]
            total += weight * passed(slices, m, c) if weight else 0.0
    return max(total, 0.0)


def turned(
    density: Grid, lower: Point, upper: Point, direction: Point, scale: int
) -> tuple[Slices, list[int], list[bool]]:
    """Turn a grid so that the sun stands over slice 0, toward high v and u.

    Also gives which axes slices, v and u are, and which of them run backward.
    """
    counts = [len(density[0][0]), len(density[0]), len(density)]
    size = cell_size(density, lower, upper)
    toward = unit((direction[0], direction[1], direction[2]))
    cells = [d / h for d, h in zip(toward, size, strict=True)]
    main = max(range(3), key=lambda axis: abs(cells[axis]))
    order = [main, *(axis for axis in (2, 1, 0) if axis != main)]
    flip = [cells[main] > 0.0, cells[order[1]] < 0.0, cells[order[2]] < 0.0]

    def cell(*place: int) -> float:
        at = [0, 0, 0]
        for axis, back, number in zip(order, flip, place, strict=True):
            at[axis] = counts[axis] - 1 - number if back else number
        return density[at[2]][at[1]][at[0]]

    slopes = abs(cells[order[1]] / cells[main]), abs(cells[order[2]] / cells[main])
    K, V, U = (counts[axis] for axis in order)
    filled = any(
        cell(k, v, u) > 0.0
        for k in range(K)
        for v in range(V)
        for u in range(U)
        if v in (0, V - 1) or u in (0, U - 1)
    )
    length = size[main] / abs(toward[main])
    slices = Slices(cell, (K, V, U), slopes, length, scale, filled)
    return slices, order, flip
