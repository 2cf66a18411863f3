"""Value noise h (eq 7): the lattice function f, interpolated along x, then y, then z.

Scattered points look up their eight (or 64) neighbours each. A grid hashes each lattice
point once and interpolates along one axis at a time. Both do the same arithmetic in the
same order, so their values have the same bits.
"""

from __future__ import annotations

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
    Dtype,
    Numbers,
    _bounds,
    _floored,
    _index,
    _scattered,
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
    return _scattered(
        points, lambda axes: _value(axes, how, box), dtype, period, inside=bool(box)
    )


@dataclass(frozen=True)
class Box:
    """The lattice values of a box of cells.

    Attributes
    ----------
    low
        The lowest cell's coordinates x, y and z.
    counts
        How many lattice values lie along x, y and z.
    pairs
        f and its neighbour along x, for [z, y, x] in one row: shape (L, 2).
    """

    low: list[int]
    counts: list[int]
    pairs: Numbers

    def around(self, cells: Array, taps: int) -> Numbers:
        """Look up f around whole numbers (3, n): [z, y, x / 2, point, 2]."""
        x, y, _ = self.counts
        start = _index(cells, self.low, np.array([1, x, x * y]))
        f = np.empty((taps, taps, taps // 2, start.size, 2), self.pairs.dtype)
        for k, j, i in np.ndindex(f.shape[:3]):
            # A view that starts further on spares adding to every index.
            ahead = self.pairs[(k * y + j) * x + 2 * i :]
            np.take(ahead, start, axis=0, out=f[k, j, i], mode="clip")
        return f


def _value(columns: Array, how: How, box: Box | None = None) -> Numbers:
    """Give h at finite points, coordinates in rows, shape (3, n).

    1. Find the cell of each point, and the weights of its neighbours along each axis.
    2. Look up the lattice values around each point, two along x at a time.
    3. Interpolate along x, then y, then z.

    With two neighbours per axis: 4 look-ups at 2.5 ns, as they miss the nearest cache,
    and some 50 passes at 0.15 to 0.4 ns: 20 ns, besides what the box takes to fill.
    """
    cells, places = _floored(columns, how.dtype)
    weights, around = _taps(how.interpolant, places)
    offsets = np.array(around)
    wx, wy, wz = ([w[k] for w in weights] for k in range(3))
    box = box or _box(cells.astype(np.int64), cells.shape[1], how)
    if box is None:
        # The points lie far apart: every one hashes its own neighbours.
        f = _hashed(cells.astype(np.int64), offsets, how)
        f = _weighted(wx, [f[:, :, k] for k in range(len(offsets))])
    else:
        f = box.around(cells, len(offsets))
        both = np.empty(f.shape[2:], f.dtype)
        for k, weight in enumerate(wx):
            both[k // 2, :, k % 2] = weight
        f *= both
        first, *others = (f[:, :, k, :, end] for k, end in np.ndindex(f.shape[2], 2))
        f = first + others[0]
        for other in others[1:]:
            f += other
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
    # A cube around all is quick to find; a tight box is looked for where that is large.
    boxes = (
        _box(cells, points.size // 3, how) for cells in _bounds(points, how.period)
    )
    return next((box for box in boxes if box is not None), None)


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
    pairs = np.empty((table.size, 2), how.dtype)
    pairs[:, 0] = table.reshape(-1)
    pairs[:-1, 1] = pairs[1:, 0]
    pairs[-1, 1] = 0.0  # no point's
    return Box([low - int(reach[0]) for low in lows], counts, pairs)


def _hashed(cells: Cells, offsets: Cells, how: How) -> Numbers:
    """Hash f at each point's neighbours, shape (K, K, K, n) as [z, y, x, point]."""
    n, taps, halo = cells.shape[1], len(offsets), int(how.smooth)
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
