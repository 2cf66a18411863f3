"""The sum of octaves (eq 1) of value noise, at points and on a grid.

Each octave is value noise at twice the frequency and `persistence` times the amplitude.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Positive, Seed, Shape, Skipped
from refcloud.noise.gradient import Period
from refcloud.noise.lattice import PERIOD, _reduced
from refcloud.noise.octaves import (
    Normalize,
    Octaves,
    Persistence,
    _finished,
    _refuse_long,
    octave_bound,
    octave_frame,
)
from refcloud.noise.scattered import Dtype, Numbers, _scattered
from refcloud.noise.value import Points, _value, value
from refcloud.noise.value_grid import Axes, _add_grid
from refcloud.noise.value_table import How
from refcloud.noise.weights import PEAKS, Interpolant


@checked
def octave_sum(
    points: Points,
    *,
    seed: Seed | None = 0,
    octaves: Octaves = 4,
    persistence: Persistence = 0.5,
    interpolant: Interpolant = "cosine",
    normalize: Normalize = "clip",
    absolute: bool = True,
    period: Period | None = None,
    dtype: Dtype = "float64",
) -> Numbers:
    """Give the paper's fractal noise at scattered points.

    Formula: |sum of s^i h(2^i p) for i < Z|

    Parameters
    ----------
    points
        Shape (..., 3), in cells of the first octave. NaN or infinity gives NaN.
    seed
        Which pattern. None is the paper's hash, every octave with the same origin.
    octaves
        How many octaves are summed (Z).
    persistence
        Each octave's amplitude relative to the one before (s).
    interpolant
        How lattice values are joined.
    normalize
        How the sum is brought to [0, 1] or [-1, 1]. "clip" cuts what is outside,
        "bound" divides by the largest possible value, "none" leaves it (E11).
    absolute
        Whether the sum's absolute value is taken, as the paper does.
    period
        After how many cells of the first octave the sum repeats along each axis. None
        is 2^32.
    dtype
        Precision of the interpolation and the result; lattice values are exact.

    Returns
    -------
    Shape (...,), in [0, 1], or [-1, 1] where not absolute; "none" reaches the bound.

    Raises
    ------
    ValueError
        The finest octave's period is above 2^31.

    Source: paper M, eq 1 (N15); E11.

    Examples
    --------
    >>> octave_sum(np.zeros((5, 3)), seed=7).shape
    (5,)
    """
    _refuse_long(period, octaves)
    frames = [octave_frame(i, seed=seed) for i in range(octaves)]

    def noise(columns: Array) -> Numbers:
        total = np.zeros(columns.shape[1], dtype)
        for i, (own, shift) in enumerate(frames):
            how = _how(own, i, interpolant, period, dtype)
            places = np.array(_placed(tuple(columns), i, shift, how))
            total += persistence**i * _value(places, how)
        return total

    bound = octave_bound(octaves, persistence) * PEAKS[interpolant] ** 3
    found = _scattered(points, noise, dtype, period)
    return _finished(found, bound, normalize, absolute)


@checked
def octave_sum_grid(
    x: Annotated[Array, Shape("W")],
    y: Annotated[Array, Shape("H")],
    z: Annotated[Array, Shape("D")],
    *,
    seed: Seed | None = 0,
    octaves: Octaves = 4,
    persistence: Persistence = 0.5,
    interpolant: Interpolant = "cosine",
    normalize: Normalize = "clip",
    absolute: bool = True,
    period: Period | None = None,
    dtype: Dtype = "float64",
    finest: Annotated[float, Positive] | None = None,
) -> tuple[Numbers, tuple[Skipped, ...]]:
    """Give the paper's fractal noise on a grid, without octaves too fine to be seen.

    Formula: |sum of s^i h(2^i p) for i < Z with 2^-i >= finest|

    Parameters
    ----------
    x, y, z
        Coordinates along each axis, in cells of the first octave, finite, any order.
    seed
        Which pattern. None is the paper's hash, every octave with the same origin.
    octaves
        How many octaves are summed (Z).
    persistence
        Each octave's amplitude relative to the one before (s).
    interpolant
        How lattice values are joined.
    normalize
        How the sum is brought to [0, 1] or [-1, 1]. "clip" cuts what is outside,
        "bound" divides by the largest possible value, "none" leaves it (E11).
    absolute
        Whether the sum's absolute value is taken, as the paper does.
    period
        After how many cells of the first octave the sum repeats along each axis. None
        is 2^32.
    dtype
        Precision of the interpolation and the result; lattice values are exact.
    finest
        Spacing of the samples, in cells of the first octave. Lattice noise repeats in
        two cells at the least, so an octave with less than one sample per cell cannot
        be shown and is skipped; None skips nothing.

    Returns
    -------
    The values, shape (D, H, W) as [z, y, x], and a row for what was skipped, whose
    bound is the sum of the skipped amplitudes.

    Raises
    ------
    ValueError
        The finest octave's period is above 2^31.

    Source: paper M, eq 1 (N15, N16); E11.

    Examples
    --------
    >>> noise, skipped = octave_sum_grid([0.0, 0.5], [0.0], [0.0], finest=0.5)
    >>> print(skipped[0])
    noise: 2 of 4 octaves too fine to show skipped, error at most 0.38 (noise, proved)
    """
    _refuse_long(period, octaves)
    peak = PEAKS[interpolant] ** 3
    bound = octave_bound(octaves, persistence) * peak
    kept = [i for i in range(octaves) if finest is None or 2.0**-i >= finest]
    total = np.zeros((z.size, y.size, x.size), dtype)
    for i in kept:
        own, shift = octave_frame(i, seed=seed)
        how = _how(own, i, interpolant, period, dtype)
        _add_grid(total, persistence**i, _placed((x, y, z), i, shift, how), how)
    values = _finished(total, bound, normalize, absolute)
    if len(kept) == octaves:
        return values, ()
    lost = peak * math.fsum(persistence**i for i in range(len(kept), octaves))
    row = Skipped(
        "noise",
        "octaves too fine to show",
        octaves - len(kept),
        octaves,
        lost / bound if normalize == "bound" else lost,
        "noise",
    )
    return values, (row,)


def _literal(
    points: Array,
    seed: int | None,
    octaves: int,
    persistence: float,
    interpolant: Interpolant,
) -> Array:
    """Give the sum of eq 1 as it stands: |sum of s^i h(2^i p)|."""
    total: Array = np.zeros(points.shape[:-1])
    for i in range(octaves):
        own, shift = octave_frame(i, seed=seed)
        places = points * 2.0**i + shift
        total += persistence**i * value(places, seed=own, interpolant=interpolant)
    return np.abs(total)


def _how(
    seed: int | None,
    octave: int,
    interpolant: Interpolant,
    period: int | None,
    dtype: Dtype,
) -> How:
    """Say how the value noise of an octave is made."""
    repeat = None if period is None else period << octave
    return How(seed, interpolant, True, repeat, dtype)


def _placed(axes: Axes, octave: int, shift: Array, how: How) -> Axes:
    """Give coordinates in cells of an octave; reducing first keeps them exact."""
    wrap = PERIOD if how.period is None else float(how.period)
    x, y, z = (
        _reduced(_reduced(_reduced(c, wrap) * 2.0**octave, wrap) + s, wrap)
        for c, s in zip(axes, shift, strict=True)
    )
    return x, y, z
