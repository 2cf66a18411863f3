"""Fractal sums of any kind of noise at scattered points: fBm and turbulence.

Every octave has a seed and an origin of its own, so that octaves do not meet at their
lattice points. Weights halve and frequencies double (N18). Turbulence sums absolute
values, each octave's own, and so has creases where an octave changes its sign (N19);
the absolute value of the whole sum is paper M's, `octave_sum`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Seed
from refcloud.noise.gradient import Period
from refcloud.noise.hashing import uniform
from refcloud.noise.kinds import KINDS, KindName, _octave_columns
from refcloud.noise.octaves import (
    Normalize,
    Octaves,
    Persistence,
    _finished,
    _refuse_long,
    octave_bound,
    octave_frame,
)
from refcloud.noise.scattered import Dtype, Numbers, Places, _scattered
from refcloud.refusal import complaint


@checked
def fbm(
    points: Places,
    *,
    kind: KindName = "gradient",
    time: float | None = None,
    seed: Seed = 0,
    octaves: Octaves = 4,
    persistence: Persistence = 0.5,
    normalize: Normalize = "bound",
    period: Period | None = None,
    dtype: Dtype = "float64",
) -> Numbers:
    """Give fractional Brownian motion at scattered points: octaves of noise, summed.

    Formula: sum over i < Z of s^i n_i(2^i p + shift_i)

    Parameters
    ----------
    points
        Shape (..., 2), (..., 3) or (..., 4), in cells of the first octave, as the kind
        allows. NaN or infinity gives NaN.
    kind
        Which noise. "value" is in space, "gradient" and "simplex" in two to four
        dimensions.
    time
        One more coordinate, the same for all points. None adds none (N24).
    seed
        Which pattern. Each octave has a seed hashed from it, and its own origin.
    octaves
        How many octaves are summed (Z).
    persistence
        Each octave's amplitude relative to the one before (s).
    normalize
        How the sum is brought to [-1, 1]. "bound" divides by the largest possible
        value, "clip" cuts what is outside, "none" leaves it (E11).
    period
        After how many cells of the first octave the sum repeats along each axis. None
        is 2^32; "simplex" cannot.
    dtype
        Precision of the arithmetic and the result.

    Returns
    -------
    Shape (...,), in [-1, 1]; "none" reaches `octave_bound`.

    Raises
    ------
    ValueError
        The kind has no noise of so many coordinates, or cannot repeat.

    Source: document S (N18, N24); E11.

    Examples
    --------
    >>> fbm(np.zeros((5, 3)), kind="simplex", time=0.5, seed=7).shape
    (5,)
    """
    how = (kind, time, seed, octaves, persistence, normalize, period, dtype)
    return _sum(points, *how, absolute=False)


@checked
def turbulence(
    points: Places,
    *,
    kind: KindName = "gradient",
    time: float | None = None,
    seed: Seed = 0,
    octaves: Octaves = 4,
    persistence: Persistence = 0.5,
    normalize: Normalize = "bound",
    period: Period | None = None,
    dtype: Dtype = "float64",
) -> Numbers:
    """Give turbulence at scattered points: the octaves' absolute values, summed.

    Formula: sum over i < Z of s^i |n_i(2^i p + shift_i)|

    Parameters
    ----------
    points
        Shape (..., 2), (..., 3) or (..., 4), in cells of the first octave, as the kind
        allows. NaN or infinity gives NaN.
    kind
        Which noise.
    time
        One more coordinate, the same for all points. None adds none (N24).
    seed
        Which pattern.
    octaves
        How many octaves are summed (Z).
    persistence
        Each octave's amplitude relative to the one before (s).
    normalize
        How the sum is brought to [0, 1], as in `fbm`.
    period
        After how many cells of the first octave the sum repeats along each axis.
    dtype
        Precision of the arithmetic and the result.

    Returns
    -------
    Shape (...,), in [0, 1]; "none" reaches `octave_bound`.

    Raises
    ------
    ValueError
        The kind has no noise of so many coordinates, or cannot repeat.

    Source: document S (N19, N24).

    Examples
    --------
    >>> bool((turbulence(np.eye(2), seed=7) >= 0.0).all())
    True
    """
    how = (kind, time, seed, octaves, persistence, normalize, period, dtype)
    return _sum(points, *how, absolute=True)


def _literal(
    points: Array,
    noise: Callable[..., Any],
    seed: int,
    octaves: int,
    persistence: float,
    absolute: bool,
) -> Array:
    """Give a sum of octaves of any noise(points, seed=...), as its formula says it."""
    total: Array = np.zeros(points.shape[:-1])
    for i in range(octaves):
        own, shift = _frame(i, points.shape[-1], seed)
        octave = noise(points * 2.0**i + shift, seed=own)
        total += persistence**i * (np.abs(octave) if absolute else octave)
    return total


def _sum(
    points: Array,
    kind: KindName,
    time: float | None,
    seed: int,
    octaves: int,
    persistence: float,
    normalize: Normalize,
    period: int | None,
    dtype: Dtype,
    *,
    absolute: bool,
) -> Numbers:
    """Sum octaves at scattered points, each with or without its absolute value."""
    dimensions = points.shape[-1] + (time is not None)
    _refuse(kind, dimensions, octaves, period, "points")
    if time is not None:
        points = np.concatenate(
            (points, np.broadcast_to(time, (*points.shape[:-1], 1))), axis=-1
        )
    frames = [_frame(i, dimensions, seed) for i in range(octaves)]

    def noise(columns: Array) -> Numbers:
        total = np.zeros(columns.shape[1], dtype)
        for i, (own, shift) in enumerate(frames):
            repeat = None if period is None else period << i
            wrap = float(repeat or KINDS[kind].wrap)
            placed = _octave_columns(columns, i, shift, wrap)
            values = KINDS[kind].points(placed, own, repeat, dtype)
            total += persistence**i * (np.abs(values) if absolute else values)
        return total

    values = _scattered(points, noise, dtype, period or int(KINDS[kind].wrap))
    return _finished(values, octave_bound(octaves, persistence), normalize, False)


def _frame(octave: int, dimensions: int, seed: int) -> tuple[int, Array]:
    """Give an octave's seed and shift, those of `octave_frame` and a fourth one."""
    own, shift = octave_frame(octave, seed=seed)
    assert own is not None
    if dimensions == 4:
        return own, uniform(octave, np.arange(4), seed=seed)
    return own, shift[:dimensions]


def _refuse(
    kind: KindName, dimensions: int, octaves: int, period: int | None, name: str
) -> None:
    """Refuse what a kind of noise does not have."""
    allowed = KINDS[kind].dimensions
    if dimensions not in allowed:
        expected = f"{' or '.join(map(str, allowed))} coordinates for {kind!r}"
        got = f"{dimensions}, time among them"
        raise ValueError(complaint(name, expected, got))
    if period is not None and not KINDS[kind].tiles:
        raise ValueError(complaint("period", f"None for {kind!r}", str(period)))
    _refuse_long(period, octaves)
