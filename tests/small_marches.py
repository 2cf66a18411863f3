"""A cloud map, an eye and a light small enough for laws of the march."""

from __future__ import annotations

import numpy as np

from refcloud.camera import AnyCamera, Camera, rays
from refcloud.cloudmap import VoxelGrid
from refcloud.noise import uniform
from refcloud.optics import Medium, Sun

EYE = Camera([2.2, 1.2, 3.0], [0, 0, 0], width=12, height=9)
SUN = Sun([-0.5, 0.7, 0.3])
MEDIUM = Medium(8.0, 0.9, 0.3, "hg")


def blob(shape: tuple[int, int, int], seed: int = 0) -> VoxelGrid:
    """Make a round cloud with a hashed bumpy surface in [-1, 1]^3."""
    z, y, x = np.meshgrid(*(np.linspace(-1.0, 1.0, n) for n in shape), indexing="ij")
    phases = 6.0 * uniform(np.arange(3), seed=seed)
    bumps = (
        np.sin(5 * x + phases[0])
        * np.cos(4 * y + phases[1])
        * np.sin(6 * z + phases[2])
    )
    density = np.clip(1.0 - np.sqrt(x * x + y * y + z * z) / 0.9 + 0.4 * bumps, 0, None)
    return VoxelGrid(density, [-1, -1, -1], [1, 1, 1])


BLOB = blob((14, 12, 13))


def rays_of(camera: AnyCamera) -> tuple[np.ndarray, np.ndarray]:
    return rays(camera)


def relative_error(found: np.ndarray, exact: np.ndarray) -> float:
    """Give the relative root mean square error of a picture."""
    return float(np.linalg.norm(found - exact) / np.linalg.norm(exact))
