"""Rays to march with all that their light depends on, and what they show at the end."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import AnyCamera
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Array
from refcloud.march.cells import Lattice
from refcloud.march.exact import ColumnsTo, exact
from refcloud.march.mixing import Mixing
from refcloud.optics import Medium, Sun
from refcloud.transport import LightVolume


@dataclass(frozen=True)
class Task:
    """Rays to march, and all that their light depends on.

    Attributes
    ----------
    cloud, grid
        The cloud map, and its lattice.
    origins, directions
        Shape (N, 3), scene units; unit vectors.
    suns, lit
        The lights, and what each sends along each ray, shape (S, N, 3).
    medium, mixing
        Extinction, and factors on optical depths.
    ambient
        Radiance from all sides, shape (3,).
    background
        What lies behind each ray, shape (N, 3); None where alpha is wanted.
    camera
        Whose rays they are, row by row; None for any rays.
    kept
        Light volumes of earlier calls.
    shape
        Leading axes of the caller's rays; () for a list.
    """

    cloud: VoxelGrid
    grid: Lattice
    origins: Array
    directions: Array
    suns: tuple[Sun, ...]
    lit: Array
    medium: Medium
    mixing: Mixing
    ambient: Array
    background: Array | None
    camera: AnyCamera | None = None
    kept: tuple[LightVolume, ...] = ()
    shape: tuple[int, ...] = ()

    def taken(self, which: NDArray[np.intp]) -> Task:
        """Keep some rays."""
        behind = None if self.background is None else self.background[which]
        return Task(
            self.cloud,
            self.grid,
            self.origins[which],
            self.directions[which],
            self.suns,
            self.lit[:, which],
            self.medium,
            self.mixing,
            self.ambient,
            behind,
        )

    @property
    def rows(self) -> tuple[int, int]:
        """Tell which rays are neighbours: rows and columns; one row for a list."""
        if self.camera is not None:
            return self.camera.height, self.camera.width
        count = len(self.origins)
        columns = self.shape[-1] if self.shape and count else count
        return (count // columns if columns else 0), columns

    @property
    def brightest(self) -> float:
        """Give what a ray can show at most, at least white."""
        light = float(self.lit.sum(axis=0).max(initial=0.0)) + self.ambient.max()
        behind = 1.0 if self.background is None else self.background.max(initial=1.0)
        return max(light, float(behind), 1.0)

    def seen(self, radiance: Array, column: Array) -> tuple[Array, Array]:
        """Complete what rays show; see `completed`."""
        return completed(
            radiance, column, self.medium, self.mixing, self.ambient, self.background
        )

    def error(self, found: tuple[Array, Array], expected: tuple[Array, Array]) -> float:
        """Give the largest difference of a channel of any ray."""
        return float(self.errors(found, expected).max(initial=0.0))

    def errors(
        self, found: tuple[Array, Array], expected: tuple[Array, Array]
    ) -> Array:
        """Give each ray's largest difference; alpha is a channel where it is shown."""
        a, b = self.seen(*found), self.seen(*expected)
        worst = np.abs(a[0] - b[0]).max(axis=1)
        if self.background is None:
            worst = np.maximum(worst, np.abs(a[1] - b[1]).max(axis=1))
        return worst

    def exact(
        self,
        least: float = 0.0,
        points: int = 4,
        columns_to: ColumnsTo | None = None,
    ) -> tuple[Array, Array]:
        """Integrate the rays; see `refcloud.march.exact`."""
        return exact(
            self.grid,
            self.origins,
            self.directions,
            self.suns,
            self.lit,
            self.medium,
            self.mixing,
            least,
            points,
            columns_to,
        )


def completed(
    radiance: Array,
    column: Array,
    medium: Medium,
    mixing: Mixing,
    ambient: Array,
    background: Array | None,
) -> tuple[Array, Array]:
    """Add light from all sides and from behind to what the suns' light gives.

    Parameters
    ----------
    radiance, column
        Of the rays, shapes (N, 3) and (N,).
    medium, mixing, ambient, background
        As of `Task`.

    Returns
    -------
    Colours of shape (N, 3), and transmittance of shape (N, 1), or (N, 3) where sigma_t
    is RGB.
    """
    k = mixing.light_absorption_through_cloud
    tau = column[:, None] * (k * np.atleast_1d(medium.sigma_t))
    through = np.exp(-tau)
    light = radiance + medium.albedo_rgb * ambient * -np.expm1(-tau)
    if background is not None:
        light = light + through * background
    return light, through
