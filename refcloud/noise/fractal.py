"""The sum of octaves (eq 1), its true bound, and octaves too fine to be seen.

Each octave is value noise at twice the frequency and `persistence` times the amplitude.
With a seed every octave has a pattern and an origin of its own; without one (the paper
to the letter) all octaves share the origin, and their lattices coincide there.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Positive, Range, Seed, Shape, Skipped
from refcloud.noise.hashing import _hash, _words, uniform
from refcloud.noise.lattice import _reduced
from refcloud.noise.scattered import _scattered
from refcloud.noise.value import Points, _value, value
from refcloud.noise.value_grid import Axes, _add_grid
from refcloud.noise.value_table import How
from refcloud.noise.weights import PEAKS, Interpolant

Normalize = Literal["clip", "bound", "none"]
# 32 octaves: the finest cell is 2^-31 of the first, below float64 at 2^21 cells.
Octaves = Annotated[int, Range(1, 32)]
Persistence = Annotated[float, Range(0.0, 1.0)]


@checked
def octave_bound(octaves: Octaves, persistence: Persistence) -> float:
    """Give the largest value that a sum of octaves of values in [-1, 1] can take.

    Formula: sum of s^i for i < Z = (1 - s^Z) / (1 - s)

    Parameters
    ----------
    octaves
        How many octaves are summed (Z).
    persistence
        Each octave's amplitude relative to the one before (s).

    Returns
    -------
    The bound, at least 1.

    Source: paper M, eq 1; E11.

    Examples
    --------
    >>> octave_bound(4, 0.5)
    1.875
    """
    return math.fsum(persistence**i for i in range(octaves))


@checked
def octave_frame(
    octave: Annotated[int, Range(0, 31)], *, seed: Seed | None = 0
) -> tuple[int | None, Array]:
    """Give the seed and the shift of the origin that an octave uses.

    Formula: octave i is value(2^i p + shift_i, seed=seed_i)

    Parameters
    ----------
    octave
        Which octave, counted from 0.
    seed
        The sum's seed. With None every octave has seed None and no shift, as printed.

    Returns
    -------
    The octave's seed, and its shift, shape (3,), in cells of the octave, in [0, 1).

    Source: paper M, eq 1 shares one origin among all octaves; W12.

    Examples
    --------
    >>> octave_frame(2, seed=None)
    (None, array([0., 0., 0.]))
    """
    if seed is None:
        return None, np.zeros(3)
    own = int(_hash([_words("octave", octave)], seed)[0] >> 1)
    return own, uniform(octave, np.arange(3), seed=seed)


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
) -> Array:
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

    Returns
    -------
    Shape (...,), in [0, 1], or [-1, 1] where not absolute; "none" reaches the bound.

    Source: paper M, eq 1 (N15); E11.

    Examples
    --------
    >>> octave_sum(np.zeros((5, 3)), seed=7).shape
    (5,)
    """
    frames = [octave_frame(i, seed=seed) for i in range(octaves)]

    def noise(columns: Array) -> Array:
        total = np.zeros_like(columns[0])
        for i, (own, shift) in enumerate(frames):
            places = np.array(_placed(tuple(columns), i, shift))
            how = How(own, interpolant, True)
            total += persistence**i * _value(_reduced(places), how)
        return total

    bound = octave_bound(octaves, persistence) * PEAKS[interpolant] ** 3
    return _finished(_scattered(points, noise, "float64"), bound, normalize, absolute)


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
    finest: Annotated[float, Positive] | None = None,
) -> tuple[Array, tuple[Skipped, ...]]:
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
    finest
        Spacing of the samples, in cells of the first octave. Lattice noise repeats in
        two cells at the least, so an octave with less than one sample per cell cannot
        be shown and is skipped; None skips nothing.

    Returns
    -------
    The values, shape (D, H, W) as [z, y, x], and a row for what was skipped, whose
    bound is the sum of the skipped amplitudes.

    Source: paper M, eq 1 (N15, N16); E11.

    Examples
    --------
    >>> noise, skipped = octave_sum_grid([0.0, 0.5], [0.0], [0.0], finest=0.5)
    >>> print(skipped[0])
    noise: 2 of 4 octaves too fine to show skipped, error at most 0.38 (noise)
    """
    peak = PEAKS[interpolant] ** 3
    bound = octave_bound(octaves, persistence) * peak
    kept = [i for i in range(octaves) if finest is None or 2.0**-i >= finest]
    total: Array = np.zeros((z.size, y.size, x.size))
    for i in kept:
        own, shift = octave_frame(i, seed=seed)
        axes = _placed((x, y, z), i, shift)
        _add_grid(total, persistence**i, axes, How(own, interpolant, True))
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


def _placed(axes: Axes, octave: int, shift: Array) -> Axes:
    """Give coordinates in cells of an octave; reducing first keeps them exact."""
    x, y, z = (
        _reduced(_reduced(c) * 2.0**octave) + s
        for c, s in zip(axes, shift, strict=True)
    )
    return x, y, z


def _finished(
    total: Array, bound: float, normalize: Normalize, absolute: bool
) -> Array:
    if absolute:
        total = np.abs(total)
    if normalize == "bound":
        return total / bound
    if normalize == "clip":
        return np.clip(total, -1.0, 1.0)
    return total
