"""How large balls are that share a cloud evenly."""

from __future__ import annotations

import math

import numpy as np

from refcloud.conventions import Array
from refcloud.metaballs.pairs import Work

# R over sigma at which balls that share a cloud evenly err least.
OVERLAP = 2.2
# Radii that are tried for a ball, over (voxels / balls)^(1/3).
SIZES = (0.7, 1.0, 1.4, 2.0, 2.8)


def typical_radius(work: Work, count: int) -> float:
    """Give the radius of each of so many equal balls.

    Formula: overlap sqrt(3/5) (3 n / 4 pi)^(1/3): n voxels as a ball have the root mean
    square radius sqrt(3/5) (3 n / 4 pi)^(1/3)
    """
    share = work.voxels / count
    return OVERLAP * math.sqrt(0.6) * (0.75 / math.pi * share) ** (1.0 / 3.0)


def sizes_for(work: Work, count: int, least: float) -> Array:
    """Give the radii to try for one of so many balls, ascending, none below `least`."""
    share = work.voxels / count
    return np.unique(np.maximum(np.array(SIZES) * share ** (1.0 / 3.0), least))
