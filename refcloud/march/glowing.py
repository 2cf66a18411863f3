"""Light that was scattered many times, to a tolerance: the way that some rays certify.

Ways are tried from coarse to fine on a hashed sample of rays. The first whose errors,
with their margin, stay below the tolerance takes all rays, of which the steepest are
then looked at as well; where no way holds, every ray is exact.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Array, Observer, Skipped
from refcloud.march.certificate import MARGIN
from refcloud.march.glow import Way, glow
from refcloud.march.sampling import CHECKED, edge_rays
from refcloud.noise import uniform
from refcloud.transport import ScatteredLight

# Strides err most, and fall by half each time: their error is a quarter of the last's.
WAYS = (
    Way(1.0, 0.3),
    Way(0.5, 0.3),
    Way(0.25, 0.15),
    Way(0.125, 0.15),
    Way(0.0625, 0.075),
    Way(0.03125, 0.0375),
)
NEXT = 0.2  # share of a way's error that the next one has at best


def glow_within(
    cloud: VoxelGrid,
    origins: Array,
    directions: Array,
    light: ScatteredLight,
    tolerance: float,
    *,
    rows: tuple[int, int],
    observe: Observer | None = None,
) -> tuple[Array, tuple[Skipped, ...]]:
    """Integrate the solved source along rays to a tolerance, unchecked.

    Parameters
    ----------
    cloud, origins, directions, light
        As `glow`.
    tolerance
        Largest error of a channel; 0 for the exact way.
    rows
        Rows and columns of rays that are neighbours.
    observe
        Called with ("errors of ways", errors by way).

    Returns
    -------
    Radiance of shape (N, 3), and the rows of the report.
    """
    if tolerance == 0.0 or not len(origins):
        return glow(cloud, origins, directions, light, None), ()
    # 1. A hashed sample of the rays that glow.
    sample = _glowing(cloud, origins, directions, light)
    exact = glow(cloud, origins[sample], directions[sample], light, None)
    tried: dict[Way, float] = {}
    found: Array | None = None
    told: tuple[Skipped, ...] = ()
    for way in WAYS:
        # 2. A way on the sample: what it errs by, and what finer ones can hope for.
        some = glow(cloud, origins[sample], directions[sample], light, way)
        tried[way] = float(np.abs(some - exact).max(initial=0.0))
        bound = MARGIN * tried[way]
        if bound > tolerance:
            finer = len(WAYS) - 1 - WAYS.index(way)
            if bound * NEXT**finer > tolerance:
                break
            continue
        # 3. All rays, and the steepest of them.
        found = glow(cloud, origins, directions, light, way)
        steep = edge_rays(found.max(axis=1).reshape(rows))
        again = glow(cloud, origins[steep], directions[steep], light, None)
        worst = float(np.abs(found[steep] - again).max(initial=0.0))
        bound = max(bound, MARGIN * worst)
        if bound <= tolerance:
            count = len(origins)
            told = (
                Skipped(
                    "march",
                    "exact rays through solved light",
                    count,
                    count,
                    bound,
                    how="certified",
                ),
            )
            break
        found = None
    if observe is not None:
        observe("errors of ways", tried)
    if found is None:
        found = glow(cloud, origins, directions, light, None)
    return found, told


def _glowing(
    cloud: VoxelGrid, origins: Array, directions: Array, light: ScatteredLight
) -> NDArray[np.intp]:
    """Choose rays that show solved light, by a hash of their number."""
    drawn = np.argsort(uniform(np.arange(len(origins)), seed=1), kind="stable")
    chosen = drawn[:0]
    for start in range(0, len(drawn), 4 * CHECKED):
        some = drawn[start : start + 4 * CHECKED]
        seen = glow(cloud, origins[some], directions[some], light, WAYS[0])
        chosen = np.concatenate([chosen, some[seen.max(axis=1) > 0.0]])
        if len(chosen) >= CHECKED:
            break
    return np.sort(chosen[:CHECKED])
