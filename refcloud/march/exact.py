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
from refcloud.march.quadrature import (
    before_each,
    columns,
    gauss,
    integrals_up_to,
    per_ray,
)
from refcloud.march.steps import reaching
from refcloud.optics import Medium, Sun

POINTS, WEIGHTS = gauss(4)
# Optical depth of a piece: four points integrate exp(-2 tau) over it, which is light
# that comes and goes the same way, to 3e-10.
THICKEST = 0.5
# Optical depth behind which nothing shows: exp(-41) is below a last bit of white.
DEEPEST = 41.0
# Columns of density from places (M, 3) on, in one direction (3,), shape (M,).
ColumnsTo = Callable[[Array, Array], Array]
HALVINGS = 50  # of a piece, to find where an optical depth is reached


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
    pieces, before = thinner(pieces, before, mass, float(eyeward.max()), deepest)

    # 2. The light that reaches each point from the eye's side and from the suns'.
    shares, weights = gauss(points)
    up_to = density_at(pieces, POINTS) @ integrals_up_to(shares, POINTS).T
    length = pieces.length[:, None]
    near = before[:, None] + length * up_to
    amount = density_at(pieces, shares) * (length * weights)  # (P, points)
    t = pieces.start[:, None] + length * shares
    places = origins[pieces.ray, None] + t[..., None] * directions[pieces.ray, None]
    found = scattered(
        Points(pieces.ray, near, amount, places),
        count,
        columns_to or (lambda places, toward: columns(grid, places, toward)),
        suns,
        lit,
        medium,
        mixing,
    )
    return found, column


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
    sigma_t = np.atleast_1d(medium.sigma_t)  # (1,), or (3,) of a coloured medium
    eyeward = mixing.light_absorption_through_cloud * sigma_t
    for sun, source in zip(suns, lit, strict=True):
        if not source.any():
            continue
        far = columns_to(points.places.reshape(-1, 3), sun.direction)
        far = far.reshape(points.near.shape)
        for channel, sigma in enumerate(sigma_t):
            shown = np.exp(-eyeward[channel] * points.near)
            shown *= reaching(sigma * far, mixing)
            amounts = sigma * (points.amount * shown).sum(axis=1)
            whole = per_ray(points.ray, amounts, count)
            channels = slice(None) if len(sigma_t) == 1 else [channel]
            radiance[:, channels] += source[:, channels] * whole[:, None]
    return radiance


def taken(pieces: Pieces, which: Numbers) -> Pieces:
    """Keep some pieces, or repeat them."""
    return Pieces(
        pieces.ray[which],
        pieces.start[which],
        pieces.length[which],
        pieces.corners[:, which],
        pieces.place[:, which],
        pieces.step[:, which],
    )


def thinner(
    pieces: Pieces, before: Array, mass: Array, rate: float, deepest: float
) -> tuple[Pieces, Array]:
    """Cut pieces that are optically thick, down to where nothing shows.

    Parameters
    ----------
    pieces
        P pieces.
    before, mass
        Columns of density in front of each and within it, shape (P,).
    rate
        Largest extinction per column.
    deepest
        Optical depth behind which nothing shows.

    Returns
    -------
    Pieces of optical depth `THICKEST` at most, and the columns in front of them.
    """
    tau = rate * mass
    if not (tau > THICKEST).any():
        return pieces, before
    # 1. Into how many, and how many of those may show.
    parts = np.ceil(np.maximum(tau / THICKEST, 1.0))
    left = (deepest - rate * before) * parts / np.maximum(tau, THICKEST)
    shown = np.maximum(np.minimum(parts, np.ceil(left)), 1.0).astype(np.intp)
    parent = np.repeat(np.arange(len(tau)), shown)
    number = np.arange(len(parent)) - np.repeat(np.cumsum(shown) - shown, shown)

    # 2. Find where the column within the piece has each part behind it, by halving:
    # only in pieces that are more than one part.
    several = np.flatnonzero(parts[parent] > 1.0)
    whole = taken(pieces, parent)
    thick = taken(whole, several)
    begin, end = np.zeros(len(parent)), np.ones(len(parent))
    for k, found in ((number, begin), (number + 1, end)):
        share = k[several] / parts[parent[several]]
        low, high = np.zeros(len(several)), np.ones(len(several))
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            values = density_at(thick, middle[:, None] * POINTS)
            passed = thick.length * middle * (values @ WEIGHTS)
            beyond = passed > share * mass[parent[several]]
            high = np.where(beyond, middle, high)
            low = np.where(beyond, low, middle)
        inner = np.where(share >= 1.0, 1.0, high)
        found[several] = np.where(k[several] == 0, 0.0, inner)

    # 3. Each part is a piece of its own.
    extent = np.maximum(end - begin, 0.0)
    return Pieces(
        whole.ray,
        whole.start + begin * whole.length,
        extent * whole.length,
        whole.corners,
        whole.place + whole.step * begin,
        whole.step * extent,
    ), before[parent] + number / parts[parent] * mass[parent]
