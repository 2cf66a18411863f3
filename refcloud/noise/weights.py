"""An interpolant as weights of the neighbours: the form in which noise applies it.

The weights depend on the place in the cell alone. A grid needs them once for each axis,
whatever the number of values.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.conventions import Array
from refcloud.noise.interpolate import Fraction, _hermite_weight, _quintic_weight

Interpolant = Literal["linear", "cosine", "cubic", "hermite", "quintic", "catmull_rom"]

TWO = (0, 1)  # neighbours at the cell's two ends
FOUR = (-1, 0, 1, 2)  # and one more on each side

# Largest sum of |weights| along one axis, so that noise stays within its cube (E12).
PEAKS: dict[Interpolant, float] = {
    "linear": 1.0,
    "cosine": 1.0,
    "cubic": 1.5,
    "hermite": 1.0,
    "quintic": 1.0,
    "catmull_rom": 1.25,
}


@checked
def taps(interpolant: Interpolant, t: Fraction) -> tuple[Array, NDArray[np.int64]]:
    """Give an interpolant as weights of the neighbours.

    Formula: value(t) = sum over k of weights[k] * v[offsets[k]]

    Parameters
    ----------
    interpolant
        Which form.
    t
        Place in the cell, shape (...,).

    Returns
    -------
    The weights, shape (K, ...), which sum to 1, and the neighbours' offsets from the
    cell's lower end, shape (K,), where K is 2 or 4.

    Source: paper M, eq 4-6 (N08-N12).

    Examples
    --------
    >>> taps("linear", 0.25)
    (array([0.75, 0.25]), array([0, 1]))
    """
    weights, offsets = _taps(interpolant, t)
    return np.stack(weights), np.array(offsets)


def _taps(
    interpolant: Interpolant, t: Array
) -> tuple[tuple[Array, ...], tuple[int, ...]]:
    if interpolant == "cubic":
        s = 1.0 - t
        first, last = -t * s * s, -t * t * s
        return (first, 1.0 - t * t * (2.0 - t), t * (1.0 + t * s), last), FOUR
    if interpolant == "catmull_rom":
        s = 1.0 - t
        first, last = -0.5 * t * s * s, -0.5 * t * t * s
        second = 1.0 + t * t * (1.5 * t - 2.5)
        return (first, second, 0.5 * t * (1.0 + t * (4.0 - 3.0 * t)), last), FOUR
    if interpolant == "cosine":
        w = 0.5 * (1.0 - np.cos(np.pi * t))
    elif interpolant == "hermite":
        w = _hermite_weight(t)
    elif interpolant == "quintic":
        w = _quintic_weight(t)
    else:
        w = t
    return (1.0 - w, w), TWO


def _reach(interpolant: Interpolant) -> tuple[int, ...]:
    """Give the neighbours' offsets alone."""
    return FOUR if interpolant in ("cubic", "catmull_rom") else TWO
