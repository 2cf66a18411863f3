"""Light through a voxel grid, one ray at a time.

Each function is the twin of the one of the same name in `refcloud.transport`.
A grid is a list of slices of rows: ``grid[z][y][x]``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from refcloud.plain.scattering import Point, unit

Grid = Sequence[Sequence[Sequence[float]]]
Place = tuple[int, int, int]  # z, y, x


class Step(NamedTuple):
    """How a beam crosses slices: per slice one voxel along z, y or x, and sideways."""

    axis: int
    moved: tuple[float, float, float]  # voxels in z, y, x
    length: float


def step_of(vector: Point, cell: Point) -> Step:
    """Find the axis that a beam crosses fastest, the first of equals in z, y, x."""
    slope = [v / edge for v, edge in zip(vector, cell, strict=True)][::-1]
    fastest = max(map(abs, slope))
    axis = next(a for a in range(3) if abs(slope[a]) > fastest * (1.0 - 1e-9))
    moved = [v / abs(slope[axis]) for v in slope]
    whole = [round(m) if abs(m - round(m)) < 1e-9 else m for m in moved]
    return Step(axis, (whole[0], whole[1], whole[2]), 1.0 / abs(slope[axis]))


def mean_transmittance(tau: float) -> float:
    """Average exp(-t) over 0 to tau."""
    if tau > 1e-3:
        return -math.expm1(-tau) / tau
    return 1.0 - tau / 2.0 + tau * tau / 6.0


def taps(offset: float, shift: str) -> dict[int, float]:
    """Give the voxels around i - offset, relative to i, and their weights."""
    base = math.floor(-offset)
    t = -offset - base
    if shift == "linear" or t == 0.0:
        return {base: 1.0 - t, base + 1: t}
    return {
        base - 1: -0.5 * t * (1.0 - t) ** 2,
        base: 1.0 + t * t * (1.5 * t - 2.5),
        base + 1: t * (0.5 + t * (2.0 - 1.5 * t)),
        base + 2: -0.5 * t * t * (1.0 - t),
    }


def inside(grid: Grid, place: Place) -> bool:
    """Tell whether a place is one of the grid's voxels."""
    z, y, x = place
    return 0 <= z < len(grid) and 0 <= y < len(grid[0]) and 0 <= x < len(grid[0][0])


def beam_into(
    source: Grid, extinction: Grid, step: Step, place: Place, shift: str
) -> float:
    """Follow a beam back: what enters a voxel left the ones behind it."""
    behind = place[step.axis] - int(step.moved[step.axis])
    first, second = (a for a in range(3) if a != step.axis)
    total = 0.0
    for j, v in taps(step.moved[first], shift).items():
        for i, u in taps(step.moved[second], shift).items():
            at = list(place)
            at[step.axis] = behind
            at[first] += j
            at[second] += i
            z, y, x = at
            if inside(extinction, (z, y, x)) and u * v != 0.0:
                I = beam_into(source, extinction, step, (z, y, x), shift)
                S, fade = source[z][y][x], math.exp(-extinction[z][y][x] * step.length)
                total += u * v * (S + fade * (I - S))
    return total


def sweep(
    source: Grid,
    extinction: Grid,
    vector: Point,
    cell: Point,
    inflow: float,
    place: Place,
    shift: str = "cubic",
) -> float:
    """Give the mean radiance in one voxel along one direction.

    What enters the grid is taken off everywhere, so that outside is dark.
    """
    z, y, x = place
    less = [[[S - inflow for S in row] for row in rows] for rows in source]
    step = step_of(vector, cell)
    I = beam_into(less, extinction, step, place, shift)
    mean = mean_transmittance(extinction[z][y][x] * step.length)
    return less[z][y][x] + mean * (I - less[z][y][x]) + inflow


def cell_mean(tau: float, own: float) -> float:
    """Average sunlight over a voxel from the depth at its centre: T sinh(x) / x."""
    return math.exp(-max(tau - own / 2.0, 0.0)) * mean_transmittance(own)


def folded_beams(
    tau: float, whole: float, own: float, turned: float
) -> tuple[float, float]:
    """Average two opposed beams over a voxel, each turned into the other."""
    k = math.sqrt(1.0 - turned * turned)
    r = (1.0 - k) / (1.0 + k)
    on, back = cell_mean(k * tau, k * own), cell_mean(k * (2.0 * whole - tau), k * own)
    left = 1.0 - r * math.exp(-2.0 * k * whole)
    return (on - r * back) / left, math.sqrt(r) * (on - back) / left


def intercepted(density: Grid, cell: Point, toward: Point, scale: float) -> float:
    """Add up what a cloud takes out of each ray of a beam, one ray per voxel."""
    step = step_of([-v for v in unit(toward)], cell)
    sizes = (len(density), len(density[0]), len(density[0][0]))
    K, sense = sizes[step.axis], step.moved[step.axis]
    first, second = (a for a in range(3) if a != step.axis)
    sides = step.moved[first], step.moved[second]
    # Rays go through centres in the middle of the grid.
    middle = (K - 1) / 2.0
    room = [math.ceil(abs(side) * K) for side in sides]
    taken = 0.0
    for j in range(-room[0], sizes[first] + room[0]):
        for i in range(-room[1], sizes[second] + room[1]):
            column = 0.0
            for k in range(K):
                at = {step.axis: float(k if sense > 0 else K - 1 - k)}
                at[first] = j + sides[0] * (k - middle)
                at[second] = i + sides[1] * (k - middle)
                column += between(density, at[0], at[1], at[2])
            taken -= math.expm1(-scale * step.length * column)
    return taken * cell[0] * cell[1] * cell[2] / step.length


def between(grid: Grid, z: float, y: float, x: float) -> float:
    """Interpolate linearly between voxels' centres; 0 beyond the outermost."""
    total = 0.0
    for k in (math.floor(z), math.floor(z) + 1):
        for j in (math.floor(y), math.floor(y) + 1):
            for i in (math.floor(x), math.floor(x) + 1):
                if inside(grid, (k, j, i)):
                    weight = (1 - abs(z - k)) * (1 - abs(y - j)) * (1 - abs(x - i))
                    total += weight * grid[k][j][i]
    return total
