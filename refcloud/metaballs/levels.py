"""Levels of detail: a cloud as few, more and many balls, and which of them to draw."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated

import numpy as np

from refcloud.camera import Camera, OrthographicCamera, project
from refcloud.checking import check_fields, checked
from refcloud.cloudmap.voxels import VoxelGrid, cell_centres
from refcloud.conventions import (
    Array,
    Observer,
    Range,
    Seed,
    Shape,
    Tolerance,
)
from refcloud.metaballs.approximate import as_balls, skipped_of, watcher
from refcloud.metaballs.balls import Metaballs
from refcloud.metaballs.clustered import grids_for
from refcloud.metaballs.coarse import moved
from refcloud.metaballs.errors import errors_of_fit
from refcloud.metaballs.field import field_grid
from refcloud.metaballs.grow import ended, full
from refcloud.metaballs.kernels import Kernel
from refcloud.metaballs.pairs import prepare
from refcloud.metaballs.refine import listed
from refcloud.metaballs.settings import Settings
from refcloud.refusal import complaint

COUNTS = (30, 100, 300, 1000)
MOST_LEVELS = 16
# How far a level's pixels are from the last level's, a root mean square over those that
# the cloud covers: at most PICTURE_SHARE times the relative difference of the optical
# depth, and PICTURE_FLOOR more. Measured, neither proved nor certified: the worst of
# 1900 pictures of 90 generated clouds (ellipsoids, cumuli, grids of random voxels; both
# looks) was 0.11 above 5 times the difference. The floor is there because light is one
# number for each ball: other balls of the same density are lit in other steps.
PICTURE_SHARE, PICTURE_FLOOR = 5.0, 0.25


@dataclass(frozen=True, repr=False)
class Levels:
    """A cloud at several levels of detail, each with balls of its own.

    Attributes
    ----------
    levels
        From the fewest balls to the most.
    errors
        Relative root mean square error of each level's density over all voxels of the
        cloud map, then of its projected optical depth along x, y and z; shape (L, 4).
    differences
        Relative root mean square difference of each level's projected optical depth
        from the last level's, the largest of three axes; shape (L,).
    """

    levels: tuple[Metaballs, ...]
    errors: Annotated[Array, Shape("L", 4), Range(0.0)]
    differences: Annotated[Array, Shape("L"), Range(0.0)]

    def __post_init__(self) -> None:
        check_fields(self)
        if not self.levels or len(self.levels) != len(self.errors):
            expected = f"as many as rows of errors, {len(self.errors)}, at least one"
            raise ValueError(complaint("levels", expected, f"{len(self.levels)}"))

    def __repr__(self) -> str:
        """Say what it is without its numbers."""
        return f"Levels({', '.join(str(len(level)) for level in self.levels)} balls)"

    @property
    def finest(self) -> Metaballs:
        """Give the level of the most balls."""
        return self.levels[-1]


@checked
def levels_of_detail(
    grid: VoxelGrid,
    *,
    counts: tuple[Annotated[int, Range(1, 1_000_000)], ...] = COUNTS,
    seed: Seed = 0,
    kernel: Kernel = "wyvill",
    observe: Observer | None = None,
) -> Levels:
    """Approximate a cloud map at several levels of detail.

    Formula: each level grows from the one before, and then all its balls move

    Parameters
    ----------
    grid
        The cloud map.
    counts
        Numbers of balls, ascending, at most 16 of them. No level gets more balls than
        there are voxels.
    seed
        Where the first level's clustering starts. The same seed gives the same bits.
    kernel
        How a ball's density falls.
    observe
        Function that is called with a name and each intermediate.

    Returns
    -------
    The levels. Each has balls of its own: a level that kept those of the one before
    and added to them would err up to twice as much.

    Raises
    ------
    ValueError
        The counts do not ascend, or there are none or too many.

    Source: paper M, section 3 (A12): 30, 100 and 1000 balls.

    Examples
    --------
    >>> grid = VoxelGrid(np.ones((4, 4, 4)), [0, 0, 0], [1, 1, 1])
    >>> levels_of_detail(grid, counts=(1, 8))
    Levels(1, 8 balls)
    """
    ascending = all(a < b for a, b in pairwise(counts))
    if not (ascending and 1 <= len(counts) <= MOST_LEVELS):
        expected = f"1 to {MOST_LEVELS} ascending numbers"
        raise ValueError(complaint("counts", expected, f"{len(counts)} others"))
    work = prepare(grid)
    made: list[Metaballs] = []
    if work is None:
        empty = Metaballs(np.zeros((0, 3)), np.zeros(0), np.zeros(0), kernel)
        made = [empty] * len(counts)
    else:
        settings = Settings(kernel, seed, watcher(kernel, observe))
        state = None
        for count in counts:
            few = min(count, work.voxels)
            if state is None:
                state = full(work, few, settings)
            else:
                # Grow the level before on the grid that serves this one's balls.
                on = grids_for(work, few)[0]
                start = listed(on, moved(state.fit, work, on), kernel)
                state = ended(work, on, start, few, settings)
            rows = skipped_of(work, state.fit, count)
            made.append(as_balls(work, state.fit, kernel, rows))
            if observe is not None:
                observe(f"level of {count} balls", made[-1])
    errors = [errors_of_fit(grid, balls) for balls in made]
    table = np.array([[error.density, *error.projected] for error in errors])
    return Levels(tuple(made), table, _differences(grid, made))


def _differences(grid: VoxelGrid, made: list[Metaballs]) -> Array:
    """Compare each level's projections with the last one's."""
    x, y, z = cell_centres(grid)
    fields = [field_grid(balls, x, y=y, z=z) for balls in made]
    found = np.zeros(len(made))
    for axis in range(3):
        exact = fields[-1].sum(axis=axis)
        largest = float(exact.max(initial=0.0))
        if largest > 0.0:
            size = float(np.square(exact / largest).sum())
            off = [
                float(np.square((each.sum(axis=axis) - exact) / largest).sum())
                for each in fields
            ]
            found = np.maximum(found, np.sqrt(np.array(off) / size))
    return found


@checked
def choose_level(
    levels: Levels,
    camera: Camera | OrthographicCamera,
    *,
    tolerance: Tolerance = 1.0 / 255.0,
) -> Metaballs:
    """Choose the level with the fewest balls that a camera can do with.

    Formula: the first level with (5 d + 0.25) sqrt(s) <= tolerance, d its relative
    difference of optical depth from the last level, s the share of the picture that the
    cloud covers

    Parameters
    ----------
    levels
        The cloud.
    camera
        The eye: it says how much of the picture the cloud's box covers.
    tolerance
        Root mean square difference of the picture from the last level's. The bound is
        measured with a margin of two over all that was seen. It is neither proved nor
        certified, since nothing is drawn to choose; and single pixels differ by more.

    Returns
    -------
    The balls of the chosen level; the last level's where none of the others will do.

    Source: paper M, section 3 (A12): fewer balls for smaller clouds.

    Examples
    --------
    >>> grid = VoxelGrid(np.ones((4, 4, 4)), [0, 0, 0], [1, 1, 1])
    >>> made = levels_of_detail(grid, counts=(1, 8))
    >>> far = Camera([0.5, 0.5, 1e4], [0.5, 0.5, 0.5])
    >>> [len(choose_level(made, far, tolerance=t)) for t in (1.0, 0.0)]
    [1, 8]
    """
    bounds = picture_bounds(levels, covered_share(levels.finest, camera))
    for balls, bound in zip(levels.levels, bounds, strict=True):
        if bound <= tolerance:
            return balls
    return levels.finest


def picture_bounds(levels: Levels, share: float) -> Array:
    """Bound each level's difference of picture from the last level's, shape (L,)."""
    off = PICTURE_SHARE * levels.differences + PICTURE_FLOOR
    return np.where(levels.differences > 0.0, off * math.sqrt(share), 0.0)


def covered_share(balls: Metaballs, camera: Camera | OrthographicCamera) -> float:
    """Bound the share of a picture that balls cover, by the box around them."""
    if not len(balls):
        return 0.0
    lower = (balls.centers - balls.radii[:, None]).min(axis=0)
    upper = (balls.centers + balls.radii[:, None]).max(axis=0)
    corners = np.stack(np.meshgrid(*zip(lower, upper, strict=True)), axis=-1)
    x, y, depth, _ = project(camera, corners.reshape(-1, 3))
    if isinstance(camera, Camera) and not (depth > 0.0).all():
        # A box around the eye may cover all; one behind it covers nothing.
        return 1.0 if (depth > 0.0).any() else 0.0
    # A pixel is drawn whole where the box reaches its middle: half a pixel more.
    across, down = (
        max(0.0, min(float(at.max()) + 0.5, size) - max(float(at.min()) - 0.5, 0.0))
        for at, size in ((x, camera.width), (y, camera.height))
    )
    return across * down / (camera.width * camera.height)
