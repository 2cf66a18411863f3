"""The noise that document D makes clouds of: Worley noise filled with a finer noise.

Worley noise, turned over, gives the round lumps; a finer noise s fills them by remap.
The lumps end a cell from their points: what is farther, a sample in a thousand, is as
far (the one place where distances are cut at 1, see `refcloud.noise.worley_bound`).
The lower end of the old range is s - 1, at most 0, and the upper is 1: no range is ever
empty (E33), and [0, 1] stays within [0, 1].

What is from where. Document D: the two noises, Worley as the scaffold that smooth noise
populates, and that the scale function of Häggström's thesis combines them; not which of
them is the value and which an end of the range. The thesis, as others quote it, has the
form R(v, f - 1, 1, 0, 1) with v its coarse channel and f the weighted sum of its finer
ones (Perlin-Worley noise, and 5/8, 1/4 and 1/8 of three octaves of Worley noise): where
f is 1 the coarse noise stays v, where f is 0 it becomes (1 + v) / 2. The reading here
is that form with D's noises in it: the scaffold is the coarse one, v = w, and smooth
noise, whose octaves weigh 2^-i over their sum, is the fine one, f = s. That the
scaffold's distance is cut at one cell, and that the finer noise begins with two cells
to each of the scaffold, are choices of refcloud.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.conventions import Array, MayBeNotFinite, Range, Seed, Shape
from refcloud.noise.gradient import gradient
from refcloud.noise.gradient_grid import gradient_grid
from refcloud.noise.lattice import PERIOD
from refcloud.noise.octaves import octave_bound, octave_frame
from refcloud.noise.remap import remap
from refcloud.noise.smooth import smooth, smooth_grid
from refcloud.noise.worley import worley
from refcloud.noise.worley_cells import DType, Reals
from refcloud.noise.worley_grid import worley_grid

Detail = Literal["smooth", "gradient"]
Octaves = Annotated[int, Range(1, 16)]
# The finest of 16 octaves has 2^16 cells to one of the scaffold: 2^30 in all.
Period = Annotated[int, Range(1, 1 << 14)]

FINER = 2  # cells of the finer noise's first octave to one of the scaffold
STEP = 1 << 20  # samples of a grid in one step: tables of 8 MB


@checked
def worley_smooth(
    points: Annotated[Array, Shape("...", "n"), MayBeNotFinite],
    *,
    seed: Seed = 0,
    period: Period | None = None,
    octaves: Octaves = 3,
    detail: Detail = "smooth",
    dtype: DType = "float64",
) -> NDArray[Any]:
    """Give Worley noise as a scaffold, filled with a finer noise, at scattered points.

    Formula: remap(w, s - 1, 1, 0, 1) with w = 1 - min(F1, 1) and s the finer noise

    Parameters
    ----------
    points
        Shape (..., 2) or (..., 3), in cells. NaN or infinity gives NaN.
    seed
        Which pattern.
    period
        After how many cells the pattern repeats, along every axis.
    octaves
        Octaves of the finer noise; its first has two cells to each of the scaffold.
    detail
        The finer noise: "smooth", or the "gradient" noise that document D tried first
        and rejected because it "did not look right" (N32).
    dtype
        Type of the arithmetic and the result: "float64" or "float32".

    Returns
    -------
    Shape (...,), in [0, 1]: 1 at a point of the scaffold.

    Source: document D (N31, N32), after Häggström; E33.

    Examples
    --------
    >>> worley_smooth(np.zeros((4, 3)), seed=7, period=4).shape
    (4,)
    """
    w = worley(points, seed=seed, period=period, normalize="clip", dtype=dtype)
    most = PERIOD if period is None else float(period)
    # Infinity becomes NaN before it is reduced, and what is reduced may be doubled.
    places = np.fmod(np.where(np.isfinite(points), points, np.nan), most) * FINER
    if detail == "smooth":
        finer: dict[str, Any] = {"octaves": octaves, "dtype": dtype}
        s = smooth(places, seed=seed, period=_finer(period), **finer)
    else:
        s = np.zeros(points.shape[:-1], dtype)
        for i in range(octaves):
            own, shift, repeat = _octave(i, seed, period)
            moved = places * 2.0**i + shift[: points.shape[-1]]
            g = gradient(moved, seed=own, period=repeat, dtype=dtype)
            s = s + g * np.dtype(dtype).type(2.0**-i)
        s = _unsigned(s, octaves)
    return _filled(1 - w, s)


@checked
def worley_smooth_grid(
    x: Annotated[Array, Shape("W")],
    y: Annotated[Array, Shape("H")],
    z: Annotated[Array, Shape("D")] | None = None,
    *,
    seed: Seed = 0,
    period: Period | None = None,
    octaves: Octaves = 3,
    detail: Detail = "smooth",
    dtype: DType = "float64",
) -> Reals:
    """Give Worley noise as a scaffold, filled with a finer noise, on a grid.

    Formula: `worley_smooth` at every place of the grid

    Parameters
    ----------
    x, y, z
        Coordinates along each axis, in cells, finite, any order. Without z the noise
        is that of the plane.
    seed
        Which pattern.
    period
        After how many cells the pattern repeats, along every axis.
    octaves
        Octaves of the finer noise; its first has two cells to each of the scaffold.
    detail
        The finer noise: "smooth", or the "gradient" noise that document D tried first
        and rejected because it "did not look right" (N32).
    dtype
        Type of the arithmetic and the result: "float64" or "float32".

    Returns
    -------
    Shape (D, H, W) as [z, y, x], or (H, W) as [y, x].

    Source: document D (N31, N32), after Häggström; E33.

    Examples
    --------
    >>> worley_smooth_grid(np.arange(4) / 2, np.arange(3) / 2, period=2).shape
    (3, 4)
    """
    axes = [a for a in (x, y, z) if a is not None]
    out: Reals = np.empty([len(a) for a in axes[::-1]], dtype)
    # Some planes at a time, across the longest axis: both noises are held some six
    # times until they are one.
    longest = int(np.argmax([len(a) for a in axes]))
    thick = max(1, STEP * len(axes[longest]) // max(out.size, 1))
    for first in range(0, len(axes[longest]), thick):
        part = slice(first, first + thick)
        some = list(axes)
        some[longest] = axes[longest][part]
        where = (slice(None),) * (len(axes) - 1 - longest) + (part,)
        out[where] = _on_grid(some, seed, period, octaves, detail, dtype)
    return out


def _on_grid(
    axes: list[Array],
    seed: int,
    period: int | None,
    octaves: int,
    detail: Detail,
    dtype: DType,
) -> Reals:
    """Give the noise of a grid at once."""
    w = worley_grid(*axes, seed=seed, period=period, normalize="clip", dtype=dtype)
    most = PERIOD if period is None else float(period)
    places = [np.fmod(a, most) * FINER for a in axes]
    if detail == "smooth":
        finer: dict[str, Any] = {"octaves": octaves, "dtype": dtype}
        s = smooth_grid(*places, seed=seed, period=_finer(period), **finer)
    else:
        s = np.zeros(w.shape, dtype)
        for i in range(octaves):
            own, shift, repeat = _octave(i, seed, period)
            moved = [a * 2.0**i + c for a, c in zip(places, shift, strict=False)]
            g = gradient_grid(*moved, seed=own, period=repeat, dtype=dtype)
            s += g * np.dtype(dtype).type(2.0**-i)
        s = _unsigned(s, octaves)
    return _filled(1 - w, s)


def _literal(points: Array, seed: int, period: int | None, octaves: int) -> Array:
    """Give the noise as its formula says it."""
    w = 1.0 - np.minimum(worley(points, seed=seed, period=period), 1.0)
    finer = None if period is None else FINER * period
    s = smooth(points * FINER, seed=seed, period=finer, octaves=octaves)
    one, zero = np.ones(1), np.zeros(1)
    return remap(w, s - 1.0, one, zero, one)


def _finer(period: int | None, octave: int = 0) -> int | None:
    return None if period is None else period * FINER << octave


def _octave(
    octave: int, seed: int, period: int | None
) -> tuple[int, Array, int | None]:
    """Give the seed, the shift and the period of an octave of the finer noise."""
    own, shift = octave_frame(octave, seed=seed)
    return seed if own is None else own, shift, _finer(period, octave)


def _unsigned(total: NDArray[Any], octaves: int) -> NDArray[Any]:
    """Bring a sum of octaves of noise in [-1, 1] to [0, 1]."""
    half = np.asarray(total).dtype.type(0.5)
    return half + total * (half / half.dtype.type(octave_bound(octaves, 0.5)))


def _filled(w: NDArray[Any], s: NDArray[Any]) -> NDArray[Any]:
    """Remap w from [s - 1, 1] to [0, 1]; rounding may leave it by a last bit."""
    one = np.asarray(w).dtype.type(1)
    return np.clip((w - (s - one)) / (one - (s - one)), 0 * one, one)
