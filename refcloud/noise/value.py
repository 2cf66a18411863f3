"""Value noise h (eq 7): the lattice function f, interpolated along x, then y, then z.

Scattered points look up their eight (or 64) neighbours each. A grid hashes each lattice
point once and interpolates along one axis at a time. Both do the same arithmetic in the
same order, so their values have the same bits.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, MayBeNotFinite, Seed, Shape
from refcloud.noise.hashing import _lattice_random
from refcloud.noise.lattice import (
    SLAB,
    AxisTaps,
    Cells,
    _axis,
    _block,
    _cells,
    _reduced,
    _smoothed_inside,
)
from refcloud.noise.weights import Interpolant, _taps

Points = Annotated[Array, Shape("...", 3), MayBeNotFinite]

Axes = tuple[Array, Array, Array]  # x, y and z, scattered (n,) or of a grid

CHUNK = 1 << 15  # scattered points at a time: temporaries of a few MB
HASHED_CHUNK = 1 << 10  # of them, where each hashes its own 64 neighbours: half a MB
MOST_LATTICE = 1 << 21  # lattice values at a time: 16 MB, held some three times


@checked
def value(
    points: Points,
    *,
    seed: Seed | None = 0,
    interpolant: Interpolant = "cosine",
    smooth: bool = True,
) -> Array:
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

    Returns
    -------
    Shape (...,), in [-1, 1] for the two-point interpolants.

    Source: paper M, eq 7 (N13); E12, E14.

    Examples
    --------
    >>> value(np.zeros((4, 2, 3)), seed=7).shape
    (4, 2)
    """
    return _in_chunks(points, lambda *axes: _value(axes, seed, interpolant, smooth))


@checked
def value_grid(
    x: Annotated[Array, Shape("W")],
    y: Annotated[Array, Shape("H")],
    z: Annotated[Array, Shape("D")],
    *,
    seed: Seed | None = 0,
    interpolant: Interpolant = "cosine",
    smooth: bool = True,
) -> Array:
    """Give value noise on a grid: `value` at every (x, y, z), many times faster.

    Formula: h[k, j, i] = sum over c of wz[k, c] sum over b of wy[j, b] sum over a of
    wx[i, a] f(a, b, c)

    Parameters
    ----------
    x, y, z
        Coordinates along each axis, in lattice cells. Any order, any spacing, finite.
    seed
        Which pattern. None is the paper's hash, with its periods (E09).
    interpolant
        How lattice values are joined. "cubic" can reach 3.375, "catmull_rom" 1.953.
    smooth
        Whether lattice values are averaged over 27 neighbours first (eq 3).

    Returns
    -------
    Shape (D, H, W) as [z, y, x].

    Source: paper M, eq 7 (N13); E12, E14.

    Examples
    --------
    >>> value_grid([0.5, 0.75], [1e9, -3.0, 0.0], [0.0], seed=7).shape
    (1, 3, 2)
    """
    out: Array = np.zeros((z.size, y.size, x.size))
    _add_grid(out, 1.0, (x, y, z), seed, interpolant, smooth)
    return out


def _value(
    axes: Axes, seed: int | None, interpolant: Interpolant, smooth: bool
) -> Array:
    """Give h at finite points, one coordinate array per axis, shape (n,)."""
    # Find the cell of each point, and the weights of its neighbours along each axis.
    cells, places = zip(*(_cells(_reduced(c)) for c in axes), strict=True)
    wx, wy, wz = (_taps(interpolant, t)[0] for t in places)
    offsets = np.array(_taps(interpolant, places[0])[1])
    # Look up the lattice values around each point, [z, y, x, point].
    f = _neighbours(cells, offsets, seed, smooth)
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


def _neighbours(
    cells: tuple[Cells, ...], offsets: Cells, seed: int | None, smooth: bool
) -> Array:
    """Give f at each point's neighbours, shape (K, K, K, n) as [z, y, x, point]."""
    n, taps, halo = cells[0].size, len(offsets), int(smooth)
    lows = [int(c.min()) + int(offsets[0]) for c in cells]
    counts = [
        int(c.max()) + int(offsets[-1]) + 1 - low
        for c, low in zip(cells, lows, strict=True)
    ]
    box = math.prod(count + 2 * halo for count in counts)
    if 2 * box <= n * (taps + 2 * halo) ** 3 and box <= MOST_LATTICE:
        # The points lie close together: hash their box once, and look up.
        table = _block(
            *(
                np.arange(low - halo, low + count + halo)
                for low, count in zip(lows, counts, strict=True)
            ),
            seed=seed,
            smooth=smooth,
        )
        ix, iy, iz = (c - low for c, low in zip(cells, lows, strict=True))
        start = (iz * counts[1] + iy) * counts[0] + ix
        step = (offsets[:, None, None] * counts[1] + offsets[:, None]) * counts[0]
        return table.reshape(-1)[(step + offsets)[..., np.newaxis] + start]
    # They lie far apart: every point hashes its own neighbours.
    around = np.arange(offsets[0] - halo, offsets[-1] + halo + 1)[:, np.newaxis]
    f = np.empty((taps, taps, taps, n))
    for first in range(0, n, HASHED_CHUNK):
        part = slice(first, first + HASHED_CHUNK)
        cx, cy, cz = ((c[part] + around).astype(np.uint64) for c in cells)
        g = _lattice_random(cx, cy[:, np.newaxis], cz[:, np.newaxis, np.newaxis], seed)
        f[..., part] = _smoothed_inside(g) if smooth else g
    return f


def _in_chunks(points: Array, noise: Callable[..., Array]) -> Array:
    """Apply noise to the finite points, some at a time; the others give NaN."""
    flat = points.reshape(-1, 3)
    out = np.full(len(flat), np.nan)
    for first in range(0, len(flat), CHUNK):
        chunk = flat[first : first + CHUNK]
        finite = np.isfinite(chunk).all(axis=1)
        if finite.any():
            x, y, z = chunk[finite].T.copy()
            out[first : first + CHUNK][finite] = noise(x, y, z)
    return out.reshape(points.shape[:-1])[()]


def _add_grid(
    out: Array,
    amplitude: float,
    axes: Axes,
    seed: int | None,
    interpolant: Interpolant,
    smooth: bool,
) -> None:
    """Add amplitude times h on a grid to out."""
    if out.size:
        taps = [_axis(c, interpolant, smooth) for c in axes]
        _add_part(out, amplitude, taps, seed, smooth)


def _add_part(
    out: Array, amplitude: float, axes: list[AxisTaps], seed: int | None, smooth: bool
) -> None:
    """Add one part of a grid, halved until its lattice is small enough."""
    x, y, z = axes
    lattice = x.lines.size * y.lines.size * z.lines.size
    contracted = z.lines.size * out.shape[1] * out.shape[2]
    if max(lattice, contracted) > MOST_LATTICE and out.size > 1:
        longest = int(np.argmax(out.shape))  # of [z, y, x]
        half = out.shape[longest] // 2
        for part in (slice(None, half), slice(half, None)):
            fewer = list(axes)
            fewer[2 - longest] = axes[2 - longest].part(part, smooth)
            where = (slice(None),) * longest + (part,)
            _add_part(out[where], amplitude, fewer, seed, smooth)
        return
    f = _block(x.lines, y.lines, z.lines, seed, smooth)
    # Interpolate along x and y, where there are still few values.
    f = _contracted(f, x.weights, x.index, axis=2)
    f = _contracted(f, y.weights, y.index, axis=1)
    # Interpolate along z in slabs that stay in the cache.
    planes = max(1, SLAB // (out.shape[1] * out.shape[2]))
    for first in range(0, out.shape[0], planes):
        part = slice(first, first + planes)
        slab = _contracted(f, z.weights[:, part], z.index[:, part], axis=0)
        slab *= amplitude
        out[part] += slab


def _contracted(f: Array, weights: Array, index: Cells, axis: int) -> Array:
    """Replace an axis of lattice lines by an axis of samples."""
    along = (-1,) + (1,) * (2 - axis)
    return _weighted(
        (w.reshape(along) for w in weights),
        (np.take(f, i, axis=axis, mode="clip") for i in index),
    )
