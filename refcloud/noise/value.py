"""Value noise h (eq 7): the lattice function f, interpolated along x, then y, then z.

Scattered points look up their eight (or 64) neighbours each. A grid hashes each lattice
point once and interpolates along one axis at a time. Both do the same arithmetic in the
same order, so their values have the same bits.
"""

from __future__ import annotations

import itertools
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, MayBeNotFinite, Seed, Shape
from refcloud.noise.gradient import Period
from refcloud.noise.hashing import _lattice_random, lattice_random
from refcloud.noise.lattice import Cells, _smoothed_inside, smoothed
from refcloud.noise.scattered import (
    Dtype,
    Numbers,
    _bounds,
    _floored,
    _places,
    _Room,
    _scattered,
    _wrapped,
)
from refcloud.noise.value_table import How, Table, _ends, _table
from refcloud.noise.weights import Interpolant, _reach, _taps

Points = Annotated[Array, Shape("...", 3), MayBeNotFinite]

HASHED_CHUNK = 1 << 10  # points that hash their own 64 neighbours at a time: half a MB


@checked
def value(
    points: Points,
    *,
    seed: Seed | None = 0,
    interpolant: Interpolant = "cosine",
    smooth: bool = True,
    period: Period | None = None,
    dtype: Dtype = "float64",
) -> Numbers:
    """Give value noise at scattered points.

    Formula: h(p) = sum over the cell's corners c of w(p - c) f(c)

    Parameters
    ----------
    points
        Shape (..., 3), in lattice cells. Any finite place; NaN or infinity gives NaN.
    seed
        Which pattern. None is the paper's hash, with its periods (E09).
    interpolant
        How lattice values are joined. "cubic" can reach 3.375, "catmull_rom" 1.953.
    smooth
        Whether lattice values are averaged over 27 neighbours first (eq 3).
    period
        After how many cells the pattern repeats along each axis. None is 2^32.
    dtype
        Precision of the interpolation and the result; lattice values are exact.

    Returns
    -------
    Shape (...,), in [-1, 1] for the two-point interpolants.

    Source: paper M, eq 7 (N13); E12, E14.

    Examples
    --------
    >>> value(np.zeros((4, 2, 3)), seed=7).shape
    (4, 2)
    """
    how = How(seed, interpolant, smooth, period, dtype)
    table, room = _table_of(points, how), _Room()
    return _scattered(
        points,
        lambda axes: _value(axes, how, table, room),
        dtype,
        period,
        inside=bool(table),
    )


def _literal(
    points: Array, seed: int | None, interpolant: Interpolant, smooth: bool
) -> Array:
    """Give value noise as its formula says it: corner by corner, whole at once."""
    cells = np.floor(points)
    weights, offsets = _taps(interpolant, points - cells)
    total: Array = np.zeros(points.shape[:-1])
    for corner in itertools.product(range(len(offsets)), repeat=3):
        weight = np.prod([weights[k][..., n] for n, k in enumerate(corner)], axis=0)
        steps = np.array([offsets[k] for k in corner])
        lattice = np.moveaxis((cells + steps).astype(np.int64), -1, 0)
        f = smoothed if smooth else lattice_random
        total += weight * f(*lattice, seed=seed)
    return total


def _value(
    columns: Array, how: How, table: Table | None = None, room: _Room | None = None
) -> Numbers:
    """Give h at finite points, coordinates in rows, shape (3, n).

    1. Find the cell of each point, and the weights of its neighbours along each axis.
    2. Look up the lattice values around each point, one layer of them after the other.
    3. Interpolate each layer along x, then y, and add it with its weight along z.

    With two neighbours per axis: 8 look-ups at 1.3 to 2 ns, as they miss the nearest
    cache, and some 70 passes at 0.1 ns in float32: 23 ns, besides what the table takes.
    The next call with the same room overwrites the result.
    """
    room = room or _Room()
    cells = _floored(columns, room)
    if table is None:
        table = _table(_ends(cells), cells.shape[1], how)
    if table is None:
        # The points lie far apart: every one hashes its own neighbours.
        layers = iter(_hashed(cells.astype(np.int64), how))
    else:
        layers = table.layers(cells, room)
    places = _places(columns, cells, how.dtype, room)
    weights, _ = _taps(how.interpolant, places)
    total = room.take("total", places.shape[1:], how.dtype)
    for number, (layer, weight) in enumerate(zip(layers, weights, strict=True)):
        plane = _summed(_summed(layer, 1, weights, 0), 0, weights, 1)
        if number:
            plane *= weight[2]
            total += plane
        else:
            np.multiply(plane, weight[2], out=total)
    return total


def _table_of(points: Array, how: How) -> Table | None:
    """Hash around all points once, if they lie close together."""
    # A cube around all is quick to find; a tight box is looked for where that is large.
    tables = (
        _table(ends, points.size // 3, how) for ends in _bounds(points, how.period)
    )
    return next((table for table in tables if table is not None), None)


def _summed(
    values: Numbers, of: int, weights: tuple[Numbers, ...], axis: int
) -> Numbers:
    """Sum the neighbours along an axis of values, weighted, in place of the first."""
    first, *others = values.swapaxes(0, of)
    first *= weights[0][axis]
    for other, weight in zip(others, weights[1:], strict=True):
        other *= weight[axis]
        first += other
    return first


def _hashed(cells: Cells, how: How) -> Numbers:
    """Hash f at each point's neighbours, shape (K, K, K, n) as [z, y, x, point]."""
    reach = _reach(how.interpolant)
    n, taps, halo = cells.shape[1], len(reach), int(how.smooth)
    around = np.arange(reach[0] - halo, reach[-1] + halo + 1)[:, np.newaxis]
    f = np.empty((taps, taps, taps, n), how.dtype)
    for first in range(0, n, HASHED_CHUNK):
        part = slice(first, first + HASHED_CHUNK)
        lattice = (_wrapped(c[part] + around, how.period) for c in cells)
        cx, cy, cz = (c.astype(np.uint64) for c in lattice)
        g = _lattice_random(
            cx, cy[:, np.newaxis], cz[:, np.newaxis, np.newaxis], how.seed
        )
        f[..., part] = _smoothed_inside(g) if how.smooth else g
    return f
