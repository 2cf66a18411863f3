"""The basis functions of a ball and their integrals along chords.

With q = (r/R)^2 and p = 1 - q the Wyvill kernel of eq 12 (E01: minus 22/9) is
p^2 (5 + 4p) / 9. It is 1 at the centre, 1/2 at R/2, and reaches 0 without a bend.
The Gaussian of eq 15 is exp(-r^2/sigma^2), without a half in the exponent (E17); a ball
cuts it at R = 2 sigma, where exp(-4) = 0.018 is left.
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Positive, Range

Kernel = Literal["wyvill", "gaussian"]

# Coefficients of q^0 ... q^3 in eq 12, as corrected (E01) and as printed.
WYVILL = (Fraction(1), Fraction(-22, 9), Fraction(17, 9), Fraction(-4, 9))
WYVILL_PRINTED = (Fraction(1), Fraction(22, 9), Fraction(17, 9), Fraction(-4, 9))
WYVILL_CHORD = (Fraction(16, 27), Fraction(128, 315))  # of s^5 and s^7, over R

CUT = 2.0  # a Gaussian ball ends at R = CUT sigma, the paper's u of fig 8
# erf(2s) = 4s/sqrt(pi) exp(-4 s^2) sum of (8 s^2)^n / (2n+1)!!: positive terms only.
# 30 of them leave out less than 4e-17 of the sum for every s in [0, 1].
GAUSSIAN_TERMS = 30
_GAUSSIAN_CHORD = [2.0 * math.exp(-(CUT**2))]
for _n in range(1, GAUSSIAN_TERMS):
    _GAUSSIAN_CHORD.append(_GAUSSIAN_CHORD[-1] * 2.0 * CUT**2 / (2 * _n + 1))


@checked
def wyvill(
    r: Annotated[Array, Range(0.0, unit="scene unit")],
    R: Annotated[Array, Positive],
) -> Array:
    """Evaluate the Wyvill kernel, 1 at the centre.

    Formula: f = 1 - 22/9 a^2 + 17/9 a^4 - 4/9 a^6, a = r/R, and 0 where r > R

    Parameters
    ----------
    r
        Distance to the centre, any shape, scene units.
    R
        Radius of the ball, a shape that broadcasts with r, scene units.

    Returns
    -------
    The share of the density at the centre, 0 to 1.

    Source: paper M, eq 12; E01, E03.

    Examples
    --------
    >>> wyvill([0.0, 1.0, 2.0], 2.0)
    array([1. , 0.5, 0. ])
    """
    return profile_of(_squared_ratio(r, R), "wyvill")


@checked
def gaussian(
    r: Annotated[Array, Range(0.0, unit="scene unit")],
    sigma: Annotated[Array, Positive],
) -> Array:
    """Evaluate the Gaussian kernel, 1 at the centre, not cut.

    Formula: f = exp(-r^2 / sigma^2)

    Parameters
    ----------
    r
        Distance to the centre, any shape, scene units.
    sigma
        Where 1/e is left, a shape that broadcasts with r, scene units.

    Returns
    -------
    The share of the density at the centre, 0 to 1.

    Source: paper M, eq 15; E17.

    Examples
    --------
    >>> gaussian([0.0, 1.0], 1.0).round(4)
    array([1.    , 0.3679])
    """
    return np.exp(-_squared_ratio(r, sigma))


@checked
def printed_wyvill(
    r: Annotated[Array, Range(0.0, unit="scene unit")],
    R: Annotated[Array, Positive],
) -> Array:
    """Evaluate eq 12 with its printed sign, which grows outward and then jumps.

    Formula: f = 1 + 22/9 a^2 + 17/9 a^4 - 4/9 a^6, a = r/R, and 0 where r > R

    Parameters
    ----------
    r
        Distance to the centre, any shape, scene units.
    R
        Radius of the ball, a shape that broadcasts with r, scene units.

    Returns
    -------
    The printed function times its k: 1 at the centre, 44/9 at the rim.

    Source: paper M, eq 12; E01. Nothing is drawn with it.

    Examples
    --------
    >>> printed_wyvill([0.0, 1.0, 1.01], 1.0).round(3)
    array([1.   , 4.889, 0.   ])
    """
    q = _squared_ratio(r, R)
    inside = np.minimum(q, 1.0)
    c0, c1, c2, c3 = (float(c) for c in WYVILL_PRINTED)
    return np.where(q > 1.0, 0.0, c0 + inside * (c1 + inside * (c2 + inside * c3)))


@checked
def profile(q: Annotated[Array, Range(0.0)], kernel: Kernel = "wyvill") -> Array:
    """Evaluate a ball's kernel from the squared ratio of distance and radius.

    Formula: p^2 (5 + 4p) / 9 with p = 1 - q, or exp(-4q); 0 where q >= 1

    Parameters
    ----------
    q
        (r/R)^2, any shape.
    kernel
        How the density falls.

    Returns
    -------
    The share of the density at the centre, 1 where q is 0.

    Source: paper M, eq 12 and 15; E01, E03, E17.

    Examples
    --------
    >>> profile([0.0, 0.25, 1.0])
    array([1. , 0.5, 0. ])
    """
    return profile_of(q, kernel)


@checked
def chord(q: Annotated[Array, Range(0.0)], kernel: Kernel = "wyvill") -> Array:
    """Integrate a ball's kernel along a straight line, in radii.

    Formula: 16/27 s^5 + 128/315 s^7 with s^2 = 1 - q, or
    sqrt(pi)/2 exp(-4q) erf(2s); 0 where q >= 1

    Parameters
    ----------
    q
        (b/R)^2, b the line's distance to the centre, any shape.
    kernel
        How the density falls.

    Returns
    -------
    The integral over R: 944/945 through the centre of a Wyvill ball.

    Source: paper M, eq 12 and 15, section 4; E04.

    Examples
    --------
    >>> chord([0.0, 1.0]) * 945
    array([944.,   0.])
    """
    return chord_of(q, kernel)


def _squared_ratio(r: Array, R: Array) -> Array:
    with np.errstate(over="ignore"):  # far away is outside, however far
        return (r / R) ** 2


def profile_of(q: Array, kernel: Kernel) -> Array:
    """Evaluate `profile` without checking q."""
    if kernel == "wyvill":
        p = np.maximum(1.0 - q, 0.0)
        rest = 4.0 * p
        rest += 5.0  # in place: the lists of the fit have many entries
        p *= p
        p *= rest
        p /= 9.0
        return p
    return np.where(q < 1.0, np.exp(-(CUT**2) * np.minimum(q, 1.0)), 0.0)


def slope_of(q: Array, kernel: Kernel) -> Array:
    """Differentiate the profile by q, inside the ball."""
    if kernel == "wyvill":
        p = np.maximum(1.0 - q, 0.0)
        return -p * (10.0 + 12.0 * p) / 9.0
    return -(CUT**2) * profile_of(q, kernel)


def chord_of(q: Array, kernel: Kernel) -> Array:
    """Evaluate `chord` without checking q."""
    p = np.maximum(1.0 - q, 0.0)  # s squared
    s = np.sqrt(p)
    if kernel == "wyvill":
        c5, c7 = (float(c) for c in WYVILL_CHORD)
        return p * p * s * (c5 + c7 * p)
    # exp(-4q) and the series' exp(-4p) multiply to exp(-4): no exp and no erf is left.
    total = np.full_like(p, _GAUSSIAN_CHORD[-1])
    for coefficient in reversed(_GAUSSIAN_CHORD[:-1]):
        total *= p
        total += coefficient
    return s * total
