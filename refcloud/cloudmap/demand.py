"""Document D's cloud in its box: a texture that is placed there, or noise of the world.

A texture is made once and is stretched with its box. Noise that is fixed in the world
shows more of itself in a larger box, and can end before it meets the walls: a texture
that fills its box to the walls has flat sides there.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from refcloud.checking import checked, complaint
from refcloud.cloudmap.box import spanned
from refcloud.cloudmap.texture import THRESHOLD
from refcloud.cloudmap.voxels import MOST_MADE, VoxelGrid
from refcloud.conventions import Array, Range, Seed, Shape, Vector
from refcloud.frozen import sealed
from refcloud.noise import worley_smooth_grid
from refcloud.noise.worley_smooth import Detail, Octaves

Count = Annotated[int, Range(1, MOST_MADE)]
Length = Annotated[float, Range(1e-100, 1e100, "scene units")]
Edge = (
    Annotated[float, Range(0.0, unit="scene units")]
    | Annotated[Array, Shape(3), Range(0.0, unit="scene units")]
)


@checked
def placed_texture(
    texture: VoxelGrid,
    first: Vector,
    second: Vector,
    *,
    repeats: tuple[Count, Count, Count] = (1, 1, 1),
) -> VoxelGrid:
    """Place a texture in a box, once or side by side.

    Formula: density[k, j, i] = texture[k mod D, j mod H, i mod W]

    Parameters
    ----------
    texture
        A cloud map; of one that tiles no seam shows.
    first, second
        Any two opposite corners of the box, shape (3,), scene units.
    repeats
        How many textures lie side by side along x, y and z; they fill the box.

    Returns
    -------
    The cloud map in that box.

    Raises
    ------
    ValueError
        The box is flat, or there would be more than 2^25 cells.

    Source: document D, Ray and Box intersection (V09, F09).

    Examples
    --------
    >>> cube = VoxelGrid(np.ones((2, 2, 2)), [0, 0, 0], [1, 1, 1])
    >>> placed_texture(cube, [9, 1, 1], [0, 0, 0], repeats=(3, 1, 1)).density.shape
    (2, 2, 6)
    """
    lower, upper = spanned(first, second)
    _refuse_many("repeats", texture.density.size * math.prod(repeats))
    density = np.tile(texture.density, repeats[::-1])
    return VoxelGrid(sealed(density), lower, upper)


@checked
def box_cloud(
    first: Vector,
    second: Vector,
    *,
    voxel: Length,
    cell: Length,
    seed: Seed = 0,
    octaves: Octaves = 3,
    threshold: Annotated[float, Range(0.0, 1.0, open_upper=True)] = THRESHOLD,
    edge: Edge = 0.0,
    detail: Detail = "smooth",
) -> VoxelGrid:
    """Fill a box with cloud from Worley and smooth noise that is fixed in the world.

    Formula: max(remap(worley_smooth(p / cell), 1 - (1 - threshold) c(p), 1, 0, c(p)),
    0) with the coverage c of `box_coverage`

    Parameters
    ----------
    first, second
        Any two opposite corners, shape (3,), scene units.
    voxel
        Edge of a cell of the cloud map, scene units; adjusted so that whole cells fill
        the box.
    cell
        Edge of a cell of the Worley noise, scene units; voxels have nothing to do with
        it.
    seed
        Which pattern.
    octaves
        Octaves of the finer noise.
    threshold
        Level of the noise at which cloud begins in the middle of the box.
    edge
        Distance from the walls within which the cloud thins out to nothing, scene
        units, one number or by axis; 0 leaves it as it is, with flat sides.
    detail
        The finer noise: "smooth", or "gradient", which document D rejected (N32).

    Returns
    -------
    The cloud map, densities in [0, 1].

    Raises
    ------
    ValueError
        The box is flat, or there would be more than 2^25 cells.

    Source: document D, Generating Cloud Textures (N28, N31, V09); the coverage is an
    extension.

    Examples
    --------
    >>> box_cloud([0, 0, 0], [3, 2, 1], voxel=0.5, cell=1).density.shape
    (2, 4, 6)
    """
    lower, upper = spanned(first, second)
    with np.errstate(over="ignore"):  # too many are refused
        counts = np.maximum(np.round((upper - lower) / voxel), 1.0)
        _refuse_many("voxel", float(np.prod(counts)))
    x, y, z = (
        low + (np.arange(int(n)) + 0.5) * ((high - low) / n)
        for low, high, n in zip(lower, upper, counts, strict=True)
    )
    noise = worley_smooth_grid(
        x / cell, y / cell, z / cell, seed=seed, octaves=octaves, detail=detail
    )
    cover = box_coverage(x, y, z, first=lower, second=upper, edge=edge)
    # remap(noise, 1 - w, 1, 0, c) with w = (1 - threshold) c: the slope is the same
    # everywhere, so nothing is divided by a coverage of 0.
    np.subtract(1.0, noise, out=noise)
    noise /= 1.0 - threshold
    np.subtract(cover, noise, out=noise)
    return VoxelGrid(sealed(np.maximum(noise, 0.0, out=noise)), lower, upper)


@checked
def box_coverage(
    x: Annotated[Array, Shape("W")],
    y: Annotated[Array, Shape("H")],
    z: Annotated[Array, Shape("D")],
    *,
    first: Vector,
    second: Vector,
    edge: Edge,
) -> Array:
    """Give how much cloud there may be, from none at a box's walls to all inside.

    Formula: the product over x, y and z of hermite(min(distance to the nearer wall /
    edge, 1)); outside the box 0

    Parameters
    ----------
    x, y, z
        Coordinates along each axis, shapes (W,), (H,), (D,), scene units.
    first, second
        Any two opposite corners, shape (3,), scene units.
    edge
        Distance from the walls at which the coverage is whole, scene units, one number
        or by axis; 0 makes it 1 in the box.

    Returns
    -------
    Shape (D, H, W), in [0, 1].

    Raises
    ------
    ValueError
        The box is flat.

    Source: an extension of document D (V09).

    Examples
    --------
    >>> box = dict(first=[0, 0, 0], second=[4, 1, 1])
    >>> box_coverage([0.5, 1, 2], [0.5], [0.5], edge=0.5, **box)
    array([[[1., 1., 1.]]])
    """
    lower, upper = spanned(first, second)
    shares = []
    edges = np.broadcast_to(edge, (3,))
    for axis, low, high, reach in zip((x, y, z), lower, upper, edges, strict=True):
        inside = np.minimum(axis - low, high - axis)
        if reach > 0.0:
            # Beyond the edge it is 1 however far: nothing large is divided.
            share = np.clip(inside, 0.0, reach) / reach
            shares.append(share * share * (3.0 - 2.0 * share))
        else:
            shares.append(np.where(inside >= 0.0, 1.0, 0.0))
    across, up, along = shares
    return along[:, None, None] * up[:, None] * across


def _refuse_many(name: str, cells: float) -> None:
    """Refuse a grid of too many cells, before it is made."""
    if not cells <= MOST_MADE:
        raise ValueError(
            complaint(name, f"at most {MOST_MADE} cells", f"{cells:.3g} cells")
        )
