"""A cumulus whose surface is carved by Worley noise: billows above, wisps below.

The pile of ellipsoids of `cumulus_ellipsoids` says how much cloud there may be; Worley
noise of a coarse cell, remapped by that, shapes the lumps (document D's remap, N31). A
finer Worley noise then bites into their edges: between its points above the base, which
leaves round billows, and at its points near the base, which leaves wisps.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.cloudmap.connected import largest_part
from refcloud.cloudmap.cumulus import cumulus_ellipsoids, depth_inside
from refcloud.cloudmap.generate import _cropped, _lattice
from refcloud.cloudmap.voxels import VoxelGrid
from refcloud.conventions import (
    Array,
    Observer,
    Positive,
    Range,
    Seed,
    Shape,
    Skipped,
)
from refcloud.noise import octave_frame, worley_grid

OCTAVES, PERSISTENCE = 3, 0.4
# The sum of octaves lies between these but for 2 of 10,000 places below and none seen
# above: they become 0 and 1.
LOWEST, HIGHEST = 0.12, 0.93
MEAN = 0.48  # of an octave
SIZES = Range(1e-100, 1e100, "scene units")
Length = Annotated[float, SIZES]
Cover = Annotated[float, Range(0.0, 1.0)]
Erosion = Annotated[float, Range(0.0, 1.0, open_upper=True)]
DIAMETERS = (62.0, 34.0, 34.0)
RISE, BASE, FOOT = 5.0, 6.0, 1.5  # of a pile of these diameters, scene units
ROOM = 1 << 21  # cells in one step: tables of 16 MB


@checked
def lumps_grid(
    x: Annotated[Array, Shape("W")],
    y: Annotated[Array, Shape("H")],
    z: Annotated[Array, Shape("D")],
    *,
    seed: Seed = 0,
    finest: Annotated[float, Range(0.0)] = 0.0,
) -> tuple[Array, tuple[Skipped, ...]]:
    """Give the lumps that Worley noise turned over makes, three octaves of them.

    Formula: (sum of s^i (1 - min(F1(2^i p), 1)) / sum of s^i - lowest) / (highest -
    lowest) for i < 3, s = 0.4, cut at 0 and 1; of octaves with 2^-i < finest the mean

    Parameters
    ----------
    x, y, z
        Coordinates along each axis, shapes (W,), (H,), (D,), in cells of the first
        octave.
    seed
        Which pattern.
    finest
        Octaves of smaller cells are left out, in cells of the first; they could not be
        displayed, and would show as grain.

    Returns
    -------
    Shape (D, H, W), in [0, 1]: 1 in the middle of lumps. And what was left out.

    Source: document D (N26, N28), in octaves; paper M (N16); an extension.

    Examples
    --------
    >>> lumps_grid([0.0, 0.5], [0.0], [0.0], seed=7)[0].shape
    (1, 1, 2)
    """
    total = np.zeros((len(z), len(y), len(x)))
    weights = PERSISTENCE ** np.arange(OCTAVES)
    weights /= weights.sum()
    fine = [i for i in range(OCTAVES) if 2.0**-i < finest]
    for i, weight in enumerate(weights):
        if i in fine:
            total += weight * MEAN
            continue
        own, shift = octave_frame(i, seed=seed)
        axes = [2.0**i * axis + s for axis, s in zip((x, y, z), shift, strict=True)]
        far = worley_grid(*axes, seed=own or 0, normalize="clip")
        total += weight * (1.0 - far)
    lumps = np.clip((total - LOWEST) / (HIGHEST - LOWEST), 0.0, 1.0)
    if not fine:
        return lumps, ()
    lost = weights[fine].sum() * (1.0 - MEAN) / (HIGHEST - LOWEST)
    what = "noise", "octaves too fine to show"
    return lumps, (Skipped(*what, len(fine), OCTAVES, min(float(lost), 1.0), "lumps"),)


@checked
def carve(
    depth: Annotated[Array, Shape("D", "H", "W")],
    lumps: Annotated[Array, Shape("D", "H", "W"), Range(0.0, 1.0)],
    detail: Annotated[Array, Shape("D", "H", "W"), Range(0.0, 1.0)],
    y: Annotated[Array, Shape("H")],
    *,
    rise: Length = RISE,
    cover: Cover = 0.55,
    erosion: Erosion = 0.35,
    base: Length = BASE,
    foot: Length = FOOT,
    gain: Annotated[float, Positive] = 5.0,
) -> Array:
    """Shape a cloud out of a depth by two kinds of lumps.

    Formula: c = depth / rise + cover in [0, 1.25]; b = remap(lumps, 1 - c, 1, 0, 1);
    u = y / base; e = erosion ((1 - detail) u + detail (1 - u)); D = min(gain remap(b,
    e, 1, 0, 1) y / foot, 1); all of b, u, y / foot and the last remap in [0, 1]

    Parameters
    ----------
    depth
        How deep each place lies in the pile of ellipsoids, shape (D, H, W), scene
        units.
    lumps, detail
        Coarse and fine lumps, shape (D, H, W), in [0, 1].
    y
        Height over the base, shape (H,), scene units.
    rise
        Depth over which the coverage c rises by 1, scene units.
    cover
        The coverage on the surface of the ellipsoids.
    erosion
        How far the fine lumps bite into the coarse ones.
    base
        Height from which on the fine lumps leave billows instead of wisps, scene units.
    foot
        Height over which the flat base begins, scene units.
    gain
        How fast the density rises to 1 behind the surface.

    Returns
    -------
    Density, shape (D, H, W), in [0, 1].

    Source: document D's remap (N31), after Häggström; an extension.

    Examples
    --------
    >>> carve([[[9.0, -9.0]]], [[[0.5, 0.5]]], [[[0.5, 0.5]]], [3.0])
    array([[[1., 0.]]])
    """
    above = y[None, :, None]
    c = np.clip(depth / rise + cover, 0.0, 1.25)
    # remap(lumps, 1 - c, 1, 0, 1), as 1 less the gap's share of c: where that is over 1
    # the lumps end, and nothing is divided by a coverage of 0.
    gap = 1.0 - lumps
    inside = gap < c
    b = np.where(inside, 1.0 - gap / np.where(inside, c, 1.0), 0.0)
    u = np.clip(above / base, 0.0, 1.0)
    e = erosion * ((1.0 - detail) * u + detail * (1.0 - u))
    left = np.clip((b - e) / (1.0 - e), 0.0, 1.0)
    return np.minimum(gain * left * np.clip(above / foot, 0.0, 1.0), 1.0)


@checked
def billows(
    *,
    seed: Seed = 0,
    diameters: Annotated[Array, Shape(3), SIZES] | None = None,
    voxel: Length = 0.7,
    lump: Length = 7.5,
    grain: Length = 1.125,
    cover: Cover = 0.55,
    erosion: Erosion = 0.35,
    observe: Observer | None = None,
) -> VoxelGrid:
    """Generate a cumulus of billows on a flat base.

    Formula: `carve` of the depth in `cumulus_ellipsoids`, by `lumps_grid` of two cells

    Parameters
    ----------
    seed
        Chooses the cloud: its ellipsoids, and the noise that carves them.
    diameters
        Width, height and depth of the pile, shape (3,), scene units; 62 34 34 by
        default. The lengths of `carve` go with the width.
    voxel
        Edge of a cell of the cloud map, scene units.
    lump, grain
        Edges of the cells of the coarse and of the fine lumps, scene units.
    cover
        The coverage on the surface of the ellipsoids.
    erosion
        How far the fine lumps bite into the coarse ones.
    observe
        Called with ("layers", (how many are done, of how many)) after each step.

    Returns
    -------
    The cloud map; its base is the plane y = 0. Octaves finer than a voxel are left
    out, which stands in its `skipped`.

    Raises
    ------
    ValueError
        The grid would have more than 2^25 cells.

    Source: document D (N31, V09) on the shape of paper M's clouds (V05); an extension.

    Examples
    --------
    >>> billows(diameters=[20, 11, 11], voxel=2, lump=3, grain=1).density.max() <= 1
    np.True_
    """
    diameters = np.array(DIAMETERS) if diameters is None else diameters
    # Lengths of the carving go with the size of the pile.
    scale = float(diameters[0]) / DIAMETERS[0]
    lengths = {"rise": RISE * scale, "base": BASE * scale, "foot": FOOT * scale}
    watch = observe or (lambda name, value: None)
    # 1. Lay the grid over the ellipsoids and as far around as there can be coverage.
    centers, radii = cumulus_ellipsoids(diameters, seed=seed)
    room = lengths["rise"] * cover
    lower = (centers - radii).min(axis=0) - room
    lower[1] = 0.0
    upper = (centers + radii).max(axis=0) + room
    (x, y, z), origin = _lattice(lower, upper, voxel)
    # 2. Some layers at a time, and of those the part that has coverage.
    density = np.zeros((len(z), len(y), len(x)))
    skipped: tuple[Skipped, ...] = ()
    thick = max(1, ROOM // (len(y) * len(x)))
    for first in range(0, len(z), thick):
        layers = np.arange(first, min(first + thick, len(z)))
        pile = {"centers": centers, "radii": radii, "least": -room}
        depth = depth_inside(x, y, z[layers], **pile)
        covered = depth > -room
        k, j, i = (
            np.flatnonzero(covered.any(axis=a)) for a in ((1, 2), (0, 2), (0, 1))
        )
        if not len(k):
            continue
        places = x[i], y[j], z[layers[k]]
        (lumps, rows), (detail, more) = (
            lumps_grid(*(axis / cell for axis in places), seed=own, finest=voxel / cell)
            for cell, own in ((lump, seed), (grain, ~seed))
        )
        skipped = (*rows, *more)  # the same in every step
        density[np.ix_(layers[k], j, i)] = carve(
            depth[np.ix_(k, j, i)],
            lumps,
            detail,
            y[j],
            erosion=erosion,
            cover=cover,
            **lengths,
        )
        watch("layers", (int(layers[-1]) + 1, len(z)))
    # 3. Lumps that came off hang in the air as beads: keep the largest part alone.
    density *= _largest_mask(density)
    return _cropped(density, origin, voxel, skipped)


def _largest_mask(density: Array) -> NDArray[np.bool_]:
    """Mark the largest part of what blocks of 2 x 2 x 2 cells tell apart."""
    # Blocks have an eighth of the cells, and the search is what takes time.
    padded = np.pad(density, [(0, n % 2) for n in density.shape])
    blocks = np.maximum(padded[::2], padded[1::2])
    blocks = np.maximum(blocks[:, ::2], blocks[:, 1::2])
    blocks = np.maximum(blocks[:, :, ::2], blocks[:, :, 1::2])
    mask = largest_part(blocks) > 0.0
    for axis in range(3):
        mask = np.repeat(mask, 2, axis=axis)
    return mask[tuple(slice(n) for n in density.shape)]
