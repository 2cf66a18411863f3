"""Single scattering along rays, by quadrature in every space between voxel centres.

Along a piece of a ray the density is a polynomial of third degree. Its values at four
Gauss points give the optical depth up to each of them without error; at each of them
the column to the sun is integrated the same way. What is left is the sum over the four
points of a product of exponentials: pieces are cut until that is smooth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from refcloud.conventions import Array
from refcloud.march.cells import Lattice, Numbers, Pieces, cut, density_at, most_rays
from refcloud.march.mixing import Mixing
from refcloud.march.pieces import POINTS, SLACK, WEIGHTS, evenly, taken, thinner
from refcloud.march.quadrature import (
    before_each,
    columns,
    gauss,
    integrals_up_to,
    per_ray,
)
from refcloud.march.steps import reaching
from refcloud.optics import Medium, Sun

# Change of a sun's optical depth along a piece: with the eye's .5, exact to 2e-8.
STEEPEST = 1.0
# Optical depth behind which nothing shows: exp(-41) is below a last bit of white.
DEEPEST = 41.0
# Columns of density from places (M, 3) on, in one direction (3,), shape (M,).
ColumnsTo = Callable[[Array, Array], Array]


@dataclass(frozen=True)
class Points:
    """Gauss points on pieces of rays.

    Attributes
    ----------
    ray
        Which ray a piece belongs to, ascending, shape (P,).
    near
        Columns of density between the eye and each point, shape (P, K).
    amount
        Columns of density that each point stands for, shape (P, K).
    places
        Where they are, shape (P, K, 3), scene units.
    """

    ray: Numbers
    near: Array
    amount: Array
    places: Array

    def taken(self, which: Numbers) -> Points:
        """Keep the points of some pieces."""
        return Points(
            self.ray[which], self.near[which], self.amount[which], self.places[which]
        )


def exact(
    grid: Lattice,
    origins: Array,
    directions: Array,
    suns: tuple[Sun, ...],
    lit: Array,
    medium: Medium,
    mixing: Mixing,
    least: float = 0.0,
    points: int = 4,
    columns_to: ColumnsTo | None = None,
) -> tuple[Array, Array]:
    """Integrate rays, unchecked.

    Parameters
    ----------
    grid
        The cloud map.
    origins, directions
        Shape (N, 3), scene units; unit vectors.
    suns, lit
        The lights, and what each sends along each ray, shape (S, N, 3).
    medium, mixing
        Extinction, and factors on optical depths.
    least
        Transmittance behind which nothing need be looked for.
    points
        Of a piece at which light is looked for: 4, or fewer where that does.
    columns_to
        As `scattered`; None integrates every one of them exactly.

    Returns
    -------
    Radiance of shape (N, 3), and columns of density of shape (N,).
    """
    radiance = np.zeros((len(origins), 3))
    column = np.zeros(len(origins))
    most = most_rays(grid)
    for start in range(0, len(origins), most):
        part = slice(start, start + most)
        radiance[part], column[part] = _some(
            grid,
            origins[part],
            directions[part],
            suns,
            lit[:, part],
            medium,
            mixing,
            least,
            points,
            columns_to,
        )
    return radiance, column


def _some(
    grid: Lattice,
    origins: Array,
    directions: Array,
    suns: tuple[Sun, ...],
    lit: Array,
    medium: Medium,
    mixing: Mixing,
    least: float,
    points: int,
    columns_to: ColumnsTo | None,
) -> tuple[Array, Array]:
    count = len(origins)
    sigma_t = np.atleast_1d(medium.sigma_t)  # (1,), or (3,) of a coloured medium
    eyeward = mixing.light_absorption_through_cloud * sigma_t
    sunward = mixing.light_absorption_toward_sun * sigma_t

    # 1. Cut the rays, and integrate the density up to each point.
    pieces = cut(grid, origins, directions, [sun.direction for sun in suns])
    mass = pieces.length * (density_at(pieces, POINTS) @ WEIGHTS)
    column = per_ray(pieces.ray, mass, count)
    before = before_each(pieces.ray, mass, count)
    # Through the clearest channel nothing may show for a piece to be left out. The
    # light on it counts: a narrow lobe can be far brighter than white.
    clearest = float(eyeward.min(initial=np.inf))
    brightest = max(float(lit.max(initial=1.0)), 1.0)
    deepest = DEEPEST + np.log(brightest)
    if least > 0.0:
        deepest = min(deepest, -np.log(least))
    seen = np.flatnonzero(clearest * before < deepest)
    pieces, before, mass = taken(pieces, seen), before[seen], mass[seen]
    pieces, before = thinner(pieces, before, mass, eyeward, deepest)

    # 2. Points on the pieces, and the light that reaches them from each sun. Where that
    # changes much along a piece, as beside a grazed face, the piece is cut further.
    rule = gauss(points)
    found = np.zeros((count, 3))
    to_sun = columns_to or (lambda places, toward: columns(grid, places, toward))
    placed = points_of(pieces, before, origins, directions, rule)
    for sun, source in zip(suns, lit, strict=True):
        if not source.any():
            continue
        far = far_of(placed, sun, to_sun)
        parts = np.ones(len(far), np.intp)
        for rate in np.unique(sunward):
            parts = np.maximum(parts, parts_needed(rate * far, np.ptp(rule[0])))
        gentle, steep = np.flatnonzero(parts == 1), np.flatnonzero(parts > 1)
        add(found, placed.taken(gentle), far[gentle], source, medium, mixing)
        if len(steep):
            finer = evenly(taken(pieces, steep), before[steep], parts[steep])
            more = points_of(*finer, origins, directions, rule)
            add(found, more, far_of(more, sun, to_sun), source, medium, mixing)
    return found, column


def far_of(points: Points, sun: Sun, columns_to: ColumnsTo) -> Array:
    """Give columns of density from points to a sun, shape (P, K)."""
    far = columns_to(points.places.reshape(-1, 3), sun.direction)
    return far.reshape(points.near.shape)


def parts_needed(tau: Array, share: float) -> Numbers:
    """Tell into how many parts to cut pieces, by the suns' depths at their points.

    Parameters
    ----------
    tau
        Optical depths at the points of each piece, shape (P, K).
    share
        Of a piece that lies between its outermost points.

    Returns
    -------
    1 or more, shape (P,).
    """
    low = tau.min(axis=1, initial=np.inf)
    # Behind the deepest there is no light left to change.
    change = np.minimum(
        tau.max(axis=1, initial=0.0) - low, np.maximum(DEEPEST - low, 0.0)
    )
    return np.maximum(np.ceil(change / (share * STEEPEST) - SLACK), 1.0).astype(np.intp)


def points_of(
    pieces: Pieces,
    before: Array,
    origins: Array,
    directions: Array,
    rule: tuple[Array, Array],
) -> Points:
    """Place Gauss points on pieces, with the columns up to them."""
    shares, weights = rule
    length = pieces.length[:, None]
    up_to = density_at(pieces, POINTS) @ integrals_up_to(shares, POINTS).T
    t = pieces.start[:, None] + length * shares
    return Points(
        pieces.ray,
        before[:, None] + length * up_to,
        density_at(pieces, shares) * (length * weights),
        origins[pieces.ray, None] + t[..., None] * directions[pieces.ray, None],
    )


def scattered(
    points: Points,
    count: int,
    columns_to: ColumnsTo,
    suns: tuple[Sun, ...],
    lit: Array,
    medium: Medium,
    mixing: Mixing,
) -> Array:
    """Sum what points scatter toward the eye.

    Parameters
    ----------
    points
        Where light is looked for.
    count
        Number of rays N.
    columns_to
        Gives columns of density from places (M, 3) on, in one direction.
    suns, lit, medium, mixing
        As `exact`.

    Returns
    -------
    Radiance, shape (N, 3).
    """
    radiance = np.zeros((count, 3))
    for sun, source in zip(suns, lit, strict=True):
        if source.any():
            far = far_of(points, sun, columns_to)
            add(radiance, points, far, source, medium, mixing)
    return radiance


def add(
    radiance: Array,
    points: Points,
    far: Array,
    source: Array,
    medium: Medium,
    mixing: Mixing,
) -> None:
    """Add what points scatter toward the eye of one sun's light.

    Parameters
    ----------
    radiance
        Of N rays, shape (N, 3); changed.
    points, far
        The points, and columns of density from them to the sun, shape (P, K).
    source
        What the sun sends along each ray, shape (N, 3).
    medium, mixing
        As `exact`.
    """
    sigma_t = np.atleast_1d(medium.sigma_t)  # (1,), or (3,) of a coloured medium
    eyeward = mixing.light_absorption_through_cloud * sigma_t
    for channel, sigma in enumerate(sigma_t):
        shown = np.exp(-eyeward[channel] * points.near)
        shown *= reaching(sigma * far, mixing)
        amounts = sigma * (points.amount * shown).sum(axis=1)
        whole = per_ray(points.ray, amounts, len(radiance))
        channels = slice(None) if len(sigma_t) == 1 else [channel]
        radiance[:, channels] += source[:, channels] * whole[:, None]
