"""The cloud map of a set of balls: what their light can be solved in."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Range
from refcloud.frozen import sealed
from refcloud.metaballs.balls import Metaballs
from refcloud.metaballs.field import field_grid
from refcloud.refusal import complaint

VOXELS = 64  # along the longest axis, at most
FINENESS = 0.5  # of the median radius: a ball of that size is four voxels wide


@checked
def sampled_map(
    balls: Metaballs, *, most: Annotated[int, Range(1, 512, "voxels")] = VOXELS
) -> VoxelGrid:
    """Sample the density of balls at the centres of cubic voxels.

    Formula: eq 13 at the voxels' centres; an edge is half the median radius, or as much
    more as leaves `most` voxels along the longest axis

    Parameters
    ----------
    balls
        The cloud.
    most
        Voxels along the longest axis, at most.

    Returns
    -------
    The map; its box holds every ball. No balls give one empty voxel.

    Raises
    ------
    ValueError
        The cloud is so wide that its width is no number.

    Source: paper M, eq 13 (W03).

    Examples
    --------
    >>> sampled_map(Metaballs([[0, 0, 0]], [1.0], [1.0]), most=3).density.shape
    (3, 3, 3)
    """
    if not len(balls):
        return VoxelGrid(np.zeros((1, 1, 1)), np.zeros(3), np.ones(3))
    with np.errstate(over="ignore"):
        lower = (balls.centers - balls.radii[:, None]).min(axis=0)
        upper = (balls.centers + balls.radii[:, None]).max(axis=0)
        extent = upper - lower
    if not np.isfinite(extent).all():
        expected = "a cloud whose width is a number"
        raise ValueError(complaint("balls", expected, "a wider one"))
    edge = max(FINENESS * float(np.median(balls.radii)), float(extent.max()) / most)
    counts = np.clip(np.ceil(extent / edge * (1.0 - 1e-12)), 1, most).astype(int)
    x, y, z = (
        low + (np.arange(n) + 0.5) * edge for low, n in zip(lower, counts, strict=True)
    )
    density = sealed(field_grid(balls, x, y=y, z=z))
    return VoxelGrid(density, lower, lower + counts * edge)
