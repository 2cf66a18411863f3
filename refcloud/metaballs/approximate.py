"""A cloud map as metaballs: the paper's three phases, and two better fits."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np

from refcloud.checking import checked
from refcloud.cloudmap.voxels import VoxelGrid
from refcloud.conventions import Array, Observer, Range, Seed, Skipped
from refcloud.metaballs.balls import Metaballs
from refcloud.metaballs.heights import descend, dot
from refcloud.metaballs.kernels import Kernel
from refcloud.metaballs.kmeans import Clusters, adaptive_kmeans, lloyd
from refcloud.metaballs.nonnegative import solve_non_negative
from refcloud.metaballs.pairs import Pairs, Work, list_pairs, prepare
from refcloud.metaballs.refine import Fit, refine
from refcloud.metaballs.spread import rms_radii
from refcloud.metaballs.weights import voxel_weights

# R over sigma: 2 is the paper's figure 8; 2.2 gives the least error on all voxels.
PAPER_OVERLAP, OVERLAP = 2.0, 2.2
# Extra weight of the rim: with refinement it lowers the error, without it raises it.
RIM = {"standard": 6.0, "quick": 0.0, "man": 0.0}
# Phase 3 ends where the relative error of all voxels is this, or after so many steps.
PAPER_ERROR, PAPER_STEPS = 0.1, 30
# Heights are optimal to this share; the fit's own error is a million times larger.
OPTIMAL, MOST_STEPS = 1e-8, 2000


@checked
def approximate(
    grid: VoxelGrid,
    *,
    count: Annotated[int, Range(1, 1_000_000)] = 1000,
    method: Literal["quick", "standard", "man"] = "standard",
    seed: Seed = 0,
    overlap: Annotated[float, Range(0.1, 100.0)] | None = None,
    rim: Annotated[float, Range(0.0, 1e6)] | None = None,
    rim_depth: Annotated[float, Range(0.01, 1e4, "voxel")] = 1.5,
    kernel: Kernel = "wyvill",
    rounds: Annotated[int, Range(0, 10_000)] = 10,
    refine_steps: Annotated[int, Range(0, 10_000)] = 5,
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
        Number of balls wanted. A cloud never gets more balls than it has voxels.
    method
        How the balls are found. "man" is paper M's three phases; "quick" is weighted
        k-means with heights by least squares; "standard" refines all of that together.
    seed
        Where the clustering starts. The same seed gives the same bits.
    overlap
        Radius over the root mean square distance of a cluster. None is 2.2, and 2 for
        "man".
    rim
        How much more the voxels at the rim weigh in the clustering, which puts more
        and smaller balls there. None is 6 for "standard" and 0 for "quick", whose balls
        stay where the clustering puts them. Not in "man".
    rim_depth
        Depth in voxels at which the rim's extra weight has fallen to 1/e.
    kernel
        How a ball's density falls.
    rounds
        How often the weighted k-means moves its centres. Not in "man".
    refine_steps
        Number of Levenberg-Marquardt steps of "standard".
    least_radius
        Smallest radius of a ball, in voxels. Below 1 balls fit samples, not a field.
        Not in "man".
    observe
        Function that is called with a name and each intermediate: clusters, then
        metaballs.

    Returns
    -------
    The balls, and as skipped those that were dropped because their density was 0.

    Raises
    ------
    ValueError
        The balls would cover over 2^24 voxels together.

    Source: paper M, section 3, eq 11-24; E18, E19.

    Examples
    --------
    >>> len(approximate(VoxelGrid(np.ones((2, 2, 2)), [0, 0, 0], [1, 1, 1]), count=2))
    2
    """
    work = prepare(grid)
    if work is None:
        return Metaballs(np.zeros((0, 3)), np.zeros(0), np.zeros(0), kernel)
    if overlap is None:
        overlap = PAPER_OVERLAP if method == "man" else OVERLAP

    def show(name: str, fit: Fit) -> None:
        if observe is not None:
            observe(name, _balls(work, fit, kernel, ()))

    points = work.positions()
    if method == "man":
        clusters = adaptive_kmeans(points, count, seed=seed)
        mass, least = None, 0.0
    else:
        rim = RIM[method] if rim is None else rim
        weights = voxel_weights(work.density, work.edges, rim, rim_depth)
        clusters = lloyd(points, weights, count, seed=seed, rounds=rounds)
        mass, least = work.density[work.density > 0.0], least_radius
    if observe is not None:
        observe("clusters", _in_scene(work, clusters))
    # Phase 2: a box of edges e has the mean square distance |e|^2 / 12.
    spacing = float(np.sqrt((work.edges**2).mean()))
    sigma = rms_radii(
        points,
        clusters.assignment,
        centers=clusters.centers,
        spacing=spacing,
        weights=mass,
    )
    radii = np.maximum(overlap * sigma, least)
    # Phase 3.
    pairs = list_pairs(work, clusters.centers, radii, kernel)
    fit = Fit(clusters.centers, radii, _heights(pairs, method))
    show("heights", fit)
    if method == "standard" and refine_steps:
        fit = refine(
            work,
            fit,
            kernel,
            steps=refine_steps,
            least_radius=least,
            observe=lambda number, fit: show(f"refined {number}", fit),
        )
        # The last step moved the balls: their heights are made optimal once more.
        pairs = list_pairs(work, fit.centers, fit.radii, kernel)
        fit = Fit(fit.centers, fit.radii, _heights(pairs, method, fit.heights))
    return _balls(work, fit, kernel, _skipped(work, fit, count))


def _heights(pairs: Pairs, method: str, start: Array | None = None) -> Array:
    if method == "man":
        limit = PAPER_ERROR**2 * dot(pairs.target, pairs.target)
        return descend(
            pairs.forward,
            pairs.backward,
            pairs.target,
            pairs.count,
            rate=None,
            limit=limit,
            most_steps=PAPER_STEPS,
        )
    heights, _ = solve_non_negative(
        lambda v: pairs.backward(pairs.forward(v)),
        pairs.by_ball(pairs.value**2),
        pairs.backward(pairs.target),
        start=start,
        optimal=OPTIMAL,
        most_steps=MOST_STEPS,
    )
    return heights


def _balls(
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


def _in_scene(work: Work, clusters: Clusters) -> Clusters:
    centers = work.origin + clusters.centers * work.edge
    return Clusters(centers, clusters.assignment, clusters.epochs)


def _skipped(work: Work, fit: Fit, count: int) -> tuple[Skipped, ...]:
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
