"""The scene ``demand``: a large cumulus over small ones, all of them marched.

The shape is that of the scene ``cumulus``, a pile of ellipsoids on a flat base, carved
by Worley noise (`refcloud.cloudmap.billows`). Light of every order of scattering is
solved on a coarser map; with ``scattering="single"``, or in a coloured medium, it is
scattered in octaves (`refcloud.lighting.Octaves`), an approximation by name. Every
cloud map is as fine as the picture shows it: a voxel is some two pixels.
"""

from __future__ import annotations

import dataclasses
import functools
import math
import time
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Literal

import numpy as np

from refcloud.camera import AnyCamera, Camera, OrthographicCamera, axes
from refcloud.checking import check_fields
from refcloud.cloudmap import VoxelGrid, billows
from refcloud.compose import merged
from refcloud.conventions import (
    WHOLE_SPHERE,
    Array,
    Range,
    Skipped,
    Vector,
)
from refcloud.declared import Kind, enter_kind
from refcloud.image import Picture
from refcloud.lighting import Octaves, block_means, octave_march, solved_march
from refcloud.lighting.octave_march import SINGLE_PRECISION
from refcloud.optics import Medium, Sun
from refcloud.raster.meeting import reached_by_box, shares_of, together
from refcloud.scene import Model, Motion, Own, View
from refcloud.scenes import cumulus
from refcloud.scenes.cumulus import Placed
from refcloud.scenes.demand import marched_alone
from refcloud.sky import Sky, clear_sky
from refcloud.transport import PLANS, ScatteredLight, scattered_light
from refcloud.transport.scattering import report_of

# The solution's plan, whatever the picture's tolerance: that chooses its precision
# alone; and its map's voxels along the longest axis, of the large and a small cloud.
PLAN, VOXELS, FIELD_VOXELS = PLANS["quick"], 96, 40
VOXEL_PIXELS = 2.0  # of a picture, where the cloud is
FINEST, COARSEST = 0.22, 1.6  # scene units of the cloud's own
KEPT_FROM = (
    0.8  # voxels of small pictures: a map of 2 MB takes longer to make than draw
)


@dataclass(frozen=True)
class Hero:
    """A large cloud over small ones.

    Attributes
    ----------
    eye, target
        The camera.
    hero, field
        The large cloud, and the small ones.
    sun, medium
        The light, and what clouds are made of.
    sky
        Times the light from sky and ground of the octaves.
    octave_sun, octave_medium
        In the place of sun and medium where light is scattered in octaves: with
        --scattering single, or in a coloured medium.
    """

    eye: Vector
    target: Vector
    hero: Placed
    field: tuple[Placed, ...]
    sun: Sun
    medium: Medium
    sky: Annotated[float, Range(0.0, 100.0)]
    octave_sun: Sun
    octave_medium: Medium

    def __post_init__(self) -> None:
        check_fields(self)


# The large cloud's seed and turn were chosen by eye among 16 and two.
HERO = dataclasses.replace(cumulus.OWN.hero, seed=6)
FIELD = cumulus.OWN.field
SUN = Sun(
    np.array([-0.62, 0.62, 0.42]),
    0.95 * WHOLE_SPHERE * np.array([1.0, 0.95, 0.86]),
)
OWN = Hero(
    eye=cumulus.OWN.eye,
    target=cumulus.OWN.target,
    hero=HERO,
    field=FIELD,
    sun=Sun(SUN.direction, 0.68 * SUN.irradiance),
    # So dense that the skin alone shows, and a little dark in its folds.
    medium=Medium(5.0, 0.96, 0.3, "hg"),
    sky=1.2,
    octave_sun=SUN,
    octave_medium=Medium(1.5, 1.0, 0.6, "hg"),
)


def brings(of: Hero, model: Model | None, view: View) -> Own:
    """Give sun and medium: those of solved light, or of octaves."""
    scattering = view.scattering or best(view)
    if scattering == "single":
        return Own((of.octave_sun,), of.octave_medium, scattering=scattering)
    return Own((of.sun,), of.medium, scattering=scattering)


def draw(of: Hero, model: Model, view: View) -> Picture:
    """Generate, light and march the clouds, the farthest first."""
    marched_alone(view)
    camera = view.camera or own_eye(model, view, of=of)
    own = brings(of, model, view)
    solved, medium = (
        own.scattering == "multiple",
        view.medium or own.medium or of.medium,
    )
    suns = own.suns or () if view.suns is None else view.suns
    seconds = {"sky": 0.0, "generate": 0.0, "march": 0.0}
    start = time.perf_counter()
    light = clear_sky(camera, Sky())
    seconds["sky"] = time.perf_counter() - start
    skipped: list[tuple[Skipped, ...]] = []
    notes, lights = [], []
    clouds = farthest_first(camera, of)
    # What savings change of a cloud shows before its box, and adds up where boxes meet.
    made = [cloud_map(placed, camera, view, seconds) for placed in clouds]
    reached = [
        reached_by_box(grid.lower, grid.upper, seen_from(camera, placed))
        for placed, grid in zip(clouds, made, strict=True)
    ]
    shares = shares_of(reached)
    for placed, grid, share in zip(clouds, made, shares, strict=True):
        start, voxel = time.perf_counter(), fineness(camera, placed)
        how = {
            "step": 0.5 * voxel,
            "tolerance": view.tolerance * share,
            "seed": view.seed,
            "observe": view.observe,
        }
        here = seen_from(camera, placed)
        theirs = tuple(turned_sun(sun, placed.turn) for sun in suns)
        if solved:
            lights.append(light_in(grid, placed, theirs, medium, view, of))
            L, T, rows = solved_march(grid, here, light=lights[-1], **how)
        else:
            how |= {"suns": theirs, "medium": medium, "octaves": Octaves()}
            L, T, rows = octave_march(grid, here, **how)
        # Air takes light of the cloud and puts its own there; behind is behind.
        clear = math.exp(-distance(camera, placed) / placed.air)
        L = clear * L + (1.0 - clear) * (1.0 - T)[..., None] * Sky().haze
        light = L + T[..., None] * light
        seconds["march"] += time.perf_counter() - start
        skipped.append((*grid.skipped, *rows))
        what = "cloud" if placed is of.hero else "field"
        voxels = np.count_nonzero(grid.density)
        notes.append(f"{what}: {voxels} voxels of {voxel:.2g}")
    if lights:
        notes.append(f"scattered light: {report_of(lights)}")
    return Picture(
        light, None, merged(skipped, together(reached)), seconds, tuple(notes)
    )


def cloud_map(
    placed: Placed, camera: AnyCamera, view: View, seconds: dict[str, float]
) -> VoxelGrid:
    """Generate a cloud as finely as it is seen."""
    start, voxel = time.perf_counter(), fineness(camera, placed)
    if voxel < KEPT_FROM or view.observe is not None:
        grid = billows(seed=placed.seed, voxel=voxel, observe=view.observe)
    else:
        grid = coarse_billows(placed.seed, voxel)
    seconds["generate"] += time.perf_counter() - start
    return grid


def best(view: View) -> Literal["single", "multiple"]:
    """Solve the light where the solution models the medium."""
    medium = view.medium
    coloured = medium and (np.ndim(medium.sigma_t) or np.ndim(medium.albedo))
    return "single" if coloured else "multiple"


def light_in(
    grid: VoxelGrid,
    placed: Placed,
    suns: tuple[Sun, ...],
    medium: Medium,
    view: View,
    of: Hero,
) -> ScatteredLight:
    """Solve the light in a cloud, on a map as coarse as smooth light needs."""
    octaves = Octaves()
    most = VOXELS if placed is of.hero else FIELD_VOXELS
    light = scattered_light(
        block_means(grid, most=min(most, max(grid.density.shape) // 2)),
        suns,
        medium=medium,
        sky=of.sky * octaves.sky_light,
        ground=of.sky * octaves.ground_light,
        plan=dataclasses.replace(PLAN, double=view.tolerance < SINGLE_PRECISION),
    )
    if view.observe is not None:
        view.observe("scattered light", light)
    return light


@functools.lru_cache(maxsize=2 * (len(FIELD) + 1))
def coarse_billows(seed: int, voxel: float) -> VoxelGrid:
    """Make a coarse cloud map once: small pictures are drawn many times."""
    return billows(seed=seed, voxel=voxel)


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


def farthest_first(camera: AnyCamera, of: Hero = OWN) -> list[Placed]:
    """Order the clouds for one eye: none of them reaches through another."""
    return sorted(
        (*of.field, of.hero), key=lambda placed: distance(camera, placed), reverse=True
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


def own_eye(model: Model, view: View, *, of: Hero) -> Camera:
    """Look up at the cloud from below, the horizon just under the picture."""
    return Camera(of.eye, of.target, width=view.width, height=view.height)


def turning(of: Hero) -> Motion:
    """Turn eye and sun."""
    return Motion(partial(own_eye, of=of), (of.sun,))


enter_kind(
    Kind(
        "demand",
        "a marched cumulus over a field of small ones",
        OWN,
        draw,
        turning,
        uses=("scattering", "seed"),
        brings=brings,
    )
)
