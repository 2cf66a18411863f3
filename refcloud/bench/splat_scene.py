"""The scene of the splat benchmark: five clouds of fourteen puffs, all from hashes."""

from __future__ import annotations

import dataclasses
import functools
import math

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import Camera, project
from refcloud.conventions import WHOLE_SPHERE, Array
from refcloud.lighting import LitMetaballs, Look, sunward
from refcloud.lighting.sunward import worth_of_light
from refcloud.metaballs import Metaballs, axis_depth
from refcloud.noise import uniform
from refcloud.optics import Medium, Sun

WIDTH, HEIGHT = 1024, 768
CLUSTERS, PUFFS = 5, 14
EYE = np.array([0.0, 0.0, 40.0])
SPREAD = np.array([24.0, 11.0, 16.0])  # of the clouds' middles, scene units
EXTENT = np.array([7.5, 4.0, 5.0])  # of one cloud, semi-axes
PUFF = 2.4  # radius of one puff
# Median radius of the projected balls in pixels, by their number.
FOOTPRINTS = {100: 67.0, 1200: 28.0, 10_000: 14.6, 100_000: 4.7}
# Bright enough that the lit sides of the clouds come near displayed white.
SUN = Sun(np.array([-0.5, 0.8, 0.4]), np.full(3, 8.0 * WHOLE_SPHERE))
ALBEDO = 0.9
MEDIUM = Medium(1.0, ALBEDO)
# Flat colours and no erosion: what the paper draws, by Beer's law.
FLAT = Look(
    scattering="man2003",
    footprint="profile",
    readback="disc",
    sky_light=np.zeros(3),
    ground_light=np.zeros(3),
    light_reach=0.0,
    erosion=0.0,
    erosion_depth=1.0,
    relief=0.0,
    buffer=256,
)


# Light from sky and ground as well: no two channels of a colour are multiples.
COLOURED = dataclasses.replace(
    FLAT,
    sky_light=np.array([0.3, 0.5, 0.9]),
    ground_light=np.array([0.2, 0.15, 0.1]),
)


def eye() -> Camera:
    """Look at the clouds from the front, 60 degrees high: 665 pixels a unit at 1."""
    return Camera(
        EYE, np.zeros(3), fov_y=math.radians(60.0), width=WIDTH, height=HEIGHT
    )


@functools.cache
def balls(count: int) -> Metaballs:
    """Scatter balls of depth 0.5 to 1.5 on their axes over the puffs.

    Parameters
    ----------
    count
        How many: a key of `FOOTPRINTS` brings its footprints, another the nearest's.

    Returns
    -------
    The balls.
    """
    k, axis = np.arange(count), np.arange(3)
    cluster, puff = k % CLUSTERS, k // CLUSTERS % PUFFS
    row = cluster * PUFFS + puff
    middle = (uniform(cluster[:, None], axis, seed=1) - 0.5) * SPREAD * 2.0
    middle += EXTENT * _in_unit_ball(row, 2)
    centers = middle + PUFF * _in_unit_ball(k, 3)
    shape = 0.85 + 0.7 * np.square(uniform(k, 4, seed=4))  # some are larger
    _, _, _, scale = project(eye(), centers)
    nearest = min(FOOTPRINTS, key=lambda n: abs(math.log(n / count)))
    radii = shape * (FOOTPRINTS[nearest] / float(np.median(shape * scale)))
    tau = 0.5 + uniform(k, 5, seed=5)
    unit_depth = axis_depth(1.0, np.ones(count), radii, "wyvill")
    return Metaballs(centers, radii, tau / unit_depth)


def _in_unit_ball(k: NDArray[np.int_], seed: int) -> Array:
    """Give hashed places in the unit ball, the same for the same number."""
    way = uniform(k[:, None], np.arange(3), seed=seed + 10) - 0.5
    way /= np.sqrt(np.square(way).sum(axis=1, keepdims=True))
    return way * np.cbrt(uniform(k, 3, seed=seed + 20))[:, None]


def lit(count: int, look: Look = FLAT, tolerance: float = 0.0) -> LitMetaballs:
    """Light the balls by one sun."""
    made = balls(count)
    return sunward(made, (SUN,), medium=MEDIUM, look=look, tolerance=tolerance)


def worth(count: int) -> float:
    """Give how much a colour changes with the share of the sun that reaches a ball."""
    return worth_of_light(balls(count), (SUN,), MEDIUM, FLAT)
