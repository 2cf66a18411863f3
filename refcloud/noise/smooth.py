"""Smooth noise: random numbers of the lattice, joined by straight lines.

Bilinear in the plane, trilinear in space; document D says "trilinear in 2D" (E33). Its
source (Vandevenne's page) joins a lattice point to its left neighbour where this joins
it to its right one: the same noise, one cell along. It calls the sum of octaves
"turbulence", though no absolute value is taken anywhere.
"""

from __future__ import annotations

import itertools
import math
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked, complaint
from refcloud.conventions import Array, MayBeNotFinite, Range, Seed, Shape
from refcloud.noise.hashing import uniform
from refcloud.noise.lattice import PERIOD, Cells
from refcloud.noise.octaves import octave_frame
from refcloud.noise.worley_cells import DType, Reals, _split, _wrapped

Octaves = Annotated[int, Range(1, 32)]
# The finest of 32 octaves repeats after 2^62 of its cells at the most.
Period = Annotated[int, Range(1, 2**31)]
Origins = Literal["own", "shared"]
Scale = Literal["bound", "none", "source"]

CHUNK = 1 << 13  # scattered points at a time: each hashes its own corners
MOST_LATTICE = 1 << 20  # lattice values at a time: 8 MB, held some three times
SOURCE_SCALE = 128.0  # the source shows 128 times its sum, which stays below 2


@checked
def smooth(
    points: Annotated[Array, Shape("...", "n"), MayBeNotFinite],
    *,
    seed: Seed = 0,
    period: Period | None = None,
    octaves: Octaves = 1,
    normalize: Scale = "bound",
    origins: Origins = "own",
    dtype: DType = "float64",
) -> NDArray[Any]:
    """Give smooth noise, or a sum of its octaves, at scattered points.

    Formula: sum over i < Z of lerp(lerp(...)) at 2^i p, times 2^-i

    Parameters
    ----------
    points
        Shape (..., 2) or (..., 3), in cells of the first octave. NaN or infinity gives
        NaN.
    seed
        Which pattern.
    period
        After how many cells the pattern repeats, along every axis. None does not
        repeat (but at 2^32, as all noise here).
    octaves
        How many octaves are summed (Z): in the source's pixels, sizes 2^(Z-1) to 1.
    normalize
        What becomes of the sum. "bound" divides by its largest possible value, "none"
        leaves it, "source" multiplies it by 128.
    origins
        Where octaves begin. "own" moves and seeds each; "shared" lets all read one
        lattice from one origin, as the source does, and they coincide there.
    dtype
        Type of the result: "float64" or "float32".

    Returns
    -------
    Shape (...,), in [0, 1]; "none" up to 2 - 2^(1-Z), "source" 128 times that.

    Raises
    ------
    ValueError
        The points have neither two nor three coordinates.

    Source: document D (N30), after Vandevenne; E33.

    Examples
    --------
    >>> smooth(np.zeros((4, 5, 2)), seed=7, octaves=3).shape
    (4, 5)
    """
    n = points.shape[-1]
    if n not in (2, 3):
        raise ValueError(
            complaint("points", "two or three coordinates", f"shape {points.shape}")
        )
    flat = points.reshape(-1, n)
    out = np.full(len(flat), np.nan)
    finite = np.asarray(np.isfinite(flat).all(axis=1))
    for first in range(0, len(flat), CHUNK):
        chosen = finite[first : first + CHUNK]
        axes = list(flat[first : first + CHUNK][chosen].T)
        if axes[0].size:
            total = np.zeros(axes[0].size)
            for i in range(octaves):
                own, placed = _placed(axes, i, seed, period, origins)
                repeat = None if period is None else period << i
                total += _pointwise(placed, own, repeat) * 2.0**-i
            out[first : first + CHUNK][chosen] = total
    out = _finished(out, octaves, normalize).astype(dtype, copy=False)
    return out.reshape(points.shape[:-1])[()]


@checked
def smooth_grid(
    x: Annotated[Array, Shape("W")],
    y: Annotated[Array, Shape("H")],
    z: Annotated[Array, Shape("D")] | None = None,
    *,
    seed: Seed = 0,
    period: Period | None = None,
    octaves: Octaves = 1,
    normalize: Scale = "bound",
    origins: Origins = "own",
    dtype: DType = "float64",
) -> Reals:
    """Give smooth noise on a grid: `smooth` at every place, many times faster.

    Formula: lines of the lattice joined along x, then y, then z, each octave

    Parameters
    ----------
    x, y, z
        Coordinates along each axis, in cells of the first octave, finite, any order.
        Without z the noise is that of the plane.
    seed
        Which pattern.
    period
        After how many cells the pattern repeats, along every axis. None does not
        repeat (but at 2^32, as all noise here).
    octaves
        How many octaves are summed.
    normalize
        What becomes of the sum. "bound" divides by its largest possible value, "none"
        leaves it, "source" multiplies it by 128.
    origins
        Where octaves begin. "own" moves and seeds each; "shared" lets all read one
        lattice from one origin, as the source does, and they coincide there.
    dtype
        Type of the result: "float64" or "float32".

    Returns
    -------
    Shape (D, H, W) as [z, y, x], or (H, W) as [y, x].

    Source: document D (N30), after Vandevenne; E33.

    Examples
    --------
    >>> smooth_grid(np.arange(4) / 2, np.arange(3) / 2, seed=7, period=2).shape
    (3, 4)
    """
    axes = [x, y] if z is None else [x, y, z]
    out: Array = np.zeros(tuple(axis.size for axis in reversed(axes)))
    if out.size:
        for i in range(octaves):
            own, placed = _placed(axes, i, seed, period, origins)
            repeat = None if period is None else period << i
            _add_grid(out, 2.0**-i, placed, own, repeat)
    return _finished(out, octaves, normalize).astype(dtype, copy=False)


def _literal(points: Array, seed: int, octaves: int) -> Array:
    """Give smooth noise as its formula says it: corner by corner, octave by octave."""
    total: Array = np.zeros(points.shape[:-1])
    for i in range(octaves):
        own, shift = octave_frame(i, seed=seed)
        places = points * 2.0**i + shift[: points.shape[-1]]
        cells = np.floor(places)
        for corner in itertools.product((0, 1), repeat=points.shape[-1]):
            weight = np.prod(1.0 - np.abs(places - cells - corner), axis=-1)
            lattice = np.moveaxis((cells + corner).astype(np.int64), -1, 0)
            words = np.mod(lattice, int(PERIOD))
            total += 2.0**-i * weight * uniform(*words, seed=own or 0)
    return total / (2.0 - 2.0 ** (1 - octaves))


def _placed(
    axes: list[Array], octave: int, seed: int, period: int | None, origins: str
) -> tuple[int, list[Array]]:
    """Give an octave's seed, and coordinates in its cells, reduced to stay exact."""
    most = float(PERIOD if period is None else period)
    own, shift = (
        octave_frame(octave, seed=seed) if origins == "own" else (seed, np.zeros(3))
    )
    placed = [
        np.fmod(axis, most) * 2.0**octave + s
        for axis, s in zip(axes, shift, strict=False)
    ]
    return seed if own is None else own, placed


def _pointwise(axes: list[Array], seed: int, period: int | None) -> Array:
    """Give one octave at finite points, one coordinate array per axis."""
    cells, t = zip(*(_split(axis, period) for axis in axes), strict=True)
    ends = np.array([0, 1])
    n = len(cells)
    words = [
        _wrapped(c + ends.reshape(-1, *(1,) * (axis + 1)), period).astype(np.uint64)
        for axis, c in enumerate(cells)
    ]
    f = uniform(*words, seed=seed).reshape((2,) * n + (-1,))
    # The first axis of f is the last of space: join x first, then y, then z.
    for axis in range(n):
        last = n - 1 - axis
        low, high = np.take(f, 0, axis=last), np.take(f, 1, axis=last)
        f = low * (1.0 - t[axis]) + high * t[axis]
    return f


def _add_grid(
    out: Array, amplitude: float, axes: list[Array], seed: int, period: int | None
) -> None:
    """Add amplitude times one octave on a grid, halved until its lattice is small."""
    ends = [_ends(axis, period) for axis in axes]
    if math.prod(len(lines) for lines, _, _ in ends) > MOST_LATTICE and out.size > 1:
        longest = int(np.argmax(out.shape))
        axis = len(axes) - 1 - longest
        half = out.shape[longest] // 2
        for part in (slice(None, half), slice(half, None)):
            fewer = list(axes)
            fewer[axis] = axes[axis][part]
            where = (slice(None),) * longest + (part,)
            _add_grid(out[where], amplitude, fewer, seed, period)
        return
    words = [
        lines.reshape(-1, *(1,) * axis).astype(np.uint64)
        for axis, (lines, _, _) in enumerate(ends)
    ]
    f = uniform(*words, seed=seed)
    for axis, (_, index, t) in enumerate(ends):
        last = len(axes) - 1 - axis
        along = t.reshape(-1, *(1,) * axis)
        low, high = (np.take(f, i, axis=last) for i in index)
        f = low * (1.0 - along) + high * along
    f *= amplitude
    out += f


def _ends(axis: Array, period: int | None) -> tuple[Cells, Cells, Array]:
    """Give lattice lines, each once; each sample's two of them; where between them."""
    cells, t = _split(axis, period)
    wanted = _wrapped(cells + np.array([[0], [1]]), period)
    lines, index = np.unique(wanted, return_inverse=True)
    return lines, index.reshape(wanted.shape), t


def _finished(total: Array, octaves: int, normalize: Scale) -> Array:
    if normalize == "source":
        return total * SOURCE_SCALE
    if normalize == "none":
        return total
    # Rounding may pass the bound by a last bit.
    return np.minimum(total / (2.0 - 2.0 ** (1 - octaves)), 1.0)
