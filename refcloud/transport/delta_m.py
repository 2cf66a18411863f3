"""Phase functions as few Legendre terms, the forward peak counted as unscattered.

A forward phase function needs many terms. Delta-M (Wiscombe 1977) takes the share f of
the scattering that goes on almost straight ahead for light that was not scattered at
all: extinction and albedo shrink, and the first L terms carry the rest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from refcloud.checking import check_fields, checked
from refcloud.conventions import WHOLE_SPHERE, Array, Range, Shape
from refcloud.optics import Medium

RAYLEIGH_SECOND = 0.1  # 3/4 (1 + c^2) = P0 + 5 (1/10) P2


@dataclass(frozen=True)
class ScaledMedium:
    """A medium whose forward peak counts as unscattered.

    Attributes
    ----------
    sigma_t
        Extinction at density 1 by channel, 1 / scene unit, shape (3,).
    albedo
        Scattered share of it by channel, shape (3,).
    moments
        Mean Legendre polynomials of the phase function, 0 to L, shape (L + 1,); the
        first is 1.
    forward
        f, the share of scattering that went into the peak, in [0, 1).
    backward
        b, the share that turns light straight round where g < 0; the moments hold it.
    """

    sigma_t: Annotated[Array, Shape(3), Range(0.0, unit="1 / scene unit")]
    albedo: Annotated[Array, Shape(3), Range(0.0, 1.0)]
    moments: Annotated[Array, Shape("L")]
    forward: Annotated[float, Range(0.0, 1.0, open_upper=True)]
    backward: Annotated[float, Range(0.0, 1.0, open_upper=True)] = 0.0

    def __post_init__(self) -> None:
        check_fields(self)


@checked
def legendre_moments(medium: Medium, degree: Annotated[int, Range(0, 64)]) -> Array:
    """Give the mean of each Legendre polynomial over a medium's phase function.

    Formula: chi_l = integral of p(c) P_l(c) over the sphere: g^l for Henyey-Greenstein,
    1 0 1/10 0 ... for Rayleigh, 1 0 0 ... for isotropic

    Parameters
    ----------
    medium
        Holds the phase function's name, and g.
    degree
        The last l.

    Returns
    -------
    Shape (degree + 1,), each in [-1, 1].

    Source: an extension of paper M (multiple scattering, X09); E20.

    Examples
    --------
    >>> legendre_moments(Medium(1.0, g=0.5, phase="hg"), 2)
    array([1.  , 0.5 , 0.25])
    """
    if medium.phase == "hg":
        return np.power(medium.g, np.arange(degree + 1), dtype=np.float64)
    moments = np.zeros(degree + 1)
    moments[0] = 1.0
    if medium.phase == "rayleigh" and degree >= 2:
        moments[2] = RAYLEIGH_SECOND
    return moments


@checked
def delta_m(medium: Medium, degree: Annotated[int, Range(0, 63)]) -> ScaledMedium:
    """Count the forward peak of a medium's phase function as unscattered light.

    Formula: f = chi_{L+1} for g > 0, else 0; sigma' = sigma (1 - a f),
    a' = a (1 - f) / (1 - a f), chi'_l = (chi_l - f) / (1 - f); b = |g|^(L+1) for g < 0

    Parameters
    ----------
    medium
        What the cloud is made of.
    degree
        L, the last term that is kept.

    Returns
    -------
    The scaled medium. A backward lobe (g < 0) has no forward peak; its share b turns
    beams of sunlight round (`folded_beams`). Against random paths (32 voxels' edge,
    0.25 in each) pictures by the plan "reference" are off by 0.02 or less for g from
    -0.6 to 0.85, by 0.07 at -0.85, and at -0.95 by 0.28 with 4 % too much light in all
    (relative RMSE; the paths' own sum is known to 4 %). At 0.95 nothing is seen above
    the paths' noise of 0.1; their sum is 6 % more, known to 3 %.

    Source: an extension of paper M (multiple scattering, X09).

    Examples
    --------
    >>> delta_m(Medium(1.0, g=0.5, phase="hg"), 3).sigma_t
    array([0.9375, 0.9375, 0.9375])
    """
    moments = legendre_moments(medium, degree + 1)
    peaked = medium.phase == "hg" and medium.g > 0.0
    f = float(moments[-1]) if peaked else 0.0
    albedo = medium.albedo_rgb
    left = 1.0 - albedo * f
    return ScaledMedium(
        medium.sigma_t_rgb * left,
        np.minimum(albedo * (1.0 - f) / left, 1.0),
        (moments[:-1] - f) / (1.0 - f),
        f,
        abs(float(moments[-1])) if medium.phase == "hg" and medium.g < 0.0 else 0.0,
    )


@checked
def smooth_phase(
    moments: Annotated[Array, Shape("L")],
    cos_theta: Annotated[Array, Range(-1.0, 1.0)],
) -> Array:
    """Evaluate a phase function from its Legendre moments.

    Formula: p(c) = sum_l (2 l + 1) / (4 pi) chi_l P_l(c)

    Parameters
    ----------
    moments
        chi_0 to chi_L, shape (L + 1,).
    cos_theta
        Any shape, in [-1, 1].

    Returns
    -------
    The same shape, 1 / steradian; a cut-off series may dip below 0.

    Source: an extension of paper M (multiple scattering, X09); E20.

    Examples
    --------
    >>> float(smooth_phase([1.0], [0.3])[0] * WHOLE_SPHERE)
    1.0
    """
    weight = (2.0 * np.arange(len(moments)) + 1.0) * moments / WHOLE_SPHERE
    return np.array(np.polynomial.legendre.legval(cos_theta, weight), np.float64)
