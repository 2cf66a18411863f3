"""Document D's cloud: a texture of Worley and smooth noise that tiles, in a box.

Document D does not say how its texture's values become densities. Here `remap` is used
once more, with the level at which cloud begins as the lower end of the old range, and
what falls below 0 is cut: the form in which Schneider's chapter and Häggström's thesis
(see `refcloud.noise.remap`) apply their coverage to a noise.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.cloudmap.voxels import VoxelGrid
from refcloud.conventions import Positive, Range, Seed
from refcloud.frozen import sealed
from refcloud.noise import remap, worley_smooth_grid
from refcloud.noise.worley_smooth import Detail, Octaves, Period

# Where cloud begins: near the median of the noise (0.65 to two places, over seeds and
# numbers of cells), so that about half of the box is filled.
THRESHOLD = 0.65
# 2^25 voxels are 322 along each side: the limit of `VoxelGrid`'s makers.
Side = Annotated[int, Range(1, 322, "voxels")]


@checked
def worley_smooth_texture(
    size: Side = 64,
    *,
    cells: Period = 4,
    seed: Seed = 0,
    octaves: Octaves = 3,
    threshold: Annotated[float, Range(0.0, 1.0, open_upper=True)] = THRESHOLD,
    detail: Detail = "smooth",
    side: Annotated[float, Positive] = 1.0,
) -> VoxelGrid:
    """Make a cube of cloud that continues itself on all sides.

    Formula: max(remap(worley_smooth(p), threshold, 1, 0, 1), 0)

    Parameters
    ----------
    size
        Voxels along each side.
    cells
        Cells of the Worley noise along each side, whatever the number of voxels; after
        them the texture repeats.
    seed
        Which pattern.
    octaves
        Octaves of the finer noise.
    threshold
        Level of the noise at which cloud begins; it is densest, 1, where the noise is.
    detail
        The finer noise: "smooth", or "gradient", which document D rejected (N32).
    side
        Edge of the box, scene units; the box is centred on the origin.

    Returns
    -------
    The cloud map, densities in [0, 1].

    Source: document D, Generating Cloud Textures (N28, N29, N31, V09).

    Examples
    --------
    >>> worley_smooth_texture(8, cells=2, seed=7).density.shape
    (8, 8, 8)
    """
    line = (np.arange(size) + 0.5) * cells / size
    noise = worley_smooth_grid(
        line, line, line, seed=seed, period=cells, octaves=octaves, detail=detail
    )
    low, one = np.array(threshold), np.ones(())
    density = np.maximum(remap(noise, low, one, 0.0 * one, one), 0.0)
    corner = np.full(3, 0.5 * side)
    return VoxelGrid(sealed(density), -corner, corner)
