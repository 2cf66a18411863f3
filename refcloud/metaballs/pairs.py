"""Every pair of a voxel and a ball that covers it: the sparse form of the fit.

The fit works on a `Work`: the occupied part of a cloud map in units of the mean cell
edge, densities scaled to 1. Cells need not be cubes: positions are scaled by one
number, the geometric mean of the edges, so that balls stay balls. The box of voxels
that a fit sees reaches as far as the balls do; outside the cloud all are empty, and
counting them is what keeps the balls from bleeding.
"""

from __future__ import annotations

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
# Balls whose radii differ by less than this factor share one stencil of voxels.
STENCIL_STEP = 1.15
# Pairs of voxel and ball take about 100 bytes each: 1.6 GB, the most a fit may use.
MOST_PAIRS = 1 << 24
# Cells of the box that the balls reach over: 270 MB of float64.
MOST_CELLS = 1 << 25
# Entries of a stencil times balls that are listed at a time: 8 MB for each temporary.
BLOCK = 1 << 20


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

    def positions(self) -> Array:
        """Give the occupied voxels' centres, shape (K, 3) as x, y, z."""
        z, y, x = np.nonzero(self.density > 0.0)
        return np.stack([x, y, z], axis=1) * self.edges


@dataclass(frozen=True)
class Pairs:
    """Pairs of voxel and ball, those of one ball after one another.

    Attributes
    ----------
    voxel, ball
        Their numbers, shape (P,).
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
    ball: Numbers
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
    base = np.rint(centers / work.edges)  # (N, 3) the voxel nearest to each centre
    inside = centers - base * work.edges  # at most half an edge
    corner = _flat(base - low, shape)
    voxels: list[Numbers] = []
    members: list[Numbers] = []
    places: list[Array] = []  # (4, ...): voxel minus centre, and q
    steps = np.ceil(np.log(radii) / np.log(STENCIL_STEP))
    for step in np.unique(steps):
        alike = np.flatnonzero(steps == step)
        offsets = _stencil(work.edges, float(radii[alike].max()))  # (S, 3)
        shift = _flat(offsets, shape)
        reach = (offsets * work.edges).T  # (3, S)
        rows = max(1, BLOCK // len(offsets))
        for start in range(0, len(alike), rows):
            some = alike[start : start + rows]
            x, y, z = (
                reach[axis] - inside[some, axis, None] for axis in range(3)
            )  # (B, S)
            q = (x * x + y * y + z * z) / (radii[some] ** 2)[:, None]
            near = q < 1.0
            flat = np.flatnonzero(near)
            row = np.repeat(np.arange(len(some)), np.count_nonzero(near, axis=1))
            column = flat - row * len(offsets)
            places.append(np.stack([part.ravel()[flat] for part in (x, y, z, q)]))
            members.append(some[row])
            voxels.append(corner[some[row]] + shift[column])
    ball, place = np.concatenate(members), np.concatenate(places, axis=1)
    starts = np.flatnonzero(np.diff(ball, prepend=-1))
    return Pairs(
        voxel=np.concatenate(voxels),
        ball=ball,
        away=place[:3],
        q=place[3],
        value=profile_of(place[3], kernel),
        starts=starts,
        owners=ball[starts],
        lengths=np.diff(starts, append=len(ball)),
        count=len(radii),
        target=target.ravel(),
        shape=shape,
        corner=(int(-low[2]), int(-low[1]), int(-low[0])),
    )


def _refuse_too_many(radii: Array) -> None:
    """Refuse balls that cover more voxels together than memory should hold."""
    largest = float(radii.max(initial=0.0))
    covered = 4.0 / 3.0 * math.pi * float(np.sum((radii / max(largest, 1.0)) ** 3))
    covered *= max(largest, 1.0) ** 3
    if not max(covered, (2.0 * largest) ** 3) <= MOST_PAIRS:
        raise ValueError(
            f"overlap: expected balls that cover at most {MOST_PAIRS} voxels together,"
            f" got {covered:.3g}; lower overlap or least_radius, or use larger voxels"
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


def _flat(cells: Array, shape: tuple[int, int, int]) -> Numbers:
    """Give the numbers of voxels (x, y, z) in a flat ``[z, y, x]`` array."""
    _, height, width = shape
    x, y, z = cells.astype(np.intp).T
    return (z * height + y) * width + x


def _stencil(edges: Array, radius: float) -> Array:
    """List the voxels that a ball may cover whose centre lies in voxel (0, 0, 0)."""
    most = np.floor(radius / edges + 0.5).astype(int)
    axes = [np.arange(-m, m + 1.0) for m in most]
    # Distance to the nearest point of the middle voxel, squared, axis by axis.
    gaps = [
        np.maximum(np.abs(axis) - 0.5, 0.0) ** 2 * edge**2
        for axis, edge in zip(axes, edges, strict=True)
    ]
    near = gaps[2][:, None, None] + gaps[1][:, None] + gaps[0] < radius**2
    z, y, x = np.nonzero(near)
    return np.stack([axes[0][x], axes[1][y], axes[2][z]], axis=1)
