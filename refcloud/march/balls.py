"""Single scattering in metaballs, along rays cut where balls begin and end.

Within a piece the same balls overlap, and Wyvill's density is a polynomial of sixth
degree along the ray: its values at seven Gauss points give the optical depth up to any
point of the piece. Depths to the sun, and of whole rays, are chords in closed form; a
sun's rays are parallel, so that cells across them tell which balls one can meet.
"""

from __future__ import annotations

import numpy as np

from refcloud.conventions import Array, Skipped
from refcloud.march.across import across
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
# Share of a tolerance for what fronts hide; the rest is the quadrature's.
FRONT_SHARE = 0.99


def exact_balls(
    balls: Metaballs,
    origins: Array,
    directions: Array,
    suns: tuple[Sun, ...],
    lit: Array,
    medium: Medium,
    mixing: Mixing,
    tolerance: float = 0.0,
) -> tuple[Array, Array, tuple[Skipped, ...]]:
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
    tolerance
        What of a ray's radiance may be lost behind opaque fronts.

    Returns
    -------
    Radiance of shape (N, 3), columns of density of shape (N,), and what was left out.
    """
    radiance = np.zeros((len(origins), 3))
    if not len(balls):
        return radiance, np.zeros(len(origins)), ()
    # 1. Cells of balls across each sun's rays.
    cells = {tuple(sun.direction): across(balls, sun.direction) for sun in suns}
    chords = looked_at = 0

    def columns_to(places: Array, toward: Array) -> Array:
        nonlocal chords, looked_at
        found, pairs = cells[tuple(toward)].columns(places)
        chords += len(places) * len(balls)
        looked_at += pairs
        return found

    # 2. So many rays at a time that their chords fit.
    deepest = deepest_shown(lit, medium, mixing, tolerance)
    pieces = hidden = 0
    most = max(1, OVERLAPS // len(balls))
    for start in range(0, len(origins), most):
        part = slice(start, start + most)
        points, before = _points(balls, origins[part], directions[part], medium, mixing)
        shown = np.flatnonzero(before < deepest)
        pieces, hidden = pieces + len(before), hidden + len(before) - len(shown)
        radiance[part] = scattered(
            points if len(shown) == len(before) else points.taken(shown),
            len(radiance[part]),
            columns_to,
            suns,
            lit[:, part],
            medium,
            mixing,
        )

    # 3. What was left out: of chords toward suns nothing that shows.
    bound = tolerance if hidden else 0.0
    what = "pieces of rays behind an opaque front"
    rows = (
        Skipped("march", what, hidden, pieces, bound),
        Skipped("march", "chords toward suns", chords - looked_at, chords),
    )
    column = columns_of(balls, origins, directions)
    return radiance, column, tuple(row for row in rows if row.skipped)


def deepest_shown(
    lit: Array, medium: Medium, mixing: Mixing, tolerance: float
) -> float:
    """Give the column of density behind which a ray's light is within a tolerance.

    Proved: with k the factor on extinction toward the eye, sigma the smallest
    extinction of a channel and S all suns' light, what lies behind a column c shows at
    most the integral of S sigma exp(-k sigma x) over x > c, that is S exp(-k sigma c) /
    k; a channel of more extinction shows less.

    Parameters
    ----------
    lit
        What each sun sends along each ray, shape (S, N, 3).
    medium, mixing
        Extinction, and factors on optical depths.
    tolerance
        Radiance; 0 hides nothing.

    Returns
    -------
    Density times scene units; infinite where no front is opaque.
    """
    k = mixing.light_absorption_through_cloud
    clearest = k * float(np.min(medium.sigma_t))
    if tolerance == 0.0 or clearest == 0.0:
        return np.inf
    light = float(lit.sum(axis=0).max(initial=0.0)) / k
    opaque = np.log(max(light / (FRONT_SHARE * tolerance), 1.0))
    return float(opaque) / clearest


def _points(
    balls: Metaballs, origins: Array, directions: Array, medium: Medium, mixing: Mixing
) -> tuple[Points, Array]:
    """Choose the points at which light is looked for; tell the columns before them."""
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
    points = Points(
        owner,
        before[:, None] + length[:, None] * (rho @ UP_TO.T),
        density_at(SHARES) * (length[:, None] * AMOUNTS),
        origins[owner, None] + t[..., None] * directions[owner, None],
    )
    return points, before
