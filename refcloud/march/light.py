"""The light on a ray: what a unit of lit extinction sends along it, and its share."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Range, Shape
from refcloud.optics import Medium, Sun, phase
from refcloud.optics.phase import lobe_of

Segment = Literal["beer", "euler"]


@checked
def sources(
    suns: tuple[Sun, ...],
    medium: Medium,
    *,
    directions: Annotated[Array, Shape("N", 3)],
) -> Array:
    """Give the radiance that each sun, unshadowed, adds per unit of optical depth.

    Formula: albedo phase(cos_theta) irradiance, cos_theta = direction . toward the sun

    Parameters
    ----------
    suns
        The lights.
    medium
        Albedo and phase function.
    directions
        Of the view rays, away from the eye, unit vectors, shape (N, 3).

    Returns
    -------
    Shape (S, N, 3).

    Source: document D (R04); E20, E36.

    Examples
    --------
    >>> sun = Sun([0.0, 1.0, 0.0])
    >>> sources((sun,), Medium(1.0, phase="isotropic"), directions=[[1.0, 0, 0]])
    array([[[1., 1., 1.]]])
    """
    found = np.empty((len(suns), len(directions), 3))
    for s, sun in enumerate(suns):
        p = phase_along(medium, directions, sun.direction)
        found[s] = p[:, None] * (medium.albedo_rgb * sun.irradiance)
    return found


def phase_along(medium: Medium, directions: Array, toward: Array) -> Array:
    """Evaluate the phase function from directions themselves, unchecked.

    A cosine near 1 forgets how far from 1 it is; half the squared distance of the two
    unit vectors is 1 - cos_theta to the last digit (E36).

    Parameters
    ----------
    medium
        Its phase function and g.
    directions
        Of the view rays, unit vectors, shape (N, 3).
    toward
        Toward the sun, a unit vector, shape (3,).

    Returns
    -------
    Shape (N,), 1 / steradian.
    """
    if medium.phase == "hg":
        facing = toward if medium.g >= 0.0 else -toward
        versed = 0.5 * np.square(directions - facing).sum(axis=1)
        return lobe_of(versed, abs(medium.g))
    x, y, z = (directions * toward).T  # no matrix product: the same bits in any list
    return phase(medium, np.clip(x + y + z, -1.0, 1.0))


@checked
def segment_share(
    tau: Annotated[Array, Range(0.0)], segment: Segment = "beer"
) -> Array:
    """Give what a segment of the ray adds, of the light scattered toward the eye.

    Formula: the integral of exp(-tau') over the segment, 1 - exp(-tau); or tau, the
    paper's Euler sum, which makes light once tau is not small

    Parameters
    ----------
    tau
        Optical depth of the segment, any shape, at least 0.
    segment
        Which of the two.

    Returns
    -------
    The same shape.

    Source: document D (R02, R03); E38.

    Examples
    --------
    >>> segment_share([0.0, 1.0, 50.0]).round(3), segment_share([50.0], "euler")
    (array([0.   , 0.632, 1.   ]), array([50.]))
    """
    return share_of(np.asarray(tau), segment)


def share_of(tau: Array, segment: Segment) -> Array:
    """Give the share, unchecked: the inner form of `segment_share`.

    Parameters
    ----------
    tau, segment
        As `segment_share`.

    Returns
    -------
    The same shape as tau.
    """
    # 1 - exp(-tau) would lose every digit of a thin haze.
    return -np.expm1(-tau) if segment == "beer" else tau
