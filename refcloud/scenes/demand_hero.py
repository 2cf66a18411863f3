"""The scene ``demand``: a large cumulus over small ones, all of them marched.

The shape is that of the scene ``cumulus``, a pile of ellipsoids on a flat base, carved
by Worley noise (`refcloud.cloudmap.billows`); the light is scattered in octaves
(`refcloud.lighting.Octaves`), an approximation by name. Every cloud map is as fine as
the picture shows it: a voxel is some two pixels.
"""

from __future__ import annotations

import dataclasses
import math
import time
from typing import NamedTuple

import numpy as np

from refcloud.camera import AnyCamera, Camera, OrthographicCamera, axes
from refcloud.cloudmap import billows
from refcloud.compose import merged
from refcloud.conventions import WHOLE_SPHERE, Array, Skipped
from refcloud.image import Picture
from refcloud.lighting import Octaves, octave_march
from refcloud.optics import Medium, Sun
from refcloud.scene import Model, Motion, Scene, View, enter
from refcloud.scenes import cumulus
from refcloud.scenes.demand import marched_alone
from refcloud.scenes.demand_plane import no_model
from refcloud.sky import Sky, clear_sky

SUN = Sun(
    np.array([-0.62, 0.62, 0.42]),
    0.95 * WHOLE_SPHERE * np.array([1.0, 0.95, 0.86]),
)
MEDIUM = Medium(1.5, 1.0, 0.6, "hg")
VOXEL_PIXELS = 2.0  # of a picture, where the cloud is
FINEST, COARSEST = 0.22, 1.6  # scene units of the cloud's own


class Placed(NamedTuple):
    """A cloud of the scene: which, where, how large, how turned, in how much air."""

    seed: int
    x: float
    z: float
    scale: float
    turn: float  # radians about y
    air: float  # scene units over which its light falls to 1/e


# The large cloud's seed and turn were chosen by eye among 16 and two.
HERO = Placed(6, 0.0, 0.0, 1.0, math.radians(20.0), cumulus.HERO_AIR)
FIELD = tuple(
    Placed(seed, x, z, scale, 0.0, cumulus.FIELD_AIR)
    for seed, x, z, scale in cumulus.FIELD
)


def draw(model: Model, view: View) -> Picture:
    """Generate, light and march the clouds, the farthest first."""
    marched_alone(view)
    camera = view.camera or cumulus.camera(view)
    suns = (SUN,) if view.suns is None else view.suns
    medium = view.medium or MEDIUM
    seconds = {"sky": 0.0, "generate": 0.0, "march": 0.0}
    start = time.perf_counter()
    light = clear_sky(camera, Sky())
    seconds["sky"] = time.perf_counter() - start
    skipped: list[Skipped] = []
    notes = []
    clouds = farthest_first(camera)
    for placed in clouds:
        start = time.perf_counter()
        voxel = fineness(camera, placed)
        grid = billows(seed=placed.seed, voxel=voxel, observe=view.observe)
        middle = time.perf_counter()
        L, T, rows = octave_march(
            grid,
            seen_from(camera, placed),
            suns=tuple(turned_sun(sun, placed.turn) for sun in suns),
            medium=medium,
            octaves=Octaves(),
            step=0.5 * voxel,
            tolerance=view.tolerance / len(clouds),
            seed=view.seed,
            observe=view.observe,
        )
        # Air takes light of the cloud and puts its own there; behind is behind.
        clear = math.exp(-distance(camera, placed) / placed.air)
        L = clear * L + (1.0 - clear) * (1.0 - T)[..., None] * Sky().haze
        light = L + T[..., None] * light
        seconds["generate"] += middle - start
        seconds["march"] += time.perf_counter() - middle
        skipped += [*grid.skipped, *rows]
        what = "cloud" if placed is HERO else "field"
        voxels = np.count_nonzero(grid.density)
        notes.append(f"{what}: {voxels} voxels of {voxel:.2g}")
    return Picture(light, None, merged(skipped), seconds, tuple(notes))


def fineness(camera: AnyCamera, placed: Placed) -> float:
    """Give the edge of a voxel in the cloud's own units."""
    if isinstance(camera, Camera):
        pixel = 2.0 * math.tan(0.5 * camera.fov_y) / camera.height
        pixel *= distance(camera, placed)
    else:
        pixel = camera.height_of_view / camera.height
    return min(max(VOXEL_PIXELS * pixel / placed.scale, FINEST), COARSEST)


def distance(camera: AnyCamera, placed: Placed) -> float:
    """Give how far a cloud's place is from the eye."""
    way = camera.eye - np.array([placed.x, 0.0, placed.z])
    return math.sqrt(float(way @ way))


def farthest_first(camera: AnyCamera) -> list[Placed]:
    """Order the clouds for one eye: none of them reaches through another."""
    return sorted(
        (*FIELD, HERO), key=lambda placed: distance(camera, placed), reverse=True
    )


def seen_from(camera: AnyCamera, placed: Placed) -> AnyCamera:
    """Move an eye into the frame that a cloud was made in: the picture stays."""
    place, up = np.array([placed.x, 0.0, placed.z]), axes(camera)[1]
    if isinstance(camera, OrthographicCamera):
        height = camera.height_of_view / placed.scale
        camera = dataclasses.replace(camera, height_of_view=height)
    return dataclasses.replace(
        camera,
        eye=turned(camera.eye - place, placed.turn) / placed.scale,
        target=turned(camera.target - place, placed.turn) / placed.scale,
        # What is up in the picture, also where the eye looks along its own `up`.
        up=turned(up, placed.turn),
    )


def turned_sun(sun: Sun, turn: float) -> Sun:
    """Move a sun into the frame of a cloud."""
    return Sun(turned(sun.direction, turn), sun.irradiance)


def turned(vector: Array, turn: float) -> Array:
    """Turn a vector back about y by an angle that a cloud is turned by."""
    c, s = math.cos(turn), math.sin(turn)
    x, y, z = vector
    return np.array([c * x - s * z, y, s * x + c * z])


enter(
    Scene(
        "demand",
        "a marched cumulus over a field of small ones",
        no_model,
        draw,
        Motion(cumulus.eye, (SUN,)),
    )
)
