"""Small clouds for the metaballs room: an ellipsoid with holes, by a formula."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from refcloud.cloudmap.voxels import VoxelGrid


def make_cloud(
    seed: int = 0,
    *,
    lower: tuple[float, float, float] = (0.0, 0.0, 0.0),
    cell: tuple[float, float, float] = (1.0, 1.0, 1.0),
    peak: float = 1.0,
    pad: int = 4,
) -> VoxelGrid:
    """Fill an ellipsoid of 18 x 12 x 14 voxels with waves, cut off at a tenth."""
    z, y, x = np.meshgrid(*(np.arange(n) + 0.5 for n in (14, 12, 18)), indexing="ij")
    quadric = 1.0 - ((x - 9) / 9) ** 2 - ((y - 6) / 6) ** 2 - ((z - 7) / 7) ** 2
    waves = np.sin(0.9 * x + seed) * np.sin(0.7 * y + 2 * seed) + np.sin(0.8 * z - seed)
    density = np.maximum(quadric, 0.0) * np.abs(waves)
    density[density < 0.1] = 0.0
    density = np.pad(density * (peak / density.max()), pad)
    corner = np.asarray(lower) - pad * np.asarray(cell)
    size = np.array(density.shape[::-1]) * np.asarray(cell)
    return VoxelGrid(density, corner, corner + size)


@pytest.fixture(scope="session")
def cloud() -> Callable[..., VoxelGrid]:
    return make_cloud
