"""From noise to a cloud map: the paper's generator."""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import checked, complaint
from refcloud.cloudmap.connected import largest_part
from refcloud.cloudmap.cumulus import cumulus_ellipsoids, depth_inside, displace
from refcloud.cloudmap.quadric import evaluate_quadric, modulate, quadric
from refcloud.cloudmap.voxels import MOST_MADE, VoxelGrid, steps_of
from refcloud.conventions import Array, Observer, Range, Seed, Shape, Skipped
from refcloud.frozen import sealed
from refcloud.noise import octave_bound, octave_sum_grid, uniform
from refcloud.noise.weights import PEAKS

# Lengths whose squares and inverse squares stay finite numbers.
SIZE = Range(1e-100, 1e100, "scene units")
Length = Annotated[float, SIZE]

# What each shape takes where the caller says nothing: diameters, voxel edge, cell of
# the coarsest octave. "ellipsoid" gives the paper's 11,000 voxels with t = 0.1.
BY_SHAPE = {
    "cumulus": ((62.0, 34.0, 34.0), 1.4, 10.0),
    "ellipsoid": ((60.0, 34.0, 44.0), 1.0, 16.0),
}
PADDING = 2  # empty cells left around the occupied ones


@checked
def generate(
    shape: Literal["cumulus", "ellipsoid"] = "cumulus",
    *,
    seed: Seed | None = 0,
    diameters: Annotated[Array, Shape(3), SIZE] | None = None,
    voxel: Length | None = None,
    octaves: Annotated[int, Range(1, 32)] = 4,
    persistence: Annotated[float, Range(0.0, 1.0, open_lower=True)] = 0.5,
    cell: Length | None = None,
    interpolant: Literal["linear", "cosine", "cubic", "hermite", "quintic"] = "cosine",
    normalize: Literal["clip", "bound", "none"] = "clip",
    threshold: Annotated[float, Range(0.0, 1.0, open_upper=True)] = 0.1,
    dynamics: Annotated[float, Range(0.0, 1.0, open_lower=True)] = 1.0,
    ellipsoids: Annotated[int, Range(1, 1000)] = 1,
    relief: Annotated[float, Range(0.0, unit="scene units")] = 6.0,
    edge: Annotated[float, Range(0.0, unit="scene units", open_lower=True)] = 1.2,
    observe: Observer | None = None,
) -> VoxelGrid:
    """Generate a cloud map from noise.

    Formula: "ellipsoid" is eq 8 to 10 to the letter with Q the largest of all
    ellipsoids; "cumulus" moves the surface of a pile of ellipsoids by the noise and
    cuts it off at a flat base

    Parameters
    ----------
    shape
        The pile of ellipsoids on a flat base, or the paper's ellipsoid volumes.
    seed
        Chooses the cloud; None (Python only) takes the paper's unseeded hash.
    diameters
        Width, height and depth, scene units; by shape 62 34 34 or 60 34 44.
    voxel
        Edge of a cell, scene units; by shape 1.4 or 1.
    octaves
        Z, number of frequencies in the noise.
    persistence
        s, amplitude of each octave against the one before.
    cell
        Edge of the noise's coarsest cell, scene units; by shape 10 or 16.
    interpolant
        How the noise goes from lattice point to lattice point.
    normalize
        How the sum of octaves is brought to at most 1.
    threshold
        t, products below it are empty; for the ellipsoid shape.
    dynamics
        d, the largest density; for the ellipsoid shape.
    ellipsoids
        How many ellipsoid volumes are united; for the ellipsoid shape.
    relief
        How far the noise moves the surface; for the cumulus shape.
    edge
        Width of the surface's rise from 0 to 1; for the cumulus shape.
    observe
        Called with (name, value) for each intermediate; these are kept whole for it,
        16 bytes a cell.

    Returns
    -------
    The cloud map, cropped to the occupied cells and two empty ones around them; what
    was skipped stands in its `skipped`.

    Raises
    ------
    ValueError
        The grid would have more than 2^25 cells.

    Source: paper M, eq 1 to 10; E11, E15.

    Examples
    --------
    >>> grid = generate(diameters=[20, 11, 11], cell=3, relief=2, voxel=1)
    >>> bool(grid.density.max() <= 1.0)
    True
    """
    size, default_voxel, default_cell = BY_SHAPE[shape]
    diameters = np.array(size) if diameters is None else diameters
    voxel = default_voxel if voxel is None else voxel
    cell = default_cell if cell is None else cell
    watch = observe or (lambda name, value: None)
    # 1. Lay the grid over the ellipsoids' bounds, on whole multiples of the cell.
    centers = radii = np.zeros((0, 3))
    room = 0.0
    quadrics: list[Array] = []
    if shape == "cumulus":
        centers, radii = cumulus_ellipsoids(diameters, seed=seed or 0)
        # The noise moves the surface no farther than its largest value says.
        peak = octave_bound(octaves, persistence) * PEAKS[interpolant] ** 3
        peak = max(peak, 1.0) if normalize == "none" else 1.0
        room = relief * peak + edge
        lower, upper = (centers - radii).min(axis=0), (centers + radii).max(axis=0)
        lower, upper = lower - room, upper + room
        lower[1] = -peak  # the base is flat: nothing lies below -n / 2
    else:
        quadrics, lower, upper = ellipsoid_volumes(diameters, ellipsoids, seed or 0)
    (x, y, z), origin = _lattice(lower, upper, voxel)

    # 2. Some layers at a time: noise (eq 1) with octaves finer than the cells left out,
    # mapped into the ellipsoids.
    density = np.empty((len(z), len(y), len(x)))
    mapped = "depth" if shape == "cumulus" else "quadric"
    names = () if observe is None else ("noise", mapped)
    whole = {name: np.empty_like(density) for name in names}
    skipped: tuple[Skipped, ...] = ()
    for part in steps_of(len(z), len(y) * len(x)):
        noise, skipped = octave_sum_grid(
            x / cell,
            y / cell,
            z[part] / cell,
            seed=seed,
            octaves=octaves,
            persistence=persistence,
            interpolant=interpolant,
            normalize=normalize,
            absolute=False,
            finest=voxel / cell,
        )
        if shape == "cumulus":
            pile = {"centers": centers, "radii": radii, "least": -room}
            inside = depth_inside(x, y, z[part], **pile)
            density[part] = displace(inside, noise, y, relief=relief, edge=edge)
        else:
            inside = _largest_quadric(quadrics, x, y, z[part])
            shares = {"threshold": threshold, "dynamics": dynamics}
            density[part] = modulate(inside, np.abs(noise), **shares)
        for name, value in zip(whole, (noise, inside), strict=False):
            whole[name][part] = value
    for name in names:
        watch(name, whole.pop(name))

    # 3. A cumulus is one piece.
    if shape == "cumulus":
        density = largest_part(density)
    watch("density", density)
    return _cropped(density, origin, voxel, skipped)


def _largest_quadric(quadrics: list[Array], x: Array, y: Array, z: Array) -> Array:
    """Give the largest of several quadrics at every place of a grid."""
    points = np.stack(np.broadcast_arrays(*np.ix_(z, y, x))[::-1], axis=-1)
    Q = evaluate_quadric(quadrics[0], points)
    for q in quadrics[1:]:
        np.maximum(Q, evaluate_quadric(q, points), out=Q)
    return Q


def ellipsoid_volumes(
    diameters: Array, count: int, seed: int
) -> tuple[list[Array], Array, Array]:
    """Place the first ellipsoid at the origin and smaller ones around it."""
    k = np.arange(count)
    size = np.where(k == 0, 1.0, 0.45 + 0.35 * uniform(k, 0, seed=seed))
    around = math.tau * uniform(k, 1, seed=seed)
    out = np.where(k == 0, 0.0, 0.35)
    centers = np.stack(
        [
            out * np.cos(around),
            out * 0.5 * (uniform(k, 2, seed=seed) - 0.3),
            out * np.sin(around),
        ],
        axis=1,
    )
    centers *= diameters
    radii = 0.5 * diameters * size[:, None]
    turn = np.where(k == 0, 0.0, 2.0 * around)
    quadrics = [
        quadric(c, r, turn=float(a) % math.tau)
        for c, r, a in zip(centers, radii, turn, strict=True)
    ]
    # A turned ellipsoid stays inside the sphere of its longest half axis about y.
    reach = np.where(
        np.array([True, False, True]), radii[:, [0, 2]].max(axis=1)[:, None], radii
    )
    reach[0] = radii[0]
    return quadrics, (centers - reach).min(axis=0), (centers + reach).max(axis=0)


def _lattice(
    lower: Array, upper: Array, voxel: float
) -> tuple[tuple[Array, Array, Array], Array]:
    """Give the cells' centres along each axis, and the index of the first cell."""
    with np.errstate(over="ignore", invalid="ignore"):  # too many are refused
        first = np.floor(lower / voxel) - PADDING
        counts = np.ceil(upper / voxel) + PADDING - first
        total = float(np.prod(counts))
    if not total <= MOST_MADE:
        raise ValueError(
            complaint(
                "voxel",
                f"a grid of at most {MOST_MADE} cells",
                f"{total:.3g} cells",
                "choose a larger voxel or a smaller cloud",
            )
        )
    x, y, z = (
        (start + np.arange(int(n)) + 0.5) * voxel
        for start, n in zip(first, counts, strict=True)
    )
    return (x, y, z), first


def _cropped(
    density: Array, origin: Array, voxel: float, skipped: tuple[Skipped, ...]
) -> VoxelGrid:
    """Cut the grid to its occupied cells and the padding around them."""
    occupied = density > 0.0
    ends = []
    for axis, n in enumerate(density.shape):
        others = tuple(k for k in range(3) if k != axis)
        cells = np.flatnonzero(occupied.any(axis=others))
        ends.append((cells[0], cells[-1]) if len(cells) else (n // 2, n // 2))
    first, last = np.array(ends).T
    low = np.maximum(first - PADDING, 0)
    high = np.minimum(last + 1 + PADDING, density.shape)
    lower = (origin + low[::-1]) * voxel
    upper = (origin + high[::-1]) * voxel
    kept = density[tuple(slice(a, b) for a, b in zip(low, high, strict=True))]
    return VoxelGrid(sealed(np.ascontiguousarray(kept)), lower, upper, skipped)
