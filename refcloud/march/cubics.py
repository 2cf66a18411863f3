"""Columns toward a sun between the samples of a table, read by cubics.

Linear interpolation of a light volume is off by hundredths of white within a voxel.
Along a sun's ray a column falls smoothly, and beside it its slope is continuous: cubics
through four samples an axis (Catmull-Rom) err a tenth as much.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.cloudmap import cell_size
from refcloud.cloudmap.sample import clamped_trilinear
from refcloud.conventions import Array
from refcloud.transport import LightVolume

PLACES = 1 << 15  # at a time: tables that stay in the cache
RIM = 2  # samples around a table: a cubic weighs two to each side


@dataclass(frozen=True)
class Smooth:
    """Column densities to one sun, of a light volume, with a rim of copies.

    Attributes
    ----------
    lower, size
        The grid's lower corner and edges between samples, shape (3,), scene units.
    table
        Columns, shape (D + 4, H + 4, W + 4) as ``[z, y, x]``.
    """

    lower: Array
    size: Array
    table: NDArray[np.float32]

    def columns(self, points: Array) -> Array:
        """Interpolate the columns from points (M, 3) on, shape (M,)."""
        found = np.empty(len(points))
        for start in range(0, len(points), PLACES):
            part = slice(start, start + PLACES)
            x, y, z = ((points[part] - self.lower) / self.size - 0.5 + RIM).T
            found[part] = read_cubics(self.table, (z, y, x))
        return found


@dataclass(frozen=True)
class Straight:
    """Column densities to one sun, of a light volume, read along straight lines."""

    volume: LightVolume

    def columns(self, points: Array) -> Array:
        """Interpolate the columns from points (M, 3) on, shape (M,)."""
        size = cell_size(self.volume.grid) / self.volume.scale
        places = ((points - self.volume.lower) / size - 0.5).T
        return clamped_trilinear(self.volume.density, *places)


def smooth_columns(volume: LightVolume) -> Smooth:
    """Prepare a light volume for being read by cubics."""
    table = np.pad(volume.density.astype(np.float32, copy=False), RIM, mode="edge")
    return Smooth(volume.lower, cell_size(volume.grid) / volume.scale, table)


def read_cubics(
    table: NDArray[np.float32], places: Iterable[Array]
) -> NDArray[np.float32]:
    """Read a table between its samples, 4 x 4 x 4 of them around each place.

    Parameters
    ----------
    table
        Shape (K, V, U), 4 along each axis at least; no value is negative.
    places
        Along the three axes, in samples, shape (M,) each; beyond the table the last
        cubic goes on.

    Returns
    -------
    Shape (M,), at least 0.
    """
    base, weights = np.intp(0), []
    for place, n in zip(places, table.shape, strict=True):
        whole = np.clip(np.floor(place), 1, n - 3).astype(np.intp)
        base = base * n + (whole - 1)
        weights.append(catmull_rom((place - whole).astype(np.float32)))
    _, V, U = table.shape
    flat = table.reshape(-1)
    total = np.zeros(np.shape(base), np.float32)
    for k, weight_w in enumerate(weights[0]):
        plane = np.zeros_like(total)
        for j, weight_v in enumerate(weights[1]):
            at = base + (k * V + j) * U
            row = flat.take(at)
            row *= weights[2][0]
            for i in (1, 2, 3):
                at += 1
                row += flat.take(at) * weights[2][i]
            row *= weight_v
            plane += row
        plane *= weight_w
        total += plane
    return np.maximum(total, np.float32(0.0))


def catmull_rom(f: NDArray[np.float32]) -> list[NDArray[Any]]:
    """Give the weights of four samples, for a share f of the way from the second."""
    return [
        f * (-0.5 + f * (1.0 - 0.5 * f)),
        1.0 + f * f * (1.5 * f - 2.5),
        f * (0.5 + f * (2.0 - 1.5 * f)),
        f * f * (0.5 * f - 0.5),
    ]
