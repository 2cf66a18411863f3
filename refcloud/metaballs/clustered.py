"""Fits that start from clusters: the paper's, and its two better ones."""

from __future__ import annotations

import numpy as np

from refcloud.conventions import Array
from refcloud.metaballs.coarse import levels, moved, serves_coarser
from refcloud.metaballs.kmeans import Clusters, adaptive_kmeans, lloyd
from refcloud.metaballs.pairs import Work
from refcloud.metaballs.refine import Fit, Listed, listed, refine
from refcloud.metaballs.settings import Settings
from refcloud.metaballs.sizes import OVERLAP, typical_radius
from refcloud.metaballs.solve import ROUGH, with_heights, with_learned_heights
from refcloud.metaballs.spread import rms_radii
from refcloud.metaballs.weights import voxel_weights

# R over sigma: 2 is the paper's figure 8. The least error on all voxels has 2.2 where
# balls are as small as a few voxels, and 2.1 where they are larger.
PAPER_OVERLAP, WIDE_OVERLAP = 2.0, 2.1
# Extra weight of the rim: where small balls are refined it lowers the error.
RIM = 6.0
# Levenberg-Marquardt steps: on each coarser grid, and on the voxels themselves with
# and without coarser ones before.
COARSE_STEPS, LAST_STEPS, ALL_STEPS = 8, 1, 5


def man(work: Work, count: int, settings: Settings) -> Listed:
    """Run the paper's three phases, eq 14 to 24."""
    clusters = adaptive_kmeans(work.positions, count, seed=settings.seed)
    settings.watch("clusters", work, clusters)
    fit = spread(work, clusters, settings.overlap or PAPER_OVERLAP, None, 0.0)
    state = with_learned_heights(work, fit, settings.kernel)
    settings.watch("heights", work, state.fit)
    return state


def quick(work: Work, count: int, settings: Settings) -> Listed:
    """Cluster by density, and give the balls their best heights."""
    fit = clustered(work, count, settings, refined=False)
    state = with_heights(work, fit, settings.kernel)
    settings.watch("heights", work, state.fit)
    return state


def standard(work: Work, count: int, settings: Settings) -> Listed:
    """Cluster by density, then refine centres, radii and heights together."""
    fit = clustered(work, count, settings, refined=True)
    grids = grids_for(work, count) if settings.refine_steps is None else [work]
    return refined_by_levels(grids, fit, settings)


def grids_for(work: Work, count: int) -> list[Work]:
    """List the grids that serve so many balls, the coarsest first."""
    return levels(work, typical_radius(work, count))


def clustered(work: Work, count: int, settings: Settings, *, refined: bool) -> Fit:
    """Run phases 1 and 2, dense voxels first."""
    points = work.positions
    mass = work.density[work.density > 0.0]
    small = not serves_coarser(work, typical_radius(work, count))
    rim = settings.rim
    if rim is None:
        rim = RIM if refined and small else 0.0
    weights = voxel_weights(work.density, work.edges, rim, settings.rim_depth)
    clusters = lloyd(points, weights, count, seed=settings.seed, rounds=settings.rounds)
    settings.watch("clusters", work, clusters)
    overlap = settings.overlap or (OVERLAP if small else WIDE_OVERLAP)
    return spread(work, clusters, overlap, mass, settings.least_radius)


def spread(
    work: Work, clusters: Clusters, overlap: float, mass: Array | None, least: float
) -> Fit:
    """Run phase 2: a ball of each cluster's spread (eq 16 and 23)."""
    # A box of edges e has the mean square distance |e|^2 / 12.
    spacing = float(np.sqrt((work.edges**2).mean()))
    sigma = rms_radii(
        work.positions,
        clusters.assignment,
        centers=clusters.centers,
        spacing=spacing,
        weights=mass,
    )
    radii = np.maximum(overlap * sigma, least)
    return Fit(clusters.centers, radii, np.zeros(len(radii)))


def refined_by_levels(grids: list[Work], fit: Fit, settings: Settings) -> Listed:
    """Refine a fit on each grid, the coarsest first, and end with best heights."""
    last, kernel, number = grids[-1], settings.kernel, 0
    least = settings.least_radius
    state = None
    for work in grids:
        here = moved(fit, last, work)
        if state is None:
            state = with_heights(work, here, kernel, optimal=ROUGH)
            settings.watch("heights", work, state.fit)
        else:
            state = listed(work, here, kernel)
        steps = COARSE_STEPS if work is not last else LAST_STEPS
        if len(grids) == 1:
            chosen = settings.refine_steps
            steps = ALL_STEPS if chosen is None else chosen

        def show(_: int, fit: Fit, work: Work = work) -> None:
            nonlocal number
            number += 1
            settings.watch(f"refined {number}", work, fit)

        state = refine(
            work,
            state,
            kernel,
            steps=steps,
            least_radius=least * work.joined,
            observe=show,
        )
        fit = moved(state.fit, work, last)
    assert state is not None
    return with_heights(last, fit, kernel, pairs=state.pairs)
