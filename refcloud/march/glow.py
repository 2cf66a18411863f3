"""Light that was scattered many times, along rays: the solved source, integrated.

    L = int sigma' rho T' J(x, -d) dt

J is kept as few numbers per voxel (`refcloud.transport`). The exact way evaluates them
for every ray's own direction, at Gauss points in every space between voxel centres. The
others make J for directions in a lattice over the view, interpolate it between the
nearest four, and take samples at even distances along a ray.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.cloudmap.sample import clamped_trilinear
from refcloud.conventions import Array
from refcloud.march.box import slabs
from refcloud.march.cells import Lattice, cut, density_at, lattice, most_rays
from refcloud.march.pieces import POINTS, WEIGHTS, taken, thinner
from refcloud.march.quadrature import before_each, integrals_up_to
from refcloud.products import product
from refcloud.transport import ScatteredLight
from refcloud.transport.scattering import harmonics_toward, source_terms

Numbers = NDArray[Any]

MOST_STEPS = 64  # for each voxel that a ray may meet
UP_TO = integrals_up_to(POINTS, POINTS)
SAMPLES = 1 << 19  # at a time: some 100 MB of temporaries
DEEPEST = 16.0  # optical depth behind which less than 1e-7 shows


@dataclass(frozen=True)
class Way:
    """How finely J is sampled.

    Attributes
    ----------
    stride
        Between samples along a ray, of a voxel's shortest edge: samples stand in the
        middle of their stretches, so the error falls with its square.
    apart
        Radians between nodes of direction: J is interpolated linearly, and its error is
        this squared, times about L (L + 1) / 8 of what varies.
    """

    stride: float
    apart: float


@dataclass(frozen=True)
class Samples:
    """Where rays meet density.

    Attributes
    ----------
    ray
        Which ray, ascending, shape (S,).
    points
        Shape (S, 3), scene units.
    column, mass
        Columns of density in front of each sample, and of its own, shape (S,).
    """

    ray: Numbers
    points: Array
    column: Array
    mass: Array


def glow(
    cloud: VoxelGrid,
    origins: Array,
    directions: Array,
    light: ScatteredLight,
    way: Way | None,
) -> Array:
    """Integrate the solved source along rays, unchecked.

    Parameters
    ----------
    cloud
        The cloud map.
    origins, directions
        Shape (N, 3), scene units; unit vectors.
    light
        Solved for this cloud.
    way
        None for Gauss points and every ray's own direction.

    Returns
    -------
    Radiance of shape (N, 3).
    """
    radiance = np.zeros((len(origins), 3))
    if not len(origins) or not cloud.density.any():
        return radiance
    grid = lattice(cloud)
    if way is None:
        terms = source_terms(light)
        chunk = most_rays(grid)
        for start in range(0, len(origins), chunk):
            part = slice(start, start + chunk)
            o, d = origins[part], directions[part]
            samples = _between_centres(grid, o, d, light.sigma_t)
            weights = [harmonics_toward(light, -d, k) for k in range(len(terms))]
            radiance[part] = _sum(light, samples, terms, weights, len(o), thin=True)
        return radiance
    for rays, corners, weights in _tiles(directions, way.apart):
        terms = [
            _toward(harmonics_toward(light, -corners, k), values)
            for k, values in enumerate(source_terms(light))
        ]
        apart = way.stride * float(cell_size(cloud).min())
        across = float(np.sqrt(np.square(cloud.upper - cloud.lower).sum()))
        chunk = max(1, int(SAMPLES / (across / apart + 1.0)))
        for start in range(0, len(rays), chunk):
            part = rays[start : start + chunk]
            samples = by_steps(grid, origins[part], directions[part], apart)
            shares = [weights[start : start + chunk]] * len(terms)
            radiance[part] = _sum(light, samples, terms, shares, len(part), thin=False)
    return radiance


def _toward(harmonics: Array, values: Numbers) -> Numbers:
    """Give terms (R, B, D, H, W) toward directions of harmonics (Q, R)."""
    flat = values.reshape(len(values), -1)
    return product(harmonics, flat).reshape(-1, *values.shape[1:])


def _sum(
    light: ScatteredLight,
    samples: Samples,
    terms: list[Numbers],
    weights: list[Array],
    count: int,
    *,
    thin: bool,
) -> Array:
    """Add up what samples send to the eye; thin ones hold next to no extinction."""
    box = light.upper - light.lower
    cells = (samples.points - light.lower) / (box / np.array(light.shape[::-1])) - 0.5
    radiance = np.zeros((count, 3))
    for kind, (values, shares) in enumerate(zip(terms, weights, strict=True)):
        channels = [c for c, (k, _, _) in enumerate(light.channels) if k == kind]
        sigma = light.sigma_t[channels[0]]
        if thin:
            seen = sigma * samples.mass * np.exp(-sigma * samples.column)
        else:
            seen = np.exp(-sigma * samples.column) * -np.expm1(-sigma * samples.mass)
        for case in range(values.shape[1]):
            table = np.moveaxis(values[:, case], 0, -1)  # (D, H, W, terms)
            found = clamped_trilinear(np.ascontiguousarray(table), *cells.T)
            J = np.einsum("sq,sq->s", found, shares[samples.ray])
            # A cut-off series may dip below 0 where hardly any light is.
            whole = np.bincount(samples.ray, seen * np.maximum(J, 0.0), count)
            for c in channels:
                _, own, factor = light.channels[c]
                if own == case:
                    radiance[:, c] += factor * whole
    return radiance


def _between_centres(
    grid: Lattice, origins: Array, directions: Array, rates: Array
) -> Samples:
    """Take four Gauss points in every piece of a ray, thick ones cut."""
    count = len(origins)
    pieces = cut(grid, origins, directions)
    mass = pieces.length * (density_at(pieces, POINTS) @ WEIGHTS)
    before = before_each(pieces.ray, mass, count)
    seen = np.flatnonzero(rates.min() * before < DEEPEST)
    pieces, before, mass = taken(pieces, seen), before[seen], mass[seen]
    pieces, before = thinner(pieces, before, mass, rates, DEEPEST)
    rho = density_at(pieces, POINTS)
    column = before[:, None] + pieces.length[:, None] * (rho @ UP_TO.T)
    amount = rho * (pieces.length[:, None] * WEIGHTS)
    t = pieces.start[:, None] + pieces.length[:, None] * POINTS
    points = origins[pieces.ray, None] + t[..., None] * directions[pieces.ray, None]
    ray = np.repeat(pieces.ray, len(POINTS))
    return Samples(ray, points.reshape(-1, 3), column.reshape(-1), amount.reshape(-1))


def by_steps(grid: Lattice, origins: Array, directions: Array, apart: float) -> Samples:
    """Take a sample in every stretch of a length, where there is density."""
    place, slope = grid.cells_of(origins), directions / grid.size
    t0, t1 = slabs(place, slope, grid.first, grid.last, np.zeros(len(origins)))
    length = np.maximum(t1 - t0, 0.0)
    # Voxels far flatter than wide would ask for steps without end: a ray meets no more
    # voxels than there are along all axes.
    bound = MOST_STEPS * sum(grid.counts)
    counts = np.ceil(np.minimum(length / apart, bound)).astype(int)
    most = int(counts.max(initial=0))
    stretch = length / np.maximum(counts, 1)
    number = np.arange(most)
    which = number < counts[:, None]
    t = t0[:, None] + (number + 0.5) * stretch[:, None]
    ray, number = np.nonzero(which)
    t = t[ray, number]
    cells = [place[ray, a] + slope[ray, a] * t for a in range(3)]
    space = [
        np.clip(np.floor(c), -1, n - 1).astype(np.intp) + 1
        for c, n in zip(cells, grid.counts, strict=True)
    ]
    keep = np.flatnonzero(grid.occupied[space[2], space[1], space[0]])
    ray, t = ray[keep], t[keep]
    table = grid.values.reshape(grid.counts[::-1])
    rho = clamped_trilinear(table, *(c[keep] for c in cells))
    mass = rho * stretch[ray]
    column = before_each(ray, mass, len(origins))
    return Samples(ray, origins[ray] + t[:, None] * directions[ray], column, mass)


def _tiles(directions: Array, apart: float) -> list[tuple[Numbers, Array, Array]]:
    """Sort rays by direction: which rays, four directions around, weights (n, 4).

    Directions are seen on the face of a cube that they hit; a lattice on each face has
    nodes no farther apart than `apart`.
    """
    tiles = []
    axis = np.argmax(np.abs(directions), axis=1)
    for main in range(3):
        for sign in (-1.0, 1.0):
            rays = np.flatnonzero((axis == main) & (directions[:, main] * sign > 0.0))
            if not len(rays):
                continue
            across = [a for a in range(3) if a != main]
            d = directions[rays]
            at = d[:, across] / np.abs(d[:, main, None])
            low, high = at.min(axis=0), at.max(axis=0)
            steps = np.maximum(np.ceil((high - low) / apart), 1.0).astype(int)
            size = np.maximum((high - low) / steps, 1e-12)
            place = np.minimum(((at - low) / size).astype(int), steps - 1)
            share = (at - low) / size - place
            for j in range(steps[0]):
                for i in range(steps[1]):
                    own = np.flatnonzero((place[:, 0] == j) & (place[:, 1] == i))
                    if not len(own):
                        continue
                    v, u = share[own].T
                    weights = np.stack(
                        [(1 - v) * (1 - u), (1 - v) * u, v * (1 - u), v * u], axis=1
                    )
                    corners = np.empty((4, 3))
                    corners[:, main] = sign
                    nodes = np.array([[j, i], [j, i + 1], [j + 1, i], [j + 1, i + 1]])
                    corners[:, across] = low + nodes * size
                    corners /= np.sqrt(np.square(corners).sum(axis=1, keepdims=True))
                    tiles.append((rays[own], corners, weights))
    return tiles
