"""Fractal sums of any kind of noise on a grid, without octaves too fine to be seen."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Positive, Seed, Shape, Skipped
from refcloud.noise.fbm import _frame, _refuse
from refcloud.noise.gradient import Period
from refcloud.noise.kinds import KINDS, KindName, Octave, _octave_columns
from refcloud.noise.octaves import (
    Normalize,
    Octaves,
    Persistence,
    octave_bound,
)
from refcloud.noise.scattered import Dtype, Numbers


@checked
def fbm_grid(
    x: Annotated[Array, Shape("W")],
    y: Annotated[Array, Shape("H")],
    z: Annotated[Array, Shape("D")] | None = None,
    *,
    kind: KindName = "gradient",
    time: float | None = None,
    seed: Seed = 0,
    octaves: Octaves = 4,
    persistence: Persistence = 0.5,
    normalize: Normalize = "bound",
    period: Period | None = None,
    dtype: Dtype = "float64",
    finest: Annotated[float, Positive] | None = None,
) -> tuple[Numbers, tuple[Skipped, ...]]:
    """Give fractional Brownian motion on a grid: `fbm` at every place.

    Formula: sum over i < Z with 2^-i >= finest of s^i n_i(2^i p + shift_i)

    Parameters
    ----------
    x, y
        Coordinates along the first two axes, in cells of the first octave, finite.
    z
        Coordinates along a third axis. Without it the grid is a plane.
    kind
        Which noise. "value" needs three coordinates, time among them; the others take
        z and time together.
    time
        One more coordinate, the same for all places. None adds none (N24).
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
        After how many cells of the first octave the sum repeats along each axis.
    dtype
        Precision of the arithmetic and the result.
    finest
        Spacing of the samples, in cells of the first octave. An octave with less than
        one sample per cell is skipped (N16); None skips nothing.

    Returns
    -------
    The values, shape (D, H, W) or (H, W), and a row for what was skipped, whose bound
    is the sum of the skipped amplitudes, divided as the values are.

    Raises
    ------
    ValueError
        The kind has no noise of so many coordinates, or cannot repeat.

    Source: document S (N16, N18, N24); E11.

    Examples
    --------
    >>> noise, skipped = fbm_grid([0.0, 0.5], [0.0], finest=0.5, normalize="none")
    >>> print(skipped[0])
    noise: 2 of 4 octaves too fine to show skipped, error at most 0.38 (noise, proved)
    """
    how = (kind, time, seed, octaves, persistence, normalize, period, dtype, finest)
    return _sum_grid((x, y, z), *how, absolute=False)


@checked
def turbulence_grid(
    x: Annotated[Array, Shape("W")],
    y: Annotated[Array, Shape("H")],
    z: Annotated[Array, Shape("D")] | None = None,
    *,
    kind: KindName = "gradient",
    time: float | None = None,
    seed: Seed = 0,
    octaves: Octaves = 4,
    persistence: Persistence = 0.5,
    normalize: Normalize = "bound",
    period: Period | None = None,
    dtype: Dtype = "float64",
    finest: Annotated[float, Positive] | None = None,
) -> tuple[Numbers, tuple[Skipped, ...]]:
    """Give turbulence on a grid: `turbulence` at every place.

    Formula: sum over i < Z with 2^-i >= finest of s^i |n_i(2^i p + shift_i)|

    Parameters
    ----------
    x, y
        Coordinates along the first two axes, in cells of the first octave, finite.
    z
        Coordinates along a third axis. Without it the grid is a plane.
    kind
        Which noise.
    time
        One more coordinate, the same for all places. None adds none (N24).
    seed
        Which pattern.
    octaves
        How many octaves are summed (Z).
    persistence
        Each octave's amplitude relative to the one before (s).
    normalize
        How the sum is brought to [0, 1], as in `fbm_grid`.
    period
        After how many cells of the first octave the sum repeats along each axis.
    dtype
        Precision of the arithmetic and the result.
    finest
        Spacing of the samples; finer octaves are skipped, as in `fbm_grid`.

    Returns
    -------
    The values, shape (D, H, W) or (H, W), and a row for what was skipped.

    Raises
    ------
    ValueError
        The kind has no noise of so many coordinates, or cannot repeat.

    Source: document S (N16, N19, N24).

    Examples
    --------
    >>> turbulence_grid([0.0, 0.5], [0.0], time=0.25)[0].shape
    (1, 2)
    """
    how = (kind, time, seed, octaves, persistence, normalize, period, dtype, finest)
    return _sum_grid((x, y, z), *how, absolute=True)


def _literal(
    axes: list[Array],
    grid: Callable[..., Any],
    seed: int,
    octaves: int,
    persistence: float,
    absolute: bool,
) -> Array:
    """Give a sum of octaves of any grid(x, ..., seed=...), as its formula says it."""
    total: Array = np.zeros([axis.size for axis in axes[::-1]])
    for i in range(octaves):
        own, shift = _frame(i, len(axes), seed)
        moved = [axis * 2.0**i + s for axis, s in zip(axes, shift, strict=True)]
        octave = grid(*moved, seed=own)
        total += persistence**i * (np.abs(octave) if absolute else octave)
    return total


def _sum_grid(
    axes: tuple[Array, Array, Array | None],
    kind: KindName,
    time: float | None,
    seed: int,
    octaves: int,
    persistence: float,
    normalize: Normalize,
    period: int | None,
    dtype: Dtype,
    finest: float | None,
    *,
    absolute: bool,
) -> tuple[Numbers, tuple[Skipped, ...]]:
    """Sum octaves on a grid, each with or without its absolute value."""
    lines = [axis for axis in axes if axis is not None]
    shape = [line.size for line in lines[::-1]]
    if time is not None:
        lines.append(np.array([time]))
    _refuse(kind, len(lines), octaves, period, "z")
    bound = octave_bound(octaves, persistence)
    kept = [i for i in range(octaves) if finest is None or 2.0**-i >= finest]
    scale = 1.0 / bound if normalize == "bound" else 1.0
    summed = []
    for i in kept:
        own, shift = _frame(i, len(lines), seed)
        repeat = None if period is None else period << i
        wrap = float(repeat or KINDS[kind].wrap)
        placed = [
            _octave_columns(line[np.newaxis], i, shift[k], wrap)[0]
            for k, line in enumerate(lines)
        ]
        summed.append(Octave(scale * persistence**i, placed, own, repeat))
    total = np.empty([line.size for line in lines[::-1]], dtype)
    if summed:
        KINDS[kind].fill(total, summed, absolute)
    else:
        total[...] = 0.0
    result = total.reshape(shape)
    if normalize == "clip":
        np.clip(result, -1.0, 1.0, out=result)
    if len(kept) == octaves:
        return result, ()
    lost = math.fsum(persistence**i for i in range(len(kept), octaves))
    row = Skipped(
        "noise",
        "octaves too fine to show",
        octaves - len(kept),
        octaves,
        lost / bound if normalize == "bound" else lost,
        "noise",
    )
    return result, (row,)
