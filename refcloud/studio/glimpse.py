"""A marched cloud at a glance: what the page shows while a slider moves.

`refcloud.render` follows exact rays to prove its error, some tenths of a second even
for a small picture. A glimpse proves nothing: light is looked up at the voxels, and
samples of a ray are half a voxel apart.
"""

from __future__ import annotations

import dataclasses
import functools

import numpy as np

from refcloud.camera import Camera
from refcloud.choices import AMBIENT
from refcloud.cloudmap import VoxelGrid, cell_size, generate
from refcloud.conventions import Array
from refcloud.image import Picture
from refcloud.lighting import Octaves, octave_march
from refcloud.march import Mixing
from refcloud.march.quadrature import grid_through_the_middle
from refcloud.optics import Medium, Sun
from refcloud.scene import View
from refcloud.scenes import cumulus, multiple
from refcloud.sky import Sky, clear_sky

ROUGH = 8.0 / 255.0  # its rays end behind fronts that let no more through
BLACK = np.zeros(3)


def glimpse(
    cloud: VoxelGrid,
    *,
    camera: Camera,
    suns: tuple[Sun, ...],
    medium: Medium,
    background: Sky,
    mixing: Mixing,
    ambient: Array | None = None,
    scattering: str = "single",
) -> Picture:
    """March a cloud map roughly; the arguments are those of `refcloud.render`.

    Parameters
    ----------
    cloud
        The cloud map.
    camera, suns, background, ambient
        As `render`.
    medium
        A Rayleigh phase function is taken for an isotropic one, and extinction by
        channel for its mean.
    mixing
        The factor toward the eye is taken for both ways.
    scattering
        "multiple" is guessed by octaves of scattering.

    Returns
    -------
    The picture.
    """
    octaves = Octaves()
    if scattering == "single":
        light = AMBIENT if ambient is None else ambient
        octaves = Octaves(
            1, backward_share=0.0, sky_light=light, ground_light=BLACK, sky_extinction=0
        )
    sigma_t = float(np.mean(medium.sigma_t)) * mixing.light_absorption_through_cloud
    phase = "isotropic" if medium.phase == "rayleigh" else medium.phase
    L, T, skipped = octave_march(
        cloud,
        camera,
        suns=suns,
        medium=dataclasses.replace(medium, sigma_t=sigma_t, phase=phase),
        octaves=octaves,
        step=0.5 * float(cell_size(cloud).min()),
        tolerance=ROUGH,
    )
    behind = clear_sky(camera, background, suns=suns)
    note = "coarse: light looked up at the voxels, error not known"
    return Picture(L + T[..., None] * behind, None, skipped, {}, (note,))


def glimpse_of_multiple(
    *,
    width: int = 0,
    height: int = 0,
    camera: Camera | None = None,
    suns: tuple[Sun, ...] | None = None,
    medium: Medium | None = None,
    tolerance: float = ROUGH,
    seed: int = 0,
) -> Picture:
    """Draw the scene ``multiple`` roughly, without solving its light.

    Parameters
    ----------
    width, height, camera, suns, medium
        As `render`; what is None is the scene's own.
    tolerance, seed
        Of the scene; a glimpse has no use for them.

    Returns
    -------
    The picture.
    """
    grid = _coarse_cumulus()
    sigma_t = multiple.OWN.thickness / grid_through_the_middle(grid)
    return glimpse(
        grid,
        camera=camera or cumulus.camera(View(width, height)),
        suns=(multiple.OWN.sun,) if suns is None else suns,
        medium=medium or Medium(sigma_t, g=multiple.OWN.g, phase="hg"),
        background=Sky(),
        mixing=Mixing(),
        scattering="multiple",
    )


@functools.cache
def _coarse_cumulus() -> VoxelGrid:
    return generate(seed=multiple.OWN.seed, voxel=multiple.COARSEST)
