"""Single scattering in metaballs, along rays cut where balls begin and end.

Within a piece the same balls overlap, and Wyvill's density is a polynomial of sixth
degree along the ray: its values at seven Gauss points give the optical depth up to any
point of the piece. Depths to the sun, and of whole rays, are chords in closed form.
"""

from __future__ import annotations

import numpy as np

from refcloud.conventions import Array
from refcloud.march.chords import columns_of, met
from refcloud.march.exact import Points, scattered
from refcloud.march.mixing import Mixing
from refcloud.march.pieces import THICKEST
from refcloud.march.quadrature import before_each, gauss, integrals_up_to
from refcloud.metaballs import Metaballs
from refcloud.metaballs.kernels import profile_of
from refcloud.optics import Medium, Sun

POINTS, WEIGHTS = gauss(7)
SHARES, AMOUNTS = gauss(4)
UP_TO = integrals_up_to(SHARES, POINTS)
OVERLAPS = 1 << 16  # pairs of a ray and a ball at a time
MOST_PARTS = 256  # of one ball's chord: beyond tau 128 parts are thick after all
# And so many at least: of a Wyvill ball that is not thick the radiance is then known to
# 1e-8; a Gaussian is no polynomial, and seven points know it to 1e-8 in sixths.
LEAST_PARTS = 6


def exact_balls(
    balls: Metaballs,
    origins: Array,
    directions: Array,
    suns: tuple[Sun, ...],
    lit: Array,
    medium: Medium,
    mixing: Mixing,
) -> tuple[Array, Array]:
    """Integrate rays through metaballs, unchecked.

    Parameters
    ----------
    balls
        The cloud.
    origins, directions
        Shape (N, 3), scene units; unit vectors.
    suns, lit
        The lights, and what each sends along each ray, shape (S, N, 3).
    medium, mixing
        Extinction, and factors on optical depths.

    Returns
    -------
    Radiance of shape (N, 3), and columns of density of shape (N,).
    """
    radiance = np.zeros((len(origins), 3))
    most = max(1, OVERLAPS // max(1, len(balls)))
    for start in range(0, len(origins), most):
        part = slice(start, start + most)
        points = _points(balls, origins[part], directions[part], medium, mixing)
        radiance[part] = scattered(
            points,
            len(radiance[part]),
            lambda places, toward: columns_of(balls, places, toward),
            suns,
            lit[:, part],
            medium,
            mixing,
        )
    return radiance, columns_of(balls, origins, directions)


def _points(
    balls: Metaballs, origins: Array, directions: Array, medium: Medium, mixing: Mixing
) -> Points:
    """Choose the points at which light is looked for."""
    # 1. The chords, from the origin on, in scene units along the ray.
    ray, ball, q, u = met(balls, origins, directions)
    R = balls.radii[ball]
    half = np.sqrt(1.0 - q) * R
    middle = -u * R
    begin, end = np.maximum(middle - half, 0.0), middle + half

    # 2. Cuts: where a chord begins and ends, and so often between that no part is
    # optically thick.
    rate = mixing.light_absorption_through_cloud * float(np.max(medium.sigma_t))
    tau = rate * balls.densities[ball] * (end - begin)
    parts = np.ceil(np.clip(tau / THICKEST, 1.0, MOST_PARTS)).astype(np.intp)
    parts = np.maximum(parts, LEAST_PARTS)
    last = np.cumsum(parts + 1) - 1
    chord = np.repeat(np.arange(len(ray)), parts + 1)
    number = np.arange(len(chord)) - (last - parts)[chord]
    at = begin[chord] + number / parts[chord] * (end - begin)[chord]
    order = np.lexsort((at, ray[chord]))
    place = np.empty(len(order), np.intp)
    place[order] = np.arange(len(order))
    at, owner = at[order], ray[chord][order]

    # 3. A chord covers the pieces from its first cut to its last.
    length = np.diff(at, append=0.0)
    length[np.flatnonzero(np.diff(owner, append=-1))] = 0.0
    first = place[last - parts]
    covered = place[last] - first
    which = np.repeat(np.arange(len(ray)), covered)
    piece = first[which] + np.arange(len(which))
    piece -= np.repeat(np.cumsum(covered) - covered, covered)

    def density_at(shares: Array) -> Array:
        total = np.empty((len(at), len(shares)))
        for k, share in enumerate(shares):
            t = at[piece] + share * length[piece]
            away = ((t - middle[which]) / R[which]) ** 2
            values = balls.densities[ball][which] * profile_of(
                q[which] + away, balls.kernel
            )
            total[:, k] = np.bincount(piece, values, minlength=len(at))
        return total

    # 4. Densities at seven points tell the depth at the four where light is looked for.
    rho = density_at(POINTS)
    before = before_each(owner, length * (rho @ WEIGHTS), len(origins))
    t = at[:, None] + length[:, None] * SHARES
    return Points(
        owner,
        before[:, None] + length[:, None] * (rho @ UP_TO.T),
        density_at(SHARES) * (length[:, None] * AMOUNTS),
        origins[owner, None] + t[..., None] * directions[owner, None],
    )
