"""A cloud map as metaballs: the paper's three phases, and better fits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import checked
from refcloud.cloudmap.voxels import VoxelGrid
from refcloud.conventions import Observer, Range, Seed, Skipped
from refcloud.metaballs.balls import Metaballs
from refcloud.metaballs.clustered import man, quick, standard
from refcloud.metaballs.errors import errors_of_fit
from refcloud.metaballs.fewest import fewest
from refcloud.metaballs.grow import full
from refcloud.metaballs.kernels import Kernel
from refcloud.metaballs.kmeans import Clusters
from refcloud.metaballs.orthogonal import orthogonal
from refcloud.metaballs.pairs import Work, prepare
from refcloud.metaballs.refine import Fit, Listed
from refcloud.metaballs.settings import Settings, Watch
from refcloud.metaballs.subtract import subtract
from refcloud.metaballs.voxel_centres import random, uniform
from refcloud.refusal import complaint

Method = Literal[
    "quick",
    "standard",
    "full",
    "man",
    "uniform",
    "random",
    "orthogonal",
    "subtract",
]
METHODS: dict[Method, Callable[[Work, int, Settings], Listed]] = {
    "quick": quick,
    "standard": standard,
    "full": full,
    "man": man,
    "uniform": uniform,
    "random": random,
    "orthogonal": orthogonal,
    "subtract": subtract,
}
COUNT = 1000  # where neither a count nor a tolerance is given


@checked
def approximate(
    grid: VoxelGrid,
    *,
    count: Annotated[int, Range(1, 1_000_000)] | None = None,
    tolerance: Annotated[float, Range(0.0, 1.0, open_lower=True, open_upper=True)]
    | None = None,
    method: Method = "standard",
    seed: Seed = 0,
    overlap: Annotated[float, Range(0.1, 100.0)] | None = None,
    rim: Annotated[float, Range(0.0, 1e6)] | None = None,
    rim_depth: Annotated[float, Range(0.01, 1e4, "voxel")] = 1.5,
    kernel: Kernel = "wyvill",
    rounds: Annotated[int, Range(0, 10_000)] = 10,
    refine_steps: Annotated[int, Range(0, 10_000)] | None = None,
    least_radius: Annotated[float, Range(0.0, 1e4, "voxel", open_lower=True)] = 1.1,
    observe: Observer | None = None,
) -> Metaballs:
    """Approximate a cloud map by metaballs.

    Formula: minimise H = sum over all voxels of (y_j - sum_k v_k f_k(x_j))^2

    The kernel that is fitted is the one that is drawn, and empty voxels count. Cells
    need not be cubes: lengths are measured in the geometric mean of their edges, so
    that balls stay balls.

    Parameters
    ----------
    grid
        The cloud map.
    count
        Number of balls wanted; 1000 without a tolerance. A cloud never gets more balls
        than it has voxels.
    tolerance
        In place of a count: the relative root mean square error over all voxels that
        is to be reached by few balls. With one ball fewer it was tried and missed.
    method
        How the balls are found. "man" is paper M's three phases; "quick" is weighted
        k-means with heights by least squares; "standard" refines all of that together;
        "full" grows the balls where most is missing, and refines longer. To compare:
        "uniform" and "random" take voxels as centres, "orthogonal" chooses them by
        orthogonal least squares, "subtract" places ball after ball and takes each away.
    seed
        Where the clustering starts. The same seed gives the same bits.
    overlap
        Radius over the root mean square distance of a cluster. None is 2.2, or 2.1
        where balls are many voxels wide, and 2 for "man".
    rim
        How much more the voxels at the rim weigh in the clustering, which puts more
        and smaller balls there. None is 6 where balls a few voxels wide are refined,
        else 0. Not in "man".
    rim_depth
        Depth in voxels at which the rim's extra weight has fallen to 1/e.
    kernel
        How a ball's density falls.
    rounds
        How often the weighted k-means moves its centres. Not in "man".
    refine_steps
        Number of Levenberg-Marquardt steps, on the voxels themselves for "standard".
        None is 5 for "standard", or 8 on each coarser grid that serves balls many
        voxels wide and 1 on the voxels; for "full" 18, or 24 on a coarser grid.
    least_radius
        Smallest radius of a ball, in voxels. Below 1 balls fit samples, not a field.
        Not in "man".
    observe
        Function that is called with a name and each intermediate: clusters, then
        metaballs, and every count that a tolerance makes it try.

    Returns
    -------
    The balls, and as skipped those that were dropped because their density was 0.

    Raises
    ------
    ValueError
        Both a count and a tolerance are given, or balls cannot reach the tolerance;
        the balls would cover over 2^24 voxels together.

    Source: paper M, section 3, eq 11-24; A13; E18, E19.

    Examples
    --------
    >>> len(approximate(VoxelGrid(np.ones((2, 2, 2)), [0, 0, 0], [1, 1, 1]), count=2))
    2
    """
    if count is not None and tolerance is not None:
        both = complaint("tolerance", "none beside a count", f"{tolerance:g}")
        raise ValueError(f"{both}; give one of them")
    work = prepare(grid)
    if work is None:
        return Metaballs(np.zeros((0, 3)), np.zeros(0), np.zeros(0), kernel)
    settings = Settings(
        kernel,
        seed,
        watcher(kernel, observe),
        overlap,
        rim,
        rim_depth,
        rounds,
        refine_steps,
        least_radius,
    )
    most = work.voxels

    def fitted(wanted: int) -> Metaballs:
        fit = METHODS[method](work, min(wanted, most), settings).fit
        return as_balls(work, fit, kernel, skipped_of(work, fit, wanted))

    def attempt(wanted: int) -> tuple[float, Metaballs]:
        balls = fitted(wanted)
        error = errors_of_fit(grid, balls).density
        if observe is not None:
            observe(f"tried {wanted} balls, relative RMSE {error:.4f}", balls)
        return error, balls

    if tolerance is not None:
        return fewest(attempt, tolerance, most)
    return fitted(COUNT if count is None else count)


def watcher(kernel: Kernel, observe: Observer | None) -> Watch:
    """Show what a fit on a grid finds in scene units."""

    def watch(name: str, on: Work, found: Fit | Clusters) -> None:
        if observe is None:
            return
        if isinstance(found, Clusters):
            centers = on.origin + found.centers * on.edge
            observe(name, replace(found, centers=centers))
        else:
            observe(name, as_balls(on, found, kernel, ()))

    return watch


def as_balls(
    work: Work, fit: Fit, kernel: Kernel, skipped: tuple[Skipped, ...]
) -> Metaballs:
    """Give the balls that have density, in scene units."""
    kept = fit.heights > 0.0
    return Metaballs(
        work.origin + fit.centers[kept] * work.edge,
        fit.radii[kept] * work.edge,
        fit.heights[kept] * work.peak,
        kernel,
        skipped,
    )


def skipped_of(work: Work, fit: Fit, count: int) -> tuple[Skipped, ...]:
    """Report balls that were asked for and are not there."""
    rows = []
    missing = count - len(fit.heights)
    if missing:
        rows.append(
            Skipped("approximate", "balls without a voxel of their own", missing, count)
        )
    below = fit.heights[fit.heights <= 0.0]
    if len(below):
        bound = work.peak * abs(float(below.sum()))
        rows.append(
            Skipped(
                "approximate",
                "balls of no density",
                len(below),
                count,
                bound,
                "density",
            )
        )
    return tuple(rows)
