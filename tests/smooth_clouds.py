"""A cloud that is as smooth, in voxels, as a rendered one of 128 voxels a side."""

from __future__ import annotations

import numpy as np

from refcloud.cloudmap import VoxelGrid
from refcloud.noise import fbm_grid


def cloud(
    size: int = 40,
    box: tuple[float, float, float] = (1.0, 1.0, 1.0),
    *,
    seed: int = 3,
    filled: bool = False,
) -> VoxelGrid:
    """Make a cloud in the middle of a box, a sixth of it, or one that fills the box.

    Its noise has two waves in 128 voxels: a smaller grid shows a smaller part of it.
    """
    x = (np.arange(size) + 0.5) / size * 2.0 - 1.0
    noise, _ = fbm_grid(*[x * size / 64.0] * 3, seed=seed, octaves=3)
    square = x[:, None, None] ** 2 + x[:, None] ** 2 + x**2
    level = 0.46 + 1.3 * noise - (0.0 if filled else square)
    density = np.clip(1.7 * size / 128.0 * level, 0.0, 1.0)
    return VoxelGrid(density, -np.array(box), np.array(box))
