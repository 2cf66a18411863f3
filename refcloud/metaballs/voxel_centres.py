"""Fits whose centres are voxels, taken evenly or at random (A13)."""

from __future__ import annotations

import numpy as np

from refcloud.metaballs.choices import spaced_patterns, start_patterns
from refcloud.metaballs.clustered import spread
from refcloud.metaballs.kmeans import clusters_around
from refcloud.metaballs.pairs import Numbers, Work
from refcloud.metaballs.refine import Listed
from refcloud.metaballs.settings import Settings
from refcloud.metaballs.sizes import OVERLAP
from refcloud.metaballs.solve import with_heights


def uniform(work: Work, count: int, settings: Settings) -> Listed:
    """Put the balls on voxels that are spaced evenly."""
    z, y, x = np.nonzero(work.density > 0.0)
    chosen = spaced_patterns(np.stack([x, y, z], axis=1), count)
    return _on_voxels(work, chosen, settings)


def random(work: Work, count: int, settings: Settings) -> Listed:
    """Put the balls on voxels that a hash chooses."""
    return _on_voxels(work, start_patterns(work.voxels, count, settings.seed), settings)


def _on_voxels(work: Work, chosen: Numbers, settings: Settings) -> Listed:
    """Give each voxel the ball of the cluster around it, and its best height."""
    points = work.positions
    clusters = clusters_around(points, points[chosen])
    settings.watch("clusters", work, clusters)
    overlap = settings.overlap or OVERLAP
    mass = work.density[work.density > 0.0]
    fit = spread(work, clusters, overlap, mass, settings.least_radius)
    state = with_heights(work, fit, settings.kernel)
    settings.watch("heights", work, state.fit)
    return state
