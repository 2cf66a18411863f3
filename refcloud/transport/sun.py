"""Optical depth to the sun once for a whole grid, and kept while both stand still."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked, complaint
from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.cloudmap.voxels import MOST_VOXELS
from refcloud.conventions import Array, Vector, unit_vector
from refcloud.transport.sheared import sheared_depths

Scale = Literal[1, 2]
Dtype = Literal["float64", "float32"]
# Beyond this ratio of a cell's edges rays run along the shortest; no number overflows.
FLATTEST = 1e150
# Rays that move less than this across a slice stay on their cells, in any grid.
STRAIGHT = 1e-16


@dataclass(frozen=True, repr=False)
class LightVolume:
    """Column densities from a grid's samples to one sun: a light volume.

    Attributes
    ----------
    grid
        The cloud map that the light passes.
    direction
        Toward the sun, unit vector of shape (3,).
    scale
        Samples per cell along each axis, 1 or 2.
    density
        Column densities, shape (scale D, scale H, scale W) as ``[z, y, x]``, density
        times scene units: sample i of an axis lies at lower + (i + 1/2) h / scale.
        float64 or float32; not to be written.
    """

    grid: VoxelGrid
    direction: Array
    scale: Scale
    density: NDArray[Any]

    @property
    def lower(self) -> Array:
        """The box's lower corner, as of the grid."""
        return self.grid.lower

    @property
    def upper(self) -> Array:
        """The box's upper corner, as of the grid."""
        return self.grid.upper

    def __repr__(self) -> str:
        """Say what it is without its numbers."""
        x, y, z = self.direction
        return (
            f"LightVolume(shape {self.density.shape}, {self.density.dtype},"
            f" sun {x:.4g} {y:.4g} {z:.4g})"
        )


@checked
def sun_depths(
    grid: VoxelGrid,
    direction: Vector,
    *,
    scale: Scale = 1,
    dtype: Dtype = "float64",
) -> LightVolume:
    """Give the column density from every sample of a grid to the sun.

    Formula: integral of density ds toward the sun, as `column_density`, by the running
    accumulator of `refcloud.transport.sheared`

    Parameters
    ----------
    grid
        The cloud map.
    direction
        Toward the sun, shape (3,), any length but 0.
    scale
        Samples per cell along each axis: 1 at the cells' centres, 2 at the centres of
        their eighths.
    dtype
        Type of the arithmetic and the result; float32 adds 1e-6 of the largest.

    Returns
    -------
    The light volume. Times sigma_t its values are optical depths, and interpolate
    their exponential rather than them.

    Raises
    ------
    ValueError
        There would be more samples than 2^28.

    Source: document D (R05): its march to the light, once for all samples.

    Examples
    --------
    >>> grid = VoxelGrid(np.ones((1, 2, 1)), [0, 0, 0], [1, 2, 1])
    >>> sun_depths(grid, [0, 1, 0]).density.ravel()
    array([1.5, 0.5])
    """
    shape = tuple(scale * n for n in grid.density.shape)
    if scale**3 * grid.density.size > MOST_VOXELS:
        raise ValueError(
            complaint("scale", "at most 2^28 samples", f"{scale} of {shape}", "take 1")
        )
    toward, size = unit_vector(direction), cell_size(grid)
    # 1. Slices lie across the axis along which the sun is most cells away.
    with np.errstate(over="ignore"):
        cells = toward / np.minimum(size / size.min(), FLATTEST)
    main = int(np.argmax(np.abs(cells)))
    across = [axis for axis in (2, 1, 0) if axis != main]
    slopes = [abs(float(cells[axis] / cells[main])) for axis in across]
    slopes = [slope if slope > STRAIGHT else 0.0 for slope in slopes]
    length = float(size[main]) / abs(float(toward[main]))
    # 2. Turn the grid: slice 0 nearest the sun, and rays that move up both other axes.
    back = {axis: slice(None, None, -1) for axis in across if cells[axis] < 0.0}
    if cells[main] > 0.0:
        back[main] = slice(None, None, -1)
    flip = tuple(back.get(axis, slice(None)) for axis in (2, 1, 0))
    order = [2 - axis for axis in (main, *across)]
    out = np.empty(shape, dtype)
    slabs, turned = (a[flip].transpose(order) for a in (grid.density, out))
    if main == 0:  # slices across x are scattered in memory: gather them
        slabs, turned = np.ascontiguousarray(slabs), np.empty(turned.shape, dtype)
    # 3. Let the light through.
    peak = float(grid.density.max())
    slabs, length = _within_range(slabs, peak, length, np.dtype(dtype))
    sheared_depths(
        slabs, (slopes[0], slopes[1]), length=length, scale=scale, out=turned
    )
    if main == 0:
        out[flip].transpose(order)[...] = turned
    out.flags.writeable = False
    return LightVolume(grid, toward, scale, out)


def _within_range(
    slabs: Array, peak: float, length: float, dtype: np.dtype[Any]
) -> tuple[Array, float]:
    """Move the densities' magnitude into the length where a sum could overflow."""
    most = float(np.finfo(dtype).max) / (8 * len(slabs))
    if 1.0 / most < peak < most and peak * length < most:
        return slabs, length
    # What is deeper than the type can tell is as deep as it can tell: light is gone.
    return slabs / (peak or 1.0), min(peak * length, most)


def kept_volume(
    volumes: Iterable[LightVolume], grid: VoxelGrid, sun: Array, scale: Scale
) -> LightVolume | None:
    """Find a light volume that still holds: the same grid, sun and scale, unchecked.

    Parameters
    ----------
    volumes
        What the caller kept of earlier calls.
    grid
        The cloud map; the same object, since frozen values are told apart by that.
    sun
        Direction toward the sun, unit vector of shape (3,).
    scale
        Samples per cell that are asked for.

    Returns
    -------
    The light volume, or None where there is none.
    """
    for volume in volumes:
        same = volume.grid is grid and volume.scale == scale
        if same and np.array_equal(volume.direction, sun):
            return volume
    return None
