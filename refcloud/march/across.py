"""Metaballs seen along one direction, in square cells of the plane across it.

A ray along that direction is a point of the plane, and a ball is a disc. Each cell
lists the balls whose discs touch it; a ray meets no other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from refcloud.conventions import Array
from refcloud.march.cells import Numbers
from refcloud.march.chords import chords_of, passing
from refcloud.march.quadrature import per_ray
from refcloud.metaballs import Metaballs

PAIRS = 1 << 16  # of a ray and a ball at a time: temporaries stay in the cache
FINENESS = 0.5  # a cell's edge over the middle radius: fewer balls that are missed
# Memory stays bounded: cells that a ball touches, in the mean, and cells for each ball,
# where few balls count as so many.
MOST_CELLS, LEAST = 64, 256
# Discs are larger by this share of the cloud: places are known to 1e-15 of it.
SLACK = 1e-9


@dataclass(frozen=True)
class Across:
    """Balls by cells of the plane across a direction.

    Attributes
    ----------
    balls
        The cloud.
    direction
        Unit vector, shape (3,).
    plane
        Two unit vectors across it, shape (2, 3).
    middle
        Where the plane's coordinates begin, scene units, shape (3,).
    lower, edge
        The first cell's corner in the plane, shape (2,), and the edge of a cell.
    cells
        How many there are along both, shape (2,).
    first
        Where each cell's balls begin in `numbers`, and where the last ones end.
    numbers
        Balls of one cell after the other, ascending in each.
    """

    balls: Metaballs
    direction: Array
    plane: Array
    middle: Array
    lower: Array
    edge: float
    cells: Numbers
    first: Numbers
    numbers: Numbers

    def columns(self, places: Array) -> tuple[Array, int]:
        """Integrate the density from places on, along the direction.

        Parameters
        ----------
        places
            Within the box of the balls, shape (N, 3), scene units.

        Returns
        -------
        Shape (N,), to the last bit what `columns_of` gives, and how many pairs of a ray
        and a ball were looked at.
        """
        # 1. The cell of each place; outside all cells there is no ball.
        at = ((places - self.middle) @ self.plane.T - self.lower) / self.edge
        cell = np.floor(at).astype(np.intp)
        within = ((cell >= 0) & (cell < self.cells)).all(axis=1)
        cell = np.where(within, cell[:, 0] * self.cells[1] + cell[:, 1], 0)
        first = self.first[cell]
        count = np.where(within, self.first[cell + 1] - first, 0)

        # 2. So many places at a time that their pairs fit.
        found = np.zeros(len(places))
        ends = np.cumsum(count)
        start = 0
        while start < len(places):
            passed = ends[start - 1] if start else 0
            stop = int(np.searchsorted(ends, passed + PAIRS, side="right"))
            part = slice(start, max(stop, start + 1))
            found[part] = self._columns(places[part], first[part], count[part])
            start = part.stop
        return found, int(count.sum())

    def _columns(self, places: Array, first: Numbers, count: Numbers) -> Array:
        ray = np.repeat(np.arange(len(places)), count)
        before = np.cumsum(count) - count
        ball = self.numbers[np.arange(len(ray)) + np.repeat(first - before, count)]
        offset = [places[ray, k] - self.balls.centers[ball, k] for k in range(3)]
        way = [self.direction[k] for k in range(3)]
        q, u = passing(offset, way, self.balls.radii[ball])
        meets = (q < 1.0) & (u < np.sqrt(np.maximum(1.0 - q, 0.0)))
        chord = chords_of(self.balls, ball[meets], q[meets], u[meets])
        return per_ray(ray[meets], chord, len(places))


def across(balls: Metaballs, direction: Array) -> Across:
    """List balls by cells of the plane across a direction.

    Parameters
    ----------
    balls
        The cloud, at least one ball.
    direction
        Unit vector, shape (3,).

    Returns
    -------
    The lists.
    """
    # 1. Discs, in a plane through the cloud's middle: far clouds keep their digits.
    aside = np.eye(3)[int(np.argmin(np.abs(direction)))]
    right = np.cross(direction, aside)
    right /= np.linalg.norm(right)
    plane = np.stack([right, np.cross(right, direction)]).astype(np.float64)
    low, high = balls.centers.min(axis=0), balls.centers.max(axis=0)
    middle = 0.5 * low + 0.5 * high
    at = (balls.centers - middle) @ plane.T
    largest = float(balls.radii.max())
    reach = balls.radii + SLACK * (float(np.abs(high - low).max()) + largest)
    lower = (at - reach[:, None]).min(axis=0)

    # 2. The cells that each disc's square touches; coarser ones where they are many.
    edge = FINENESS * float(np.median(balls.radii))
    while True:
        begin = np.floor((at - reach[:, None] - lower) / edge)
        end = np.floor((at + reach[:, None] - lower) / edge)
        sides = end - begin + 1.0
        cells = end.max(axis=0) + 1.0
        touched = float(sides.prod(axis=1).mean())
        if touched <= MOST_CELLS and cells.prod() <= MOST_CELLS * (LEAST + len(balls)):
            break
        edge *= 2.0
    begin, sides, cells = (n.astype(np.intp) for n in (begin, sides, cells))
    return _listed(balls, direction, plane, middle, lower, edge, cells, begin, sides)


def _listed(
    balls: Metaballs,
    direction: Array,
    plane: Array,
    middle: Array,
    lower: Array,
    edge: float,
    cells: Numbers,
    begin: Numbers,
    sides: Numbers,
) -> Across:
    """Turn each ball's cells into each cell's balls."""
    touched = sides.prod(axis=1)
    ball = np.repeat(np.arange(len(touched)), touched)
    number = np.arange(len(ball)) - np.repeat(np.cumsum(touched) - touched, touched)
    row, column = np.divmod(number, sides[ball, 1])
    cell = (begin[ball, 0] + row) * cells[1] + begin[ball, 1] + column
    first = np.zeros(int(cells.prod()) + 1, np.intp)
    np.cumsum(np.bincount(cell, minlength=len(first) - 1), out=first[1:])
    numbers = ball[np.argsort(cell, kind="stable")]
    return Across(balls, direction, plane, middle, lower, edge, cells, first, numbers)
