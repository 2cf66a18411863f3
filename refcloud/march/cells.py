"""Rays cut where the density between voxel centres changes its formula.

Trilinear density has its kinks in the planes through voxel centres. Between two of them
it is a polynomial of third degree along a ray, so that a few samples tell all of it.
Pieces that lie between eight empty centres hold nothing and are left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.conventions import Array
from refcloud.march.box import slabs

Numbers = NDArray[np.integer]
CUTS = 1 << 19  # cuts at a time: 4 MB for each temporary


@dataclass(frozen=True)
class Lattice:
    """A cloud map in cells: centre i of an axis has coordinate i.

    Attributes
    ----------
    values
        The density as one row of cells, shape (D H W,).
    counts
        W, H, D.
    lower, upper, size
        Corners of the box, and edges of a cell, shape (3,), scene units.
    occupied
        Shape (D + 1, H + 1, W + 1): whether any centre around the space between
        centres i - 1 and i holds density.
    first, last
        The part of the box, in cells, outside which all is empty, shape (3,).
    reaches_faces
        Whether there is density on a face of the box.
    """

    values: Array
    counts: tuple[int, int, int]
    lower: Array
    upper: Array
    size: Array
    occupied: NDArray[np.bool_]
    first: Array
    last: Array
    reaches_faces: bool

    def cells_of(self, points: Array) -> Array:
        """Turn points into coordinates in cells, shape (..., 3)."""
        return (points - self.lower) / self.size - 0.5


@dataclass(frozen=True)
class Pieces:
    """Pieces of rays, each within one space between eight centres.

    Attributes
    ----------
    ray
        Which ray, ascending, shape (P,).
    start, length
        From where on, and how long, shape (P,), scene units along the ray.
    corners
        The eight centres' densities, x fastest, shape (8, P).
    place, step
        Where the piece begins, in shares of the space, and how far it goes, (3, P).
    """

    ray: Numbers
    start: Array
    length: Array
    corners: Array
    place: Array
    step: Array


def lattice(grid: VoxelGrid) -> Lattice:
    """Prepare a cloud map for cutting."""
    density = np.ascontiguousarray(grid.density)
    counts = density.shape[2], density.shape[1], density.shape[0]
    occupied = spaces_around(density > 0.0)
    first, last = np.empty(3), np.empty(3)
    for axis, n in enumerate(counts):
        across = tuple(k for k in range(3) if k != 2 - axis)
        where = np.flatnonzero(occupied.any(axis=across))
        # Space i lies between centres i - 1 and i; the outer ones are half as wide.
        low, high = (where[0] - 1, where[-1]) if len(where) else (0, 0)
        first[axis], last[axis] = max(low, -0.5), min(high, n - 0.5)
    return Lattice(
        density.reshape(-1),
        counts,
        grid.lower,
        grid.upper,
        cell_size(grid),
        occupied,
        first,
        last,
        bool((first == -0.5).any() or (last == np.array(counts) - 0.5).any()),
    )


def cropped(grid: VoxelGrid) -> VoxelGrid:
    """Cut a cloud map down to what is occupied, and one empty layer around it."""
    occupied = grid.density > 0.0
    size, lower, upper = cell_size(grid), grid.lower.copy(), grid.upper.copy()
    box = [slice(None)] * 3
    for axis, n in enumerate(grid.density.shape[::-1]):
        across = tuple(k for k in range(3) if k != 2 - axis)
        where = np.flatnonzero(occupied.any(axis=across))
        if not len(where):
            return grid
        first, last = max(where[0] - 1, 0), min(where[-1] + 2, n)
        box[2 - axis] = slice(first, last)
        lower[axis] += first * size[axis]
        upper[axis] -= (n - last) * size[axis]
    return VoxelGrid(grid.density[tuple(box)], lower, upper)


def spaces_around(marked: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Mark the spaces between centres that touch a marked centre.

    Parameters
    ----------
    marked
        Shape (D, H, W).

    Returns
    -------
    Shape (D + 1, H + 1, W + 1).
    """
    for axis in range(3):
        wide = np.pad(marked, [(int(axis == k), int(axis == k)) for k in range(3)])
        low, high = [slice(None)] * 3, [slice(None)] * 3
        low[axis], high[axis] = slice(None, -1), slice(1, None)
        marked = wide[tuple(low)] | wide[tuple(high)]
    return marked


def most_rays(grid: Lattice) -> int:
    """Give how many rays can be cut at a time."""
    return max(1, CUTS // (sum(grid.counts) + 2))


def cut(
    grid: Lattice,
    origins: Array,
    directions: Array,
    toward: Sequence[Array] = (),
) -> Pieces:
    """Cut rays into pieces; `most_rays` of them at a time.

    Parameters
    ----------
    grid
        The cloud map.
    origins, directions
        Shape (N, 3), scene units; unit vectors.
    toward
        Of each sun: where its light passes an edge of the box the depth has a kink.

    Returns
    -------
    The pieces that may hold density, ray by ray from the origin on.
    """
    # 1. Parameters count from the place nearest to the box: a far eye costs no digits.
    middle = grid.lower + 0.5 * grid.size * np.array(grid.counts)
    shift = ((middle - origins) * directions).sum(axis=1)
    place = grid.cells_of(origins + shift[:, None] * directions)
    slope = directions / grid.size

    # 2. Enter, every plane through centres, leave; sorted. What lies outside is moved
    # to an end, where it makes pieces of no length.
    t0, t1 = slabs(place, slope, grid.first, grid.last, -shift)
    # Beside a face a last bit decides: it is the caller's numbers that tell.
    beside = (directions == 0.0) & ((origins < grid.lower) | (origins > grid.upper))
    t1 = np.where(beside.any(axis=1), t0, t1)
    t = [t0[:, None], t1[:, None]]
    for axis in range(3):
        planes = np.arange(np.ceil(grid.first[axis]), np.floor(grid.last[axis]) + 1.0)
        speed = slope[:, axis, None]
        moving = speed != 0.0
        with np.errstate(over="ignore"):
            at = (planes - place[:, axis, None]) / np.where(moving, speed, 1.0)
        t.append(_held(np.where(moving, at, t0[:, None]), t0, t1))
    for sun in toward if grid.reaches_faces else ():
        t.append(_held(_past_edges(grid, place, slope, sun / grid.size), t0, t1))
    cuts = np.sort(np.concatenate(t, axis=1), axis=1)
    length = np.diff(cuts, axis=1)
    ray, which = np.nonzero(length > 0.0)
    start, length = cuts[ray, which], length[ray, which]

    # 3. The middle of a piece tells which space it lies in.
    begin = [place[ray, axis] + slope[ray, axis] * start for axis in range(3)]
    step = [slope[ray, axis] * length for axis in range(3)]
    space = []
    for axis, n in enumerate(grid.counts):
        inside = np.floor(begin[axis] + 0.5 * step[axis])
        space.append(np.clip(inside, -1, n - 1).astype(np.intp))
    keep = np.flatnonzero(grid.occupied[space[2] + 1, space[1] + 1, space[0] + 1])
    space = [axis[keep] for axis in space]
    return Pieces(
        ray[keep],
        start[keep] + shift[ray[keep]],
        length[keep],
        corners_of(grid, space),
        np.stack([begin[axis][keep] - space[axis] for axis in range(3)]),
        np.stack([step[axis][keep] for axis in range(3)]),
    )


def _held(t: Array, t0: Array, t1: Array) -> Array:
    return np.minimum(np.maximum(t, t0[:, None]), t1[:, None])


def _past_edges(grid: Lattice, place: Array, slope: Array, sun: Array) -> Array:
    """Find where rays cross the planes that hold an edge of the box and the sun's way.

    Between them the light enters through one face, and the depth is smooth; in cells.
    """
    found = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        # Across the edge and the sun: (u, v) times (sun_v, -sun_u) is one number.
        speed = (slope[:, u] * sun[v] - slope[:, v] * sun[u])[:, None]
        moving = speed != 0.0
        edges = np.array(
            [
                a * sun[v] - b * sun[u]
                for a in (-0.5, grid.counts[u] - 0.5)
                for b in (-0.5, grid.counts[v] - 0.5)
            ]
        )
        ahead = edges - (place[:, u] * sun[v] - place[:, v] * sun[u])[:, None]
        with np.errstate(over="ignore"):
            at = ahead / np.where(moving, speed, 1.0)
        found.append(np.where(moving, at, -np.inf))
    return np.concatenate(found, axis=1)


def corners_of(grid: Lattice, space: list[Numbers]) -> Array:
    """Read the eight centres around spaces; beyond the outermost there is its copy.

    Parameters
    ----------
    grid
        The cloud map.
    space
        Along x, y and z, shape (P,) each: the lower centre, -1 before the first.

    Returns
    -------
    Shape (8, P), x fastest.
    """
    near = [np.maximum(axis, 0) for axis in space]
    far = [
        np.minimum(axis + 1, n - 1) for axis, n in zip(space, grid.counts, strict=True)
    ]
    W, H, _ = grid.counts
    corners = np.empty((8, len(space[0])))
    for corner in range(8):
        x, y, z = ((far if corner >> axis & 1 else near)[axis] for axis in range(3))
        grid.values.take((z * H + y) * W + x, out=corners[corner])
    return corners


def density_at(pieces: Pieces, shares: Array) -> Array:
    """Evaluate the density along pieces.

    Parameters
    ----------
    pieces
        P pieces.
    shares
        Where on the piece, 0 to 1, shape (K,), or (P, K).

    Returns
    -------
    Shape (P, K).
    """
    values = [corner[:, None] for corner in pieces.corners]
    for axis in range(3):
        u = pieces.place[axis][:, None] + pieces.step[axis][:, None] * shares
        values = [
            a + (b - a) * u for a, b in zip(values[::2], values[1::2], strict=True)
        ]
    return values[0]
