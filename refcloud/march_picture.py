"""A marched cloud before a background: one ray for every pixel."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from refcloud.camera import AnyCamera, rays
from refcloud.cloudmap import VoxelGrid
from refcloud.compose import Clock, painted
from refcloud.conventions import Array, Observer
from refcloud.image import Picture
from refcloud.lighting import Haze
from refcloud.lighting.colours import clearness
from refcloud.march import Mixing
from refcloud.march.marched import marched
from refcloud.march.multiple import Scattering, marched_multiple
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun
from refcloud.transport import LightVolume

ONCE = "marched: light that is scattered more than once is left out"


def draw_march(
    cloud: VoxelGrid | Metaballs,
    camera: AnyCamera,
    suns: tuple[Sun, ...],
    background: Any,
    *,
    medium: Medium,
    haze: Haze | None = None,
    ambient: Array | None = None,
    mixing: Mixing | None = None,
    scattering: Scattering = "single",
    tolerance: float = 0.0,
    volumes: tuple[LightVolume, ...] = (),
    observe: Observer | None = None,
) -> Picture:
    """Draw a cloud by marching.

    Parameters
    ----------
    cloud
        A cloud map, or metaballs.
    camera
        The eye.
    suns
        The lights.
    background
        As `render`.
    medium, haze, ambient, mixing, scattering
        As `render`; the haze counts the distance to the cloud's middle.
    tolerance
        Largest error of a channel.
    volumes
        As `refcloud.march.integrate`.
    observe
        Called with (name, value) for each intermediate.

    Returns
    -------
    The picture.
    """
    seconds: dict[str, float] = {}
    clock = Clock(seconds)
    behind = painted(background, camera, suns)
    clock.stop("sky")
    if haze is not None and behind is not None:
        # Light and transmittance are mixed after the march: their errors add up.
        tolerance /= 1.0 + max(float(behind.max()), float(haze.color.max()))
    origins, directions = rays(camera)
    march, notes = marched, (ONCE,)
    if scattering != "single":
        march, notes = partial(marched_multiple, scattering=scattering), ()
    found = march(
        cloud,
        origins.reshape(-1, 3),
        directions.reshape(-1, 3),
        suns=suns,
        medium=medium,
        ambient=ambient,
        mixing=mixing or Mixing(),
        tolerance=tolerance,
        background=None if behind is None or haze else behind.reshape(-1, 3),
        observe=observe,
        camera=camera,
        volumes=volumes,
    )
    size = (camera.height, camera.width)
    radiance = found.radiance.reshape(*size, 3)
    through = found.transmittance.reshape(*size, -1)  # (H, W, 1 or 3)
    if haze is not None:
        clear = float(clearness(haze, middle_of(cloud)[None], camera)[0])
        radiance = clear * radiance + (1.0 - clear) * (1.0 - through) * haze.color
    alpha = None
    if behind is None:
        alpha = np.clip(1.0 - through.mean(axis=2), 0.0, 1.0)
    elif haze is not None:
        radiance = radiance + through * behind
    clock.stop("march")
    return Picture(radiance, alpha, found.skipped, seconds, (*notes, *found.notes))


def middle_of(cloud: VoxelGrid | Metaballs) -> Array:
    """Give the middle of a cloud's box, shape (3,); of no ball the origin."""
    if isinstance(cloud, VoxelGrid):
        return 0.5 * cloud.lower + 0.5 * cloud.upper
    if not len(cloud):
        return np.zeros(3)
    reach = cloud.radii[:, None]
    lower, upper = (cloud.centers - reach).min(axis=0), (cloud.centers + reach).max(0)
    return 0.5 * lower + 0.5 * upper
