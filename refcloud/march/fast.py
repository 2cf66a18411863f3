"""Marching to a tolerance: a light volume, slabs, and rays in single precision."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Array
from refcloud.march.cells import Lattice, cropped, lattice
from refcloud.march.gather import BLOCK, Counts, Slabs, gather
from refcloud.march.light import sources
from refcloud.march.lines import STEEPEST, Frame, as_lines, by_frame, frame_numbers
from refcloud.march.mixing import PHYSICAL, Mixing
from refcloud.march.planes import planes
from refcloud.march.resample import without_bias
from refcloud.march.steps import reaching
from refcloud.march.volumes import Volumes
from refcloud.optics import Medium, Sun
from refcloud.transport import LightVolume

Scale = Literal[1, 2]


@dataclass(frozen=True)
class Setting:
    """How finely a march looks: cells in a slab, samples of light per cell."""

    thickness: float
    scale: Scale


def fast(
    cloud: VoxelGrid,
    grid: Lattice,
    origins: Array,
    directions: Array,
    *,
    suns: tuple[Sun, ...],
    lit: Array,
    medium: Medium,
    mixing: Mixing,
    setting: Setting,
    least: float,
    counts: Counts,
    frames: NDArray[np.intp],
    lights: list[NDArray[np.float32]],
    made: dict[tuple[Setting, Frame], Slabs] | None = None,
) -> tuple[Array, Array]:
    """March rays through slabs, unchecked.

    Parameters
    ----------
    cloud, grid
        The cloud map, and its lattice.
    origins, directions
        Shape (N, 3), scene units; unit vectors.
    suns, lit
        The lights, and what each sends along each ray, shape (S, N, 3).
    medium, mixing
        Extinction, and factors on optical depths.
    setting
        How finely.
    least
        Transmittance below which a ray is dropped.
    counts
        Adds up what was left out.
    frames
        Of `frame_numbers`, shape (N,).
    lights
        Of `light_volumes`, at the setting's scale.
    made
        Slabs of earlier calls with the same cloud and lights; added to.

    Returns
    -------
    Radiance of shape (N, 3), and columns of density of shape (N,).
    """
    sigma_t = np.atleast_1d(medium.sigma_t)
    through_cloud = mixing.light_absorption_through_cloud
    radiance, column = np.zeros((len(origins), 3)), np.zeros(len(origins))
    made = {} if made is None else made
    for frame, which in by_frame(frames):
        lines, hits = as_lines(grid, frame, origins[which], directions[which])
        which = which[hits]
        if not len(which):
            continue
        if (setting, frame) not in made:
            made[setting, frame] = as_slabs(cloud, grid, frame, lights, setting)
        found, column[which] = gather(
            made[setting, frame],
            lines,
            rates=through_cloud * sigma_t,
            suns=len(suns),
            least=least,
            counts=counts,
        )
        # A drop of transmittance is k sigma_t times what it scatters.
        found *= 1.0 / through_cloud if through_cloud > 0.0 else sigma_t
        for source, share in zip(lit[:, which], found.transpose(1, 0, 2), strict=True):
            radiance[which] += source * share
    return radiance, column


def light_volumes(
    cloud: VoxelGrid,
    suns: tuple[Sun, ...],
    medium: Medium,
    mixing: Mixing,
    scale: Scale,
) -> list[NDArray[np.float32]]:
    """Give the light that reaches every sample, of each sun at each extinction.

    What is interpolated later is this light, not the optical depth.
    """
    return reached(Volumes(cloud, suns, ()).at(scale), medium, mixing)


def reached(
    depths: list[LightVolume], medium: Medium, mixing: Mixing
) -> list[NDArray[np.float32]]:
    """Turn column densities into light, of each sun at each extinction.

    Slabs interpolate it linearly along all axes: what that adds on average is taken
    away beforehand, which halves the error of a frame.
    """
    return [
        without_bias(reaching(volume.density * np.float32(sigma), mixing), (0, 1, 2))
        for volume in depths
        for sigma in np.atleast_1d(medium.sigma_t)
    ]


def as_slabs(
    cloud: VoxelGrid,
    grid: Lattice,
    frame: Frame,
    lights: list[NDArray[np.float32]],
    setting: Setting,
) -> Slabs:
    """Cut density and light into slabs across a frame's w."""
    # 1. Edges of slabs, from the first that holds density to the last.
    first, last = grid.first[frame.axis], grid.last[frame.axis]
    if frame.flipped:
        top = grid.counts[frame.axis] - 1.0
        first, last = top - last, top - first
    count = max(int(np.ceil((last - first) / setting.thickness - 1e-9)), 1)
    edges = np.minimum(first + setting.thickness * np.arange(count + 1), last)
    how = {"thickness": setting.thickness}

    # 2. The density, and with it the light where both have samples in one place.
    density = frame.turned(cloud.density)
    turned = [frame.turned(light) for light in lights]
    if setting.scale == 1 or not turned:
        volumes = (planes([density, *turned], edges, scale=1, **how),)
    else:
        light = planes(turned, edges, scale=setting.scale, **how)
        volumes = (planes([density], edges, scale=1, **how), light)

    # 3. Which spaces between four samples hold density; blocks of slabs together, as
    # far around as a ray moves from a block's middle to the middle of its last slab.
    _, V, U = volumes[0].shape
    held = np.zeros((-(-count // BLOCK) * BLOCK, V, U), bool)
    held[:count] = volumes[0].pairs[0].real.reshape(count, V, U) > 0.0
    for axis in (1, 2):
        low, high = [slice(None)] * 3, [slice(None)] * 3
        low[axis], high[axis] = slice(None, -1), slice(1, None)
        held[tuple(low)] |= held[tuple(high)]
    blocks = np.asarray(held.reshape(-1, BLOCK, V, U).any(axis=1))
    reach = int(np.ceil(0.5 * (BLOCK - 1) * setting.thickness * STEEPEST))
    blocks = dilated(blocks, reach)
    return Slabs(
        float(first),
        setting.thickness,
        count,
        volumes,
        held.reshape(-1),
        blocks.reshape(-1),
        (V, U),
    )


def dilated(marked: NDArray[np.bool_], reach: int) -> NDArray[np.bool_]:
    """Mark what lies within `reach` of a marked one along the last two axes."""
    for axis in (1, 2):
        wide = marked.copy()
        for step in range(1, reach + 1):
            low, high = [slice(None)] * 3, [slice(None)] * 3
            low[axis], high[axis] = slice(None, -step), slice(step, None)
            wide[tuple(low)] |= marked[tuple(high)]
            wide[tuple(high)] |= marked[tuple(low)]
        marked = wide
    return marked


def march_slabs(
    cloud: VoxelGrid,
    origins: Array,
    directions: Array,
    *,
    suns: tuple[Sun, ...],
    medium: Medium,
    thickness: float = 2.0,
    scale: Scale = 1,
    least: float = 1e-4,
) -> tuple[Array, Array]:
    """March any rays through slabs of one setting, unchecked, light volume included.

    Parameters
    ----------
    cloud
        The cloud map.
    origins, directions
        Shape (N, 3), scene units; unit vectors.
    suns, medium
        The lights, and what the cloud is made of.
    thickness, scale
        Cells in a slab, and samples of light per cell.
    least
        Transmittance below which a ray is dropped.

    Returns
    -------
    Radiance of shape (N, 3), and columns of density of shape (N,).
    """
    inner = cropped(cloud)
    setting = Setting(thickness, scale)
    small = lattice(inner)
    return fast(
        inner,
        small,
        origins,
        directions,
        suns=suns,
        lit=sources(suns, medium, directions=directions),
        medium=medium,
        mixing=PHYSICAL,
        setting=setting,
        least=least,
        counts=Counts(),
        frames=frame_numbers(small, directions),
        lights=light_volumes(inner, suns, medium, PHYSICAL, scale),
    )
