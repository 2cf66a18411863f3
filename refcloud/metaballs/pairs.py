"""Every pair of a voxel and a ball that covers it: the sparse form of the fit.

The fit works on a `Work`: the occupied part of a cloud map in units of the mean cell
edge, densities scaled to 1. Cells need not be cubes: positions are scaled by one
number, the geometric mean of the edges, so that balls stay balls. The box of voxels
that a fit sees reaches as far as the balls do; outside the cloud all are empty, and
counting them is what keeps the balls from bleeding.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.cloudmap.voxels import VoxelGrid, cell_size
from refcloud.conventions import Array
from refcloud.metaballs.balls import mean_edge
from refcloud.metaballs.kernels import Kernel, profile_of

Numbers = NDArray[np.integer]

# Edges that differ by less count as equal: an offset of 1e6 edges leaves such rounding.
EQUAL_EDGES = 1e-6
# Pairs of voxel and ball take about 100 bytes each: 1.6 GB, the most a fit may use.
MOST_PAIRS = 1 << 24
# Cells of the box that the balls reach over: 270 MB of float64.
MOST_CELLS = 1 << 25
# Radii are listed so much wider, that rounding leaves out no voxel; q then decides.
WIDER = 1.0 + 1e-12


@dataclass(frozen=True)
class Work:
    """The occupied part of a cloud map, in mean cell edges and shares of the peak.

    Attributes
    ----------
    density
        Shape (D, H, W) as ``[z, y, x]``, 0 to 1, cropped to the occupied voxels.
    edges
        Edges of a cell along x, y, z, their product 1.
    origin
        Centre of the first voxel, scene units.
    edge
        Mean cell edge, scene units.
    peak
        The largest density.
    voxels
        Number of occupied voxels of the cloud map, also where the grid is coarser.
    joined
        How many voxels' edges a cell's edge is: 1 on the voxels themselves.
    """

    density: Array
    edges: Array
    origin: Array
    edge: float
    peak: float
    voxels: int
    joined: int = 1

    @functools.cached_property
    def positions(self) -> Array:
        """The occupied voxels' centres, shape (K, 3) as x, y, z."""
        z, y, x = np.nonzero(self.density > 0.0)
        return np.stack([x, y, z], axis=1) * self.edges


@dataclass(frozen=True)
class Pairs:
    """Pairs of voxel and ball, those of one ball after one another.

    Attributes
    ----------
    voxel
        Their voxels' numbers, shape (P,).
    away
        Voxel minus centre, shape (3, P).
    q
        Squared ratio of distance and radius, below 1, shape (P,).
    value
        The kernel there, shape (P,).
    starts, owners, lengths
        First pair of each ball that has any, which ball, how many pairs, shape (B,).
    count
        Number of balls N.
    target
        Density of all voxels of the box, empty ones included.
    shape, corner
        Of the box, and where the cloud's first voxel stands in it, as z, y, x.
    """

    voxel: Numbers
    away: Array
    q: Array
    value: Array
    starts: Numbers
    owners: Numbers
    lengths: Numbers
    count: int
    target: Array
    shape: tuple[int, int, int]
    corner: tuple[int, int, int]

    @property
    def ball(self) -> Numbers:
        """The pairs' balls' numbers, shape (P,)."""
        return np.repeat(self.owners, self.lengths)

    def forward(self, heights: Array) -> Array:
        """Sum the balls at each voxel: the design matrix times the heights."""
        return self.by_voxel(self.value * self.spread(heights))

    def backward(self, residual: Array) -> Array:
        """Sum voxels over each ball: the transposed design matrix times a residual."""
        return self.by_ball(self.value * residual[self.voxel])

    def spread(self, numbers: Array) -> Array:
        """Give each pair its ball's numbers, (..., N) to (..., P)."""
        # A ball's pairs lie together: repeating is many times faster than look-ups.
        return np.repeat(numbers[..., self.owners], self.lengths, axis=-1)

    def by_voxel(self, numbers: Array) -> Array:
        """Sum numbers of pairs, shape (P,), to numbers of voxels."""
        total = np.bincount(self.voxel, numbers, minlength=len(self.target))
        return total.astype(np.float64, copy=False)

    def by_ball(self, numbers: Array) -> Array:
        """Sum numbers of pairs, shape (..., P), to numbers of balls, (..., N)."""
        total = np.zeros((*numbers.shape[:-1], self.count))
        if len(self.starts):
            sums = np.add.reduceat(numbers, self.starts, axis=-1)
            total[..., self.owners] = sums
        return total


def prepare(grid: VoxelGrid) -> Work | None:
    """Crop a cloud map to its occupied voxels and scale it; None where it is empty."""
    where = np.argwhere(grid.density > 0.0)
    if not len(where):
        return None
    first, last = where.min(axis=0), where.max(axis=0) + 1
    box = tuple(slice(a, b) for a, b in zip(first, last, strict=True))
    size = cell_size(grid)
    edge = mean_edge(size)
    edges = size / edge
    if edges.max() - edges.min() < EQUAL_EDGES:
        edges = np.ones(3)
    peak = float(grid.density.max())
    origin = grid.lower + (first[::-1] + 0.5) * size
    return Work(grid.density[box] / peak, edges, origin, edge, peak, len(where))


def list_pairs(work: Work, centers: Array, radii: Array, kernel: Kernel) -> Pairs:
    """List all pairs with |voxel - centre| < R, ball after ball."""
    _refuse_too_many(radii)
    low, shape, target = _box(work, centers, radii)
    voxel, away, every = _voxels_of(work.edges, low, shape, centers, radii)
    q = np.einsum("ij,ij->j", away, away)
    q /= np.repeat(radii**2, every)
    near = q < 1.0
    if not near.all():  # voxels on the rim, to a rounding
        ball = np.repeat(np.arange(len(radii)), every)[near]
        voxel, away, q = voxel[near], away[:, near], q[near]
        every = np.bincount(ball, minlength=len(radii))
    owners = np.flatnonzero(every)
    lengths = every[owners]
    return Pairs(
        voxel=voxel,
        away=away,
        q=q,
        value=profile_of(q, kernel),
        starts=np.cumsum(lengths) - lengths,
        owners=owners,
        lengths=lengths,
        count=len(radii),
        target=target.ravel(),
        shape=shape,
        corner=(int(-low[2]), int(-low[1]), int(-low[0])),
    )


def _voxels_of(
    edges: Array,
    low: Array,
    shape: tuple[int, int, int],
    centers: Array,
    radii: Array,
) -> tuple[Numbers, Array, Numbers]:
    """List the voxels of balls: their numbers, voxel minus centre, and each ball's.

    A ball is slices, a slice is rows, a row is voxels: each step cuts what it has into
    the cells of one axis that the rest of R^2 reaches. Cells are longest along the
    first axis and shortest along the last, so that few slices and rows hold no voxel.
    """
    strides = (1, shape[2], shape[1] * shape[2])
    ball = np.arange(len(radii))
    flat = np.zeros(len(radii), dtype=np.intp)
    away = np.zeros((3, len(radii)))
    counts = np.zeros(0, dtype=np.intp)
    for turn, axis in enumerate(np.argsort(edges, kind="stable")[::-1]):
        if turn:
            ball = np.repeat(ball, counts)
        # 1. The cells on this axis within sqrt(R^2 - what the axes before have used).
        middle = centers[ball, axis]
        used = np.einsum("ij,ij->j", away, away)
        reach = np.sqrt(np.maximum((WIDER * radii[ball]) ** 2 - used, 0.0))
        first = np.ceil((middle - reach) / edges[axis])
        last = np.floor((middle + reach) / edges[axis])
        counts = np.maximum(last - first + 1.0, 0.0).astype(np.intp)
        # 2. One entry for each of them, counted from 0.
        ends = np.cumsum(counts)
        step = np.arange(counts.sum())
        step -= np.repeat(ends - counts, counts)
        # 3. Where it is: its distance, and its number in a flat [z, y, x] array.
        away = np.repeat(away, counts, axis=1)
        away[axis] = step
        away[axis] *= edges[axis]
        away[axis] += np.repeat(first * edges[axis] - middle, counts)
        step *= strides[axis]
        corner = flat + (first - low[axis]).astype(np.intp) * strides[axis]
        flat = np.repeat(corner, counts)
        flat += step
    return flat, away, np.bincount(ball, counts, len(radii)).astype(np.intp)


def _refuse_too_many(radii: Array) -> None:
    """Refuse balls that cover more voxels together than memory should hold."""
    largest = float(radii.max(initial=0.0))
    covered = 4.0 / 3.0 * math.pi * float(np.sum((radii / max(largest, 1.0)) ** 3))
    covered *= max(largest, 1.0) ** 3
    if not max(covered, (2.0 * largest) ** 3) <= MOST_PAIRS:
        raise ValueError(
            "overlap or least_radius: expected balls that cover at most"
            f" {MOST_PAIRS} voxels together, got {covered:.3g};"
            " lower overlap or least_radius, or use larger voxels"
        )


def _box(
    work: Work, centers: Array, radii: Array
) -> tuple[Array, tuple[int, int, int], Array]:
    """Find the box of voxels that holds the cloud and all balls, and fill it."""
    cells = np.array(work.density.shape[::-1])
    reach = radii[:, None]
    low = np.floor((centers - reach) / work.edges).min(axis=0)
    high = np.ceil((centers + reach) / work.edges).max(axis=0) + 1
    low, high = np.minimum(low, 0.0), np.maximum(high, cells)
    count = float(np.prod(high - low))
    if not count <= MOST_CELLS:
        raise ValueError(
            f"grid: expected balls that reach over a box of at most {MOST_CELLS} cells,"
            f" got {count:.3g}; ask for more balls or larger voxels"
        )
    width, height, length = (int(n) for n in high - low)
    target = np.zeros((length, height, width))
    x, y, z = (int(-n) for n in low)
    deep, tall, wide = work.density.shape
    target[z : z + deep, y : y + tall, x : x + wide] = work.density
    return low, target.shape, target
