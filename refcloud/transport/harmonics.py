"""Real spherical harmonics: how light at a place is kept in few numbers.

A phase function of Legendre terms 0 to L sees of the light around a place no more than
its first (L + 1)^2 harmonics (the addition theorem). They are what is stored.
"""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.conventions import UNIT, WHOLE_SPHERE, Array, Range, Shape

Places = NDArray[np.integer[Any]]


@checked
def harmonics(
    vectors: Annotated[Array, Shape("...", 3), UNIT],
    degree: Annotated[int, Range(0, 32)],
) -> Array:
    """Evaluate the real spherical harmonics up to a degree.

    Formula: Y_lm = N_lm P_l^m(z) Re or Im (x + i y)^m, orthonormal over the sphere, at
    place l^2 + l + m; sum_m Y_lm(a) Y_lm(b) = (2 l + 1) / (4 pi) P_l(a . b)

    Parameters
    ----------
    vectors
        Unit vectors, shape (..., 3).
    degree
        L, the last l.

    Returns
    -------
    Shape (..., (L + 1)^2).

    Source: an extension of paper M (multiple scattering, X09).

    Examples
    --------
    >>> harmonics([[0.0, 0.0, 1.0]], 1).round(4)
    array([[0.2821, 0.    , 0.4886, 0.    ]])
    """
    x, y, z = np.moveaxis(vectors, -1, 0)
    out = np.empty((*x.shape, (degree + 1) ** 2))
    # (x + i y)^m = cosine + i sine, times a polynomial of z that starts as `highest`.
    cosine, sine = np.ones_like(x), np.zeros_like(x)
    highest = math.sqrt(1.0 / WHOLE_SPHERE)
    for m in range(degree + 1):
        if m:
            cosine, sine = x * cosine - y * sine, x * sine + y * cosine
            highest *= math.sqrt((2 * m + 1) / (2 * m))
        before, now = np.zeros_like(x), np.full_like(x, highest)
        for l in range(m, degree + 1):
            if l > m:
                a = math.sqrt((4 * l * l - 1) / (l * l - m * m))
                b = math.sqrt(((l - 1) ** 2 - m * m) / (4 * (l - 1) ** 2 - 1))
                before, now = now, a * (z * now - b * before)
            both = math.sqrt(2.0) if m else 1.0
            out[..., l * l + l + m] = both * now * cosine
            if m:
                out[..., l * l + l - m] = both * now * sine
    return out


def degree_of(place: Places) -> Places:
    """Tell the l of harmonics from their places."""
    return np.floor(np.sqrt(place + 0.5)).astype(np.intp)
