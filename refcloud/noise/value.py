"""Value noise h (eq 7): the lattice function f, interpolated along x, then y, then z.

Scattered points look up their eight (or 64) neighbours each. A grid hashes each lattice
point once and interpolates along one axis at a time. Both do the same arithmetic in the
same order, so their values have the same bits.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, MayBeNotFinite, Seed, Shape
from refcloud.noise.gradient import Period
from refcloud.noise.hashing import _lattice_random
from refcloud.noise.lattice import Cells, _block, _smoothed_inside
from refcloud.noise.scattered import (
    PERIOD,
    Dtype,
    Numbers,
    _scattered,
    _split,
    _wrapped,
)
from refcloud.noise.weights import Interpolant, _taps

Points = Annotated[Array, Shape("...", 3), MayBeNotFinite]

HASHED_CHUNK = 1 << 10  # points that hash their own 64 neighbours at a time: half a MB
MOST_LATTICE = 1 << 21  # lattice values at a time: 16 MB, held some three times


@dataclass(frozen=True)
class How:
    """How value noise is made."""

    seed: int | None
    interpolant: Interpolant
    smooth: bool
    period: int | None = None
    dtype: Dtype = "float64"


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
    box = _box_of(points, how)
    return _scattered(points, lambda columns: _value(columns, how, box), dtype, period)


@dataclass(frozen=True)
class Box:
    """The lattice values of a box of cells, in one row.

    Attributes
    ----------
    low
        The lowest cell's coordinates x, y and z.
    counts
        How many lattice values lie along x, y and z.
    values
        f as [z, y, x], flat.
    """

    low: list[int]
    counts: list[int]
    values: Numbers


def _value(columns: Array, how: How, box: Box | None = None) -> Numbers:
    """Give h at finite points, coordinates in rows, shape (3, n)."""
    # Find the cell of each point, and the weights of its neighbours along each axis.
    cells, places = _split(columns, how.dtype)
    wx, wy, wz = (_taps(how.interpolant, t)[0] for t in places)
    offsets = np.array(_taps(how.interpolant, places[0])[1])
    # Look up the lattice values around each point, [z, y, x, point].
    f = _neighbours(cells, offsets, how, box)
    # Interpolate along x, then y, then z.
    f = _weighted(wx, [f[:, :, k] for k in range(len(offsets))])
    f = _weighted(wy, [f[:, k] for k in range(len(offsets))])
    return _weighted(wz, list(f))


def _weighted(weights: Iterable[Array], values: Iterable[Array]) -> Array:
    """Sum weight times value, from the first tap to the last."""
    first, *others = (w * v for w, v in zip(weights, values, strict=True))
    for other in others:
        first += other
    return first


def _box_of(points: Array, how: How) -> Box | None:
    """Hash the box of all points once, if they lie close together."""
    wrap = PERIOD if how.period is None else float(how.period)
    if not points.size:
        return None
    low, high = points.min(), points.max()
    if not max(-low, high) < wrap:  # not so where any is NaN
        return None
    # A cube around all is quick to find; a tight box is looked for where that is large.
    count = points.size // 3
    cube = np.floor([[low, high]] * 3).astype(np.int64)
    if box := _box(cube, count, how):
        return box
    ends = [(column.min(), column.max()) for column in points.reshape(-1, 3).T]
    return _box(np.floor(ends).astype(np.int64), count, how)


def _box(cells: Cells, points: int, how: How) -> Box | None:
    """Hash the box around cells (3, n), if that is less work than each point's own."""
    reach = np.array(_taps(how.interpolant, np.zeros(1))[1])
    halo = int(how.smooth)
    lows = [int(c.min()) + int(reach[0]) for c in cells]
    counts = [
        int(c.max()) + int(reach[-1]) + 1 - low
        for c, low in zip(cells, lows, strict=True)
    ]
    size = math.prod(count + 2 * halo for count in counts)
    if 2 * size > points * (len(reach) + 2 * halo) ** 3 or size > MOST_LATTICE:
        return None
    lines = (
        _wrapped(np.arange(low - halo, low + count + halo), how.period)
        for low, count in zip(lows, counts, strict=True)
    )
    table = _block(*lines, seed=how.seed, smooth=how.smooth)
    values = table.astype(how.dtype, copy=False).reshape(-1)
    return Box([low - int(reach[0]) for low in lows], counts, values)


def _neighbours(cells: Cells, offsets: Cells, how: How, box: Box | None) -> Numbers:
    """Give f at each point's neighbours, shape (K, K, K, n) as [z, y, x, point]."""
    n, taps, halo = cells.shape[1], len(offsets), int(how.smooth)
    box = box or _box(cells, n, how)
    if box is not None:
        # The points lie close together: look up.
        ix, iy, iz = (c - low for c, low in zip(cells, box.low, strict=True))
        start = (iz * box.counts[1] + iy) * box.counts[0] + ix
        step = offsets - offsets[0]
        f = np.empty((taps, taps, taps, n), box.values.dtype)
        for k, j, i in itertools.product(range(taps), repeat=3):
            ahead = (step[k] * box.counts[1] + step[j]) * box.counts[0] + step[i]
            # A view that starts further on spares adding to every index.
            np.take(box.values[ahead:], start, out=f[k, j, i], mode="clip")
        return f
    # They lie far apart: every point hashes its own neighbours.
    around = np.arange(offsets[0] - halo, offsets[-1] + halo + 1)[:, np.newaxis]
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
