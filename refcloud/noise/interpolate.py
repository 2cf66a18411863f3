"""Interpolation between lattice values: the paper's three forms and three better ones.

Each form is a weighted sum of two or four neighbours; `refcloud.noise.taps` gives the
weights. Smooth is not accurate: halving the spacing divides the error by 4 for linear,
by 2 for cosine, Hermite, quintic and the paper's cubic, by 8 for Catmull-Rom (E13).
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Range

Values = Annotated[Array, Range()]
Fraction = Annotated[Array, Range(0.0, 1.0)]


@checked
def linear(a: Values, b: Values, t: Fraction) -> Array:
    """Interpolate along the straight line.

    Formula: a (1 - t) + b t

    Parameters
    ----------
    a, b
        Values at t = 0 and t = 1, which broadcast.
    t
        Place between them.

    Returns
    -------
    The value at t, of the broadcast shape.

    Source: paper M, eq 4 (N08).

    Examples
    --------
    >>> float(linear(2.0, 4.0, 0.25))
    2.5
    """
    return a * (1.0 - t) + b * t


@checked
def cosine(a: Values, b: Values, t: Fraction) -> Array:
    """Interpolate along half a wave, flat at both ends.

    Formula: a (1 - F/2) + b F/2, F = 1 - cos(pi t)

    Parameters
    ----------
    a, b
        Values at t = 0 and t = 1, which broadcast.
    t
        Place between them.

    Returns
    -------
    The value at t, of the broadcast shape.

    Source: paper M, eq 5 (N09).

    Examples
    --------
    >>> float(cosine(0.0, 2.0, 1.0))
    2.0
    """
    F = 1.0 - np.cos(np.pi * t)
    return a * (1.0 - 0.5 * F) + 0.5 * b * F


@checked
def cubic(v0: Values, v1: Values, v2: Values, v3: Values, t: Fraction) -> Array:
    """Interpolate by the paper's cubic through four values.

    Formula: P t^3 + Q t^2 + R t + S, P = (v3 - v2) - (v0 - v1), Q = v0 - v1 - P,
    R = v2 - v0, S = v1

    Its slopes at the ends are twice Catmull-Rom's: it bends straight lines and reaches
    1.5 times the largest value (E12).

    Parameters
    ----------
    v0, v1, v2, v3
        Values at t = -1, 0, 1 and 2, which broadcast.
    t
        Place between v1 and v2.

    Returns
    -------
    The value at t, of the broadcast shape.

    Source: paper M, eq 6 (N10); E12.

    Examples
    --------
    >>> float(cubic(-1.0, 1.0, 1.0, -1.0, 0.5))
    1.5
    """
    P = (v3 - v2) - (v0 - v1)
    Q = v0 - v1 - P
    R = v2 - v0
    return ((P * t + Q) * t + R) * t + v1


@checked
def hermite(a: Values, b: Values, t: Fraction) -> Array:
    """Interpolate along the cubic that is flat at both ends.

    Formula: a + (b - a) (3 t^2 - 2 t^3)

    Parameters
    ----------
    a, b
        Values at t = 0 and t = 1, which broadcast.
    t
        Place between them.

    Returns
    -------
    The value at t, of the broadcast shape.

    Source: document S (N11).

    Examples
    --------
    >>> float(hermite(0.0, 1.0, 0.25))
    0.15625
    """
    w = _hermite_weight(t)
    return a * (1.0 - w) + b * w


@checked
def quintic(a: Values, b: Values, t: Fraction) -> Array:
    """Interpolate along the quintic that has no slope and no curvature at both ends.

    Formula: a + (b - a) (6 t^5 - 15 t^4 + 10 t^3)

    Parameters
    ----------
    a, b
        Values at t = 0 and t = 1, which broadcast.
    t
        Place between them.

    Returns
    -------
    The value at t, of the broadcast shape.

    Source: document S (N12).

    Examples
    --------
    >>> float(quintic(0.0, 1.0, 0.5))
    0.5
    """
    w = _quintic_weight(t)
    return a * (1.0 - w) + b * w


@checked
def catmull_rom(v0: Values, v1: Values, v2: Values, v3: Values, t: Fraction) -> Array:
    """Interpolate by the cubic whose slopes are the chords' over two cells.

    Formula: v1 + t/2 (v2 - v0 + t (2 v0 - 5 v1 + 4 v2 - v3 + t C)),
    C = 3 (v1 - v2) + v3 - v0

    Parameters
    ----------
    v0, v1, v2, v3
        Values at t = -1, 0, 1 and 2, which broadcast.
    t
        Place between v1 and v2.

    Returns
    -------
    The value at t, of the broadcast shape.

    Source: what paper M, eq 6 is close to; E12, E13.

    Examples
    --------
    >>> float(catmull_rom(-1.0, 0.0, 1.0, 2.0, 0.25))
    0.25
    """
    third = 3.0 * (v1 - v2) + v3 - v0
    second = 2.0 * v0 - 5.0 * v1 + 4.0 * v2 - v3
    return v1 + 0.5 * t * (v2 - v0 + t * (second + t * third))


def _hermite_weight(t: Array) -> Array:
    # Rounding can pass 1 by a last bit near t = 1; noise must stay in [-1, 1].
    return np.minimum(t * t * (3.0 - 2.0 * t), 1.0)


def _quintic_weight(t: Array) -> Array:
    # In place, which halves the time: t * t * t * (t * (t * 6 - 15) + 10).
    weight = t * 6.0
    weight -= 15.0
    weight *= t
    weight += 10.0
    cube = t * t
    cube *= t
    cube *= weight
    if np.ndim(cube) == 0:
        return np.minimum(cube, 1.0)
    weight.fill(1.0)  # the minimum with an array is quicker than with a number
    return np.minimum(cube, weight, out=cube)
