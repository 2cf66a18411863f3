"""Single scattering for most cameras, slice by slice: shear-warp by matrix products.

An image on a regular grid of q (see `refcloud.march.shear`) sees the same part of every
slice, moved and scaled. Linear interpolation of a slice at places u is a product with
the tent matrix max(0, 1 - |u_i - j|), so a picture takes few and large operations:

1. *crop*: four slices at a time, and of them the rectangle in which there is cloud;
2. *resample* density and T_sun: B_v^T slice B_u (`refcloud.march.resample`);
3. *cross* them, front to back: a slice hides alpha = 1 - exp(-sigma density ds) and
   sends T alpha T_sun; T (1 - alpha) is left;
4. *enlarge* the image three times and *warp* it: each pixel reads it at its own q
   (`refcloud.march.warp`).

With light volumes at twice the grid's resolution there are twice as many slices, each
between two voxels, and T_sun is read at its own samples.

`march_slices(grid, camera, *, suns, medium, side=None, depths=None)` gives radiance and
transmittance of shape (H, W, 3), or None where slices cannot serve.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from refcloud.camera import AnyCamera
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Array
from refcloud.march.resample import Image, between, resampled, without_bias
from refcloud.march.view import FINER, View, part_of, view_of
from refcloud.march.warp import developed
from refcloud.optics import Medium, Sun
from refcloud.transport import LightVolume, sun_depths

BLOCK = 6  # slices at a time: they share a rectangle, and fill a cache
# Of densities and optical depths per cell: single precision holds their products.
SINGLE = 1e15


def march_slices(
    grid: VoxelGrid,
    camera: AnyCamera,
    *,
    suns: tuple[Sun, ...],
    medium: Medium,
    side: int | None = None,
    finer: float = FINER,
    depths: Sequence[LightVolume] | None = None,
    unbiased: bool = False,
) -> tuple[Array, Array] | None:
    """Integrate light that is scattered once along the rays of a camera, unchecked.

    Formula: as `refcloud.march.integrate`, with one sample in each slice

    Parameters
    ----------
    grid
        The cloud map.
    camera
        Pinhole or orthographic.
    suns
        The lights.
    medium
        What the cloud is made of; extinction may differ by channel.
    side
        Samples of the image along its longer side; None for `finer` per voxel.
    finer
        Samples per voxel where the cloud is nearest.
    depths
        A light volume for each sun, all of one scale; None makes them.
    unbiased
        Whether the light of a slice is corrected by what its linear interpolation adds
        on average; see `refcloud.march.resample.without_bias`.

    Returns
    -------
    Radiance and transmittance, shape (H, W, 3) each; None where slices cannot serve:
    rays in both directions along every axis, or too steep (`shear.STEEPEST`), or
    numbers beyond single precision.
    """
    if not single(grid, medium):
        return None
    view = view_of(grid, camera, side, finer)
    if view is None:
        return None
    if depths is None:
        depths = [sun_depths(grid, sun.direction, dtype="float32") for sun in suns]
    colours = np.unique(medium.sigma_t_rgb)
    light, hidden = crossed(view, grid, depths, colours, unbiased)
    channel = np.searchsorted(colours, medium.sigma_t_rgb)
    return developed(camera, view, light, hidden, suns, medium, channel)


def single(grid: VoxelGrid, medium: Medium) -> bool:
    """Tell whether single precision holds a cloud's numbers."""
    densest, h = float(grid.density.max()), (grid.upper - grid.lower).max()
    with np.errstate(over="ignore"):
        depth = densest * float(h) * float(medium.sigma_t_rgb.max())
    # Nothing below is told apart from nothing.
    return densest < SINGLE and depth < SINGLE and not 0.0 < densest < 1.0 / SINGLE


def crossed(
    view: View,
    grid: VoxelGrid,
    depths: Sequence[LightVolume],
    sigma: Array,
    unbiased: bool = False,
) -> tuple[Image, Image]:
    """March the image's samples through all slices, front to back.

    Parameters
    ----------
    view
        Where the samples are.
    grid, depths
        The cloud map, and a light volume for each of S suns.
    sigma
        The C different extinctions, shape (C,).
    unbiased
        As `march_slices`.

    Returns
    -------
    In-scattered light per unit of what a sun would send, shape (S, C, R_v, R_u), and
    what is hidden, 1 - T, shape (C, R_v, R_u).
    """
    shear, s = view.shear, depths[0].scale if depths else 1
    light = np.zeros((len(depths), len(sigma), *view.shape), np.float32)
    through = np.ones(light.shape[1:], np.float32)
    slabs = shear.turned(grid.density)
    volumes = [shear.turned(volume.density) for volume in depths]
    step = shear.step(view.q_v[:, None], view.q_u) / s
    step = np.broadcast_to(step, view.shape).astype(np.float32)
    ends = view.ends(view.q_v[:, None], view.q_u) if view.cut else None
    for first in range(0, s * len(slabs), BLOCK):
        # 1. Crop.
        part = part_of(view, (np.arange(first, first + BLOCK) + 0.5) / s - 0.5, 0.5 / s)
        if part is None:
            continue
        # 2. Resample.
        window, w = part.image, part.w
        column = resampled(between(part.of(slabs), w), *part.places(1))
        column *= step[window]
        if ends is not None:
            column *= share_inside(w, 0.5 / s, *(end[window] for end in ends))
        slices = slice(round(s * (w[0] + 0.5) - 0.5), None)
        suns = [part.of(v[slices][: len(w)], s) for v in volumes]
        places = part.places(s)
        for c, sigma_t in enumerate(sigma):
            # 3. Cross: the light of the nearer slices, then what they let through.
            alpha = -np.expm1(column * np.float32(-sigma_t))
            left = 1.0 - alpha
            before = through[c][window]
            for n, depth in enumerate(suns):
                lit = np.exp(depth * np.float32(-sigma_t))
                sent = resampled(without_bias(lit) if unbiased else lit, *places)
                sent *= alpha
                light[n, c][window] += before * behind_each_other(sent, left)
            before *= left.prod(axis=0)
    return light, 1.0 - through


def behind_each_other(sent: Image, left: Image) -> Image:
    """Sum what n slices send through those in front: s0 + l0 (s1 + l1 (s2 + ...))."""
    total = sent[-1]
    for nearer, through in zip(sent[-2::-1], left[-2::-1], strict=True):
        total *= through
        total += nearer
    return total


def share_inside(w: Array, half: float, first: Image, last: Image) -> Image:
    """Give the share of slices, from w - half to w + half, that rays are in the box."""
    plane = w.astype(np.float32)[:, None, None]
    share = np.minimum(last, plane + half) - np.maximum(first, plane - half)
    return np.clip(share / np.float32(2.0 * half), 0.0, 1.0)
