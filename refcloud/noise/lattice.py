"""The smoothed lattice function f (eq 3): 27 taps, one point at a time or a block.

The four weights of eq 3 have the common denominator 216, and lattice numbers are
multiples of 2^-30: sums of 27 of them are exact in float64, in whichever order. So the
27 taps may be taken as sums along one axis after another, and the same lattice point
has the same bits whichever way it was reached.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.conventions import Array, Seed
from refcloud.noise.hashing import Integers, Words, _lattice_random, _shaped, _words
from refcloud.noise.scattered import Dtype, Numbers
from refcloud.noise.weights import Interpolant, _taps

Cells = NDArray[np.int64]

# Weight of a tap by the number of axes along which it is off the centre, times 216:
# alpha 9/18, gamma 4/(6 18), delta 3/(12 18), beta 2/(8 18).
WEIGHTS = CENTRE, SIDE, EDGE, CORNER = (108, 8, 3, 3)  # EDGE equals CORNER
DENOMINATOR = 216

SLAB = 1 << 16  # values in one step over a block: its temporaries fit a core's cache
PERIOD = 2.0**32  # lattice coordinates wrap here, for every hash


@checked
def smoothed(x: Integers, y: Integers, z: Integers, *, seed: Seed | None = 0) -> Array:
    """Give the weighted mean of a lattice point's 27 neighbours.

    Formula: f = alpha g + beta corners + gamma sides + delta dgSides,
    alpha = 9/18, beta = 2/(8 18), gamma = 4/(6 18), delta = 3/(12 18)

    Parameters
    ----------
    x, y, z
        Whole numbers, which broadcast. Taken modulo 2^32.
    seed
        Which pattern. None is the paper's hash.

    Returns
    -------
    Numbers in [-1, 1], of the broadcast shape.

    Raises
    ------
    TypeError
        A coordinate is not whole.

    Source: paper M, eq 3 (N05); E10.

    Examples
    --------
    >>> smoothed(np.arange(4), 0, 0, seed=7).shape
    (4,)
    """
    cx, cy, cz = _words("x", x), _words("y", y), _words("z", z)
    total: Array = np.zeros(np.broadcast_shapes(cx.shape, cy.shape, cz.shape))
    for dx, dy, dz in itertools.product((-1, 0, 1), repeat=3):
        weight = WEIGHTS[abs(dx) + abs(dy) + abs(dz)]
        total += weight * _lattice_random(
            _moved(cx, dx), _moved(cy, dy), _moved(cz, dz), seed
        )
    return _shaped(total / DENOMINATOR, x, y, z)


@dataclass(frozen=True)
class AxisTaps:
    """What one axis of sample points asks of the lattice.

    Attributes
    ----------
    lines
        Lattice coordinates to hash, sorted, each once, shape (L,).
    index
        For tap k of sample i, its place among the lines (without the halo that
        smoothing uses up), shape (K, n).
    weights
        The taps' weights, shape (K, n).
    """

    lines: Cells
    index: Cells
    weights: Array

    def part(self, chosen: slice, smooth: bool) -> AxisTaps:
        """Keep some of the samples, and only the lines that they need."""
        first = self.lines[1:-1] if smooth else self.lines
        return _axis_taps(first[self.index[:, chosen]], self.weights[:, chosen], smooth)


def _axis_taps(wanted: Cells, weights: Array, smooth: bool) -> AxisTaps:
    """Find the lines that the wanted lattice coordinates (K, n) come from."""
    lines = np.unique(wanted)
    if smooth:
        lines = np.unique(np.concatenate((lines - 1, lines, lines + 1)))
    return AxisTaps(lines, np.searchsorted(lines, wanted) - int(smooth), weights)


def _axis(coordinates: Array, interpolant: Interpolant, smooth: bool) -> AxisTaps:
    """Lay the taps of one axis of a grid."""
    cells, t = _cells(_reduced(coordinates))
    weights, offsets = _taps(interpolant, t)
    wanted = cells + np.array(offsets)[:, np.newaxis]
    return _axis_taps(wanted, np.stack(weights), smooth)


def _reduced(coordinates: Array, period: float = PERIOD) -> Array:
    """Take finite coordinates modulo the period, exactly, keeping their sign."""
    # fmod costs as much as ten other passes, and leaves what is small as it is.
    if not coordinates.size or np.abs(coordinates).max() < period:
        return coordinates
    return np.fmod(coordinates, period)


def _cells(reduced: Array) -> tuple[Cells, Array]:
    """Split into cell and place in it: floor, since a cast mirrors at 0 (E14)."""
    floor = np.floor(reduced)
    return floor.astype(np.int64), reduced - floor


def _block(
    x: Cells,
    y: Cells,
    z: Cells,
    seed: int | None,
    smooth: bool,
    dtype: Dtype = "float64",
) -> Numbers:
    """Give f on lattice lines as [z, y, x]; smoothing uses up one line at each end.

    It is summed in float64, and rounded to the dtype after that.
    """
    columns = x.astype(np.uint64)
    rows = y.astype(np.uint64)[:, np.newaxis]
    layers = z.astype(np.uint64)[:, np.newaxis, np.newaxis]
    planes = max(1, SLAB // (y.size * x.size))
    if not smooth:
        f = np.empty((z.size, y.size, x.size), dtype)
        for first in range(0, z.size, planes):
            part = slice(first, first + planes)
            f[part] = _lattice_random(columns, rows, layers[part], seed)
        return f
    f = np.empty((z.size - 2, y.size - 2, x.size - 2), dtype)
    # Some planes and their neighbours at a time; each step hands two on to the next.
    g: Array = np.empty((min(planes, len(f)) + 2, y.size, x.size))
    g[:2] = _lattice_random(columns, rows, layers[:2], seed)
    for first in range(0, len(f), planes):
        part = f[first : first + planes]
        new = layers[first + 2 : first + 2 + len(part)]
        g[2 : 2 + len(part)] = _lattice_random(columns, rows, new, seed)
        part[...] = _smoothed_inside(g[: 2 + len(part)])
        g[:2] = g[len(part) : len(part) + 2]
    return f


def _smoothed_inside(g: Array) -> Array:
    """Apply the 27 taps along the first three axes, inside the outermost layer.

    All values lie in one row, where a neighbour is a fixed step away: passes without a
    break at each line's end. What a line takes from the next is outside and dropped.
    """
    layers, rows, columns, *others = g.shape
    x = math.prod(others)
    f = _smoothed_row(
        np.ascontiguousarray(g).reshape(-1), (x, x * columns, x * columns * rows)
    )
    whole = np.empty((layers - 2, rows, columns, *others))
    whole.reshape(-1)[: f.size] = f
    return whole[:, :-2, :-2]


def _smoothed_row(row: Array, steps: tuple[int, int, int]) -> Array:
    """Apply the 27 taps in a row where the neighbours along each axis are steps away.

    The result is shorter by twice the sum of the steps. Every tap weighs 3, those of a
    cross 5 more and its centre 100 more: 10 additions in place of 26.
    """
    x, y, z = steps
    line = row[: -2 * x] + row[x:-x]
    line += row[2 * x :]
    box = line
    for step in (y, z):
        total = box[: -2 * step] + box[step:-step]
        total += box[2 * step :]
        box = total
    centre, count = x + y + z, box.size

    def moved(step: int) -> Array:
        return row[centre + step : centre + step + count]

    # A line is three taps of the cross already.
    cross = line[y + z : y + z + count] + moved(-y)
    for step in (y, -z, z):
        cross += moved(step)
    box *= CORNER
    cross *= SIDE - CORNER
    box += cross
    box += np.multiply(moved(0), CENTRE - SIDE, out=cross)
    box /= DENOMINATOR
    return box


def _moved(word: Words, step: int) -> Words:
    """Step to a neighbour, modulo 2^64."""
    return word + np.array([step]).astype(np.uint64)
