"""Value noise on a grid: each lattice point hashed once, one axis after another."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Seed, Shape
from refcloud.noise.gradient import Period
from refcloud.noise.hashing import lattice_random
from refcloud.noise.lattice import SLAB, AxisTaps, Cells, _axis, _block, smoothed
from refcloud.noise.scattered import Dtype, Numbers, _wrapped
from refcloud.noise.value_table import MOST_LATTICE, How
from refcloud.noise.weights import Interpolant, _taps

Axes = tuple[Array, Array, Array]  # x, y and z


@checked
def value_grid(
    x: Annotated[Array, Shape("W")],
    y: Annotated[Array, Shape("H")],
    z: Annotated[Array, Shape("D")],
    *,
    seed: Seed | None = 0,
    interpolant: Interpolant = "cosine",
    smooth: bool = True,
    period: Period | None = None,
    dtype: Dtype = "float64",
) -> Numbers:
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
    period
        After how many cells the pattern repeats along each axis. None is 2^32.
    dtype
        Precision of the interpolation and the result; lattice values are exact.

    Returns
    -------
    Shape (D, H, W) as [z, y, x].

    Source: paper M, eq 7 (N13); E12, E14.

    Examples
    --------
    >>> value_grid([0.5, 0.75], [1e9, -3.0, 0.0], [0.0], seed=7).shape
    (1, 3, 2)
    """
    out = np.zeros((z.size, y.size, x.size), dtype)
    how = How(seed, interpolant, smooth, period, dtype)
    _add_grid(out, 1.0, (x, y, z), how)
    return out


def _literal(
    axes: Axes, seed: int | None, interpolant: Interpolant, smooth: bool
) -> Array:
    """Give value noise as one dense matrix of weights along each axis."""
    matrices, lines = [], []
    for axis in axes:
        cells = np.floor(axis).astype(np.int64)
        weights, offsets = _taps(interpolant, axis - cells)
        line = np.unique(np.add.outer(offsets, cells))
        dense: Array = np.zeros((axis.size, line.size))
        for weight, offset in zip(weights, offsets, strict=True):
            dense[np.arange(axis.size), np.searchsorted(line, cells + offset)] = weight
        matrices.append(dense)
        lines.append(line)
    a, b, c = lines
    f = (smoothed if smooth else lattice_random)(
        a, b[:, None], c[:, None, None], seed=seed
    )
    return np.einsum("ia,jb,kc,cba->kji", *matrices, f, optimize=True)


def _add_grid(
    out: Numbers, amplitude: float, axes: Axes, how: How, absolute: bool = False
) -> None:
    """Add amplitude times h on a grid, or times |h|, to out."""
    if out.size:
        taps = []
        for c in axes:
            places = c if how.period is None else np.fmod(c, how.period)
            found = _axis(places, how.interpolant, how.smooth)
            weights = found.weights.astype(how.dtype, copy=False)
            taps.append(AxisTaps(found.lines, found.index, weights))
        _add_part(out, amplitude, taps, how, absolute)


def _add_part(
    out: Numbers, amplitude: float, axes: list[AxisTaps], how: How, absolute: bool
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
            fewer[2 - longest] = axes[2 - longest].part(part, how.smooth)
            where = (slice(None),) * longest + (part,)
            _add_part(out[where], amplitude, fewer, how, absolute)
        return
    lines = (_wrapped(axis.lines, how.period) for axis in axes)
    f = _block(*lines, seed=how.seed, smooth=how.smooth, dtype=how.dtype)
    # Interpolate along x and y, where there are still few values.
    f = _contracted(f, x.weights, x.index, axis=2)
    f = _contracted(f, y.weights, y.index, axis=1)
    # Interpolate along z in slabs that stay in the cache.
    planes = max(1, SLAB // (out.shape[1] * out.shape[2]))
    for first in range(0, out.shape[0], planes):
        part = slice(first, first + planes)
        slab = _contracted(f, z.weights[:, part], z.index[:, part], axis=0)
        if absolute:
            np.abs(slab, out=slab)
        slab *= amplitude
        out[part] += slab


def _contracted(f: Array, weights: Array, index: Cells, axis: int) -> Array:
    """Replace an axis of lattice lines by an axis of samples."""
    along = (-1,) + (1,) * (2 - axis)
    return _weighted(
        (w.reshape(along) for w in weights),
        (np.take(f, i, axis=axis, mode="clip") for i in index),
    )


def _weighted(weights: Iterable[Array], values: Iterable[Array]) -> Array:
    """Sum weight times value, from the first tap to the last."""
    first, *others = (w * v for w, v in zip(weights, values, strict=True))
    for other in others:
        first += other
    return first
