"""Metaballs along rays: chords in closed form, from any point on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Shape
from refcloud.march.cells import Numbers
from refcloud.march.rays import as_rays
from refcloud.metaballs import Metaballs
from refcloud.metaballs.kernels import CUT, GAUSSIAN_TERMS, Kernel

PAIRS = 1 << 18  # of a ray and a ball at a time: 2 MB for each temporary


@checked
def ball_columns(
    balls: Metaballs,
    origins: Annotated[Array, Shape("N", 3)],
    directions: Annotated[Array, Shape("N", 3)],
) -> Array:
    """Integrate the density of metaballs along rays, exactly.

    Formula: sum of density R (F(s) - F(u)), s^2 = 1 - b^2 / R^2, u the ray's origin
    along the chord in radii, held within it; F' is the kernel

    Parameters
    ----------
    balls
        The cloud.
    origins, directions
        Shape (N, 3), scene units; directions of any length but 0.

    Returns
    -------
    Shape (N,), density times scene units. Times sigma_t it is the optical depth that a
    splat has, `refcloud.metaballs.axis_depth` times the chord.

    Source: paper M, eq 12, 13 and 15; E04.

    Examples
    --------
    >>> ball = Metaballs([[0, 0, 0]], [2.0], [945.0])
    >>> ball_columns(ball, [[-9, 0, 0], [0, 0, 0]], [[1, 0, 0], [1, 0, 0]])
    array([1888.,  944.])
    """
    rays = as_rays(origins, directions)
    return columns_of(balls, rays.origins, rays.directions)


def columns_of(balls: Metaballs, origins: Array, directions: Array) -> Array:
    """Integrate along rays, unchecked; directions are unit vectors, or one for all."""
    directions = np.broadcast_to(directions, origins.shape)
    found = np.zeros(len(origins))
    most = max(1, PAIRS // max(1, len(balls)))
    for start in range(0, len(origins), most):
        part = slice(start, start + most)
        ray, ball, q, u = met(balls, origins[part], directions[part])
        chord = chords_of(balls, ball, q, u)
        found[part] = np.bincount(ray, chord, minlength=len(found[part]))
    return found


def chords_of(balls: Metaballs, ball: Numbers, q: Array, u: Array) -> Array:
    """Integrate the density of one ball along each chord, from u on.

    Parameters
    ----------
    balls, ball
        The cloud, and a number for each chord, shape (P,).
    q, u
        As `met` gives them, shape (P,) each.

    Returns
    -------
    Shape (P,), density times scene units.
    """
    s = np.sqrt(1.0 - q)
    chord = primitive(s, q, balls.kernel)
    chord -= primitive(np.clip(u, -s, s), q, balls.kernel)
    return chord * (balls.densities[ball] * balls.radii[ball])


def met(
    balls: Metaballs, origins: Array, directions: Array
) -> tuple[Numbers, Numbers, Array, Array]:
    """List the balls that rays meet from their origins on.

    Parameters
    ----------
    balls
        The cloud.
    origins, directions
        Shape (N, 3), scene units; unit vectors.

    Returns
    -------
    Ray and ball, numbers; the squared distance of the line from the centre, below 1,
    and the origin's place along the chord from its middle, in radii; shape (P,) each.
    """
    offset = [origins[:, k, None] - balls.centers[:, k] for k in range(3)]
    way = [directions[:, k, None] for k in range(3)]
    q, u = passing(offset, way, balls.radii)
    ray, ball = np.nonzero((q < 1.0) & (u < np.sqrt(np.maximum(1.0 - q, 0.0))))
    return ray, ball, q[ray, ball], u[ray, ball]


def passing(
    offset: Sequence[Array], way: Sequence[Array], radii: Array
) -> tuple[Array, Array]:
    """Tell how rays pass balls.

    Parameters
    ----------
    offset, way
        From the centre to the origin, and the unit vector of the ray: x, y and z, of
        shapes that broadcast.
    radii
        Of the balls.

    Returns
    -------
    The squared distance of the line from the centre, and the origin's place along the
    line from its middle, in radii.
    """
    along = offset[0] * way[0] + offset[1] * way[1] + offset[2] * way[2]
    # The foot of the perpendicular, not a difference of squares: far eyes stay exact.
    aside = [o - along * w for o, w in zip(offset, way, strict=True)]
    return (
        (aside[0] ** 2 + aside[1] ** 2 + aside[2] ** 2) / radii**2,
        along / radii,
    )


def primitive(u: Array, q: Array, kernel: Kernel) -> Array:
    """Integrate a kernel along a chord from its middle to u, in radii.

    Parameters
    ----------
    u
        Place along the chord, shape (P,), within the ball.
    q
        Squared distance of the chord from the centre, below 1, shape (P,).
    kernel
        How the density falls.

    Returns
    -------
    Shape (P,), odd in u.
    """
    square = u * u
    if kernel == "wyvill":
        # p^2 (5 + 4p) / 9 with p = s^2 - u^2, term by term.
        p = 1.0 - q
        fifth = p * p - square * (2.0 * p / 3.0 - square / 5.0)
        seventh = p**3 - square * (p * p - square * (0.6 * p - square / 7.0))
        return u * (5.0 * fifth + 4.0 * seventh) / 9.0
    # exp(-4 u^2) times a series of positive terms, as of the whole chord.
    term = np.exp(-(CUT**2) * (q + square))
    total = term.copy()
    for n in range(1, GAUSSIAN_TERMS):
        term = term * (2.0 * CUT**2 / (2 * n + 1)) * square
        total += term
    return u * total
