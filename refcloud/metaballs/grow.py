"""The fit that grows: some balls by clusters, the others where they are missing."""

from __future__ import annotations

import numpy as np

from refcloud.metaballs.clustered import clustered, grids_for
from refcloud.metaballs.coarse import moved
from refcloud.metaballs.pairs import Work
from refcloud.metaballs.peaks import Correlator
from refcloud.metaballs.refine import Fit, Listed, listed, refine
from refcloud.metaballs.settings import Settings
from refcloud.metaballs.sizes import sizes_for
from refcloud.metaballs.solve import ROUGH, with_heights

# Shares of the balls that are there after the clustering and after each growth.
SEEDED, SHARES = 0.4, (0.6, 0.8, 1.0)
# Few balls end in one of a few arrangements, where growth may be stuck: up to so many,
# clusters of all balls are refined as well, and the better fit is kept.
FEW = 200
# Levenberg-Marquardt steps: before each growth; after the last one, on the voxels or on
# a coarser grid; and on the voxels after a coarser grid.
STAGE_STEPS, END_STEPS, COARSE_STEPS, LAST_STEPS = 4, 18, 24, 4
# Conjugate gradients in each of them: near the end a better direction pays.
INNER_STEPS = 12


def full(work: Work, count: int, settings: Settings) -> Listed:
    """Seed by clusters, grow from the residual, and refine after each growth."""
    # 1. Seed: most of the cloud by few balls. All that follows runs on the grid that
    #    serves balls as small as the last ones will be.
    seeds = max(1, round(SEEDED * count))
    grid = grids_for(work, count)[0]
    state = _started(work, grid, seeds, settings)
    settings.watch("heights", grid, state.fit)
    return ended(work, grid, state, count, settings)


def _started(work: Work, grid: Work, count: int, settings: Settings) -> Listed:
    """Cluster on the voxels, and give the balls their heights on a grid."""
    fit = clustered(work, count, settings, refined=True)
    return with_heights(grid, moved(fit, work, grid), settings.kernel, optimal=ROUGH)


def grown(grid: Work, state: Listed, count: int, settings: Settings) -> Listed:
    """Grow a fit on a grid to `count` balls, and refine it there."""
    least = settings.least_radius * grid.joined
    finder = Correlator(
        grid.density.shape, grid.edges, sizes_for(grid, count, least), settings.kernel
    )
    # 2. Grow: refine what is there, then put balls where most is missing.
    present = len(state.fit.radii)
    for share in (s for s in SHARES if s * count > present):
        # Balls of height 0 are not there: others take their place.
        state = refine(
            grid,
            state,
            settings.kernel,
            steps=STAGE_STEPS,
            least_radius=least,
            inner=INNER_STEPS,
        )
        missing = round(share * count) - int(np.count_nonzero(state.fit.heights))
        if missing > 0:
            fit = _joined(grid, state, finder, missing)
            state = with_heights(grid, fit, settings.kernel, optimal=ROUGH)
        settings.watch(f"grown to {len(state.fit.radii)}", grid, state.fit)
    # 3. Refine all of them together.
    return _refined(grid, state, settings)


def _refined(grid: Work, state: Listed, settings: Settings) -> Listed:
    """Refine a fit for long, where the pairs are few for longer."""
    steps = settings.refine_steps
    if steps is None:
        steps = END_STEPS if grid.joined == 1 else COARSE_STEPS
    least = settings.least_radius * grid.joined
    return refine(
        grid,
        state,
        settings.kernel,
        steps=steps,
        least_radius=least,
        inner=INNER_STEPS,
    )


def ended(
    work: Work, grid: Work, state: Listed, count: int, settings: Settings
) -> Listed:
    """Grow a fit on a grid to `count` balls, and end on the voxels themselves."""
    state, kernel = grown(grid, state, count, settings), settings.kernel
    if count <= FEW:
        rival = _refined(grid, _started(work, grid, count, settings), settings)
        state = min(state, rival, key=lambda each: each.cost)
    if grid is not work:
        state = listed(work, moved(state.fit, grid, work), kernel)
        chosen = settings.refine_steps
        steps = LAST_STEPS if chosen is None else min(LAST_STEPS, chosen)
        least = settings.least_radius
        state = refine(work, state, kernel, steps=steps, least_radius=least)
    settings.watch("refined", work, state.fit)
    return with_heights(work, state.fit, kernel, pairs=state.pairs)


def _joined(grid: Work, state: Listed, finder: Correlator, missing: int) -> Fit:
    """Add the balls that lower the residual most."""
    inside = tuple(
        slice(c, c + n)
        for c, n in zip(state.pairs.corner, grid.density.shape, strict=True)
    )
    residual = state.residual.reshape(state.pairs.shape)[inside]
    found = finder.peaks(residual, missing)
    old, kept = state.fit, state.fit.heights > 0.0
    return Fit(
        np.concatenate([old.centers[kept], found.cells * grid.edges]),
        np.concatenate([old.radii[kept], found.radii]),
        np.concatenate([old.heights[kept], found.heights]),
    )
