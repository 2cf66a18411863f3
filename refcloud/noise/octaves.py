"""What all sums of octaves share: their bound, each octave's frame, normalisation.

With a seed every octave has a pattern and an origin of its own; without one (the paper
to the letter) all octaves share the origin, and their lattices coincide there.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Range, Seed
from refcloud.noise.hashing import _hash, _words, uniform
from refcloud.noise.scattered import Numbers
from refcloud.refusal import complaint

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


def _refuse_long(period: int | None, octaves: int) -> None:
    """Refuse a period whose finest octave has more cells than lattice coordinates."""
    if period is not None and period << (octaves - 1) > 2**31:
        expected = f"at most {2**31 >> (octaves - 1)} for {octaves} octaves"
        raise ValueError(complaint("period", expected, str(period)))


def _finished(
    total: Numbers, bound: float, normalize: Normalize, absolute: bool
) -> Numbers:
    if absolute:
        total = np.abs(total)
    if normalize == "bound":
        return total / bound
    if normalize == "clip":
        return np.clip(total, -1.0, 1.0)
    return total
