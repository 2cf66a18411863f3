"""A declared scene drawn: clouds are made, placed, lit and laid one over the other."""

from __future__ import annotations

import dataclasses
import time
from functools import partial
from typing import Any

import numpy as np

from refcloud.camera import Camera
from refcloud.choices import default_medium, default_sun, framed
from refcloud.cloudmap import VoxelGrid, generate
from refcloud.compose import Layer, draw_layers
from refcloud.conventions import Skipped
from refcloud.declared.declaration import Cloud, Declaration
from refcloud.declared.kinds import Changed, find_kind
from refcloud.image import Picture
from refcloud.lighting import Haze, named
from refcloud.metaballs import Metaballs, approximate, placed, prune, voxel_balls
from refcloud.optics import ALBEDO_MAN2003, Medium
from refcloud.refusal import counted, within
from refcloud.scene import Model, Motion, Own, Scene, View

LAST = "cloud"


def scene_from(declared: Declaration | Changed) -> Scene:
    """Make a scene of a declaration: its eye and suns may turn, wind may blow.

    Parameters
    ----------
    declared
        As a file says it.

    Returns
    -------
    The scene; it is not entered into the table of names.
    """
    if isinstance(declared, Changed):
        kind = find_kind(declared.kind)
        return kind.scene(declared.name, declared.title, declared.of)
    sun, _ = default_sun(declared.scattering)
    return Scene(
        declared.name,
        declared.title,
        partial(model, declared),
        partial(draw, declared),
        Motion(partial(eye, declared), declared.suns or (sun,)),
        ("scattering", "seed"),
        partial(brings, declared),
        declared.camera is None,
    )


def model(declared: Declaration) -> Model:
    """Generate the clouds, and approximate them where the file says so."""
    seconds = {"generate": 0.0, "approximate": 0.0}
    clouds: dict[str, Metaballs] = {}
    skipped: list[Skipped] = []
    notes: list[str] = []
    for number, cloud in enumerate(declared.clouds):
        start = time.perf_counter()
        with within(f"cloud[{number}].shape."):
            grid = generate(**cloud.shape)
        middle = time.perf_counter()
        with within(f"cloud[{number}]."):
            balls = _balls(cloud, grid)
        seconds["generate"] += middle - start
        seconds["approximate"] += time.perf_counter() - middle
        name = name_of(declared, number)
        clouds[name] = balls
        skipped += [*grid.skipped, *balls.skipped]
        what = counted(len(balls), "voxel" if cloud.balls is None else "ball")
        even = ", densities not fitted" if cloud.place.even else ""
        notes.append(f"{name}: {what}{even}")
    return Model(clouds, tuple(notes), tuple(skipped), seconds)


def name_of(declared: Declaration, number: int) -> str:
    """Name a cloud: the last, which is nearest, is "cloud", others "field 0", ..."""
    return LAST if number == len(declared.clouds) - 1 else f"field {number}"


def _balls(cloud: Cloud, grid: VoxelGrid) -> Metaballs:
    place = cloud.place
    if cloud.balls is None:
        balls = voxel_balls(grid)
    else:
        with within("balls."):
            balls = approximate(grid, **cloud.balls)
    if place.even:
        balls = dataclasses.replace(balls, densities=np.ones(len(balls)))
    if place.prune:
        balls = prune(balls)
    if place.at.any() or place.turn or place.scale != 1.0:
        balls = placed(balls, place.at, turn=place.turn, scale=place.scale)
    return balls


def eye(declared: Declaration, model: Model, view: View) -> Camera:
    """Give the declared camera, or frame the last cloud."""
    if declared.camera is not None:
        return Camera(**declared.camera, width=view.width, height=view.height)
    last = model.clouds[LAST]
    return framed(last, view.width, view.height)


def brings(declared: Declaration, model: Model | None, view: View) -> Own:
    """Give the declared suns, medium and look, and what is chosen in their place."""
    look = declared.look if view.look is None else named(view.look)
    scattering = view.scattering or declared.scattering
    suns = declared.suns or (default_sun(scattering)[0],)
    medium, unknown = declared.medium, ()
    if medium is None and look.tau is not None:
        medium = Medium(1.0, ALBEDO_MAN2003)
    elif medium is None and model is None:
        medium, unknown = Medium(1.0), ("sigma_t",)
    elif medium is None and model is not None:
        medium, _ = default_medium(model.clouds[LAST], look)
    return Own(suns, medium, look, scattering, unknown)


def draw(declared: Declaration, model: Model, view: View) -> Picture:
    """Light and draw the clouds in their order, before the sky."""
    base = declared.look if view.look is None else named(view.look)
    last = model.clouds[LAST]
    medium, notes = view.medium or declared.medium, ()
    if medium is None:
        medium, note = default_medium(last, base)
        notes = (note,)
    elif view.medium is not None and base.tau is not None:
        given: Any = {"sigma_t": medium.sigma_t, "albedo": medium.albedo}
        notes = (default_medium(last, base, **given)[1],)
    scattering = view.scattering or declared.scattering
    suns = view.suns if view.suns is not None else declared.suns
    if not suns and view.suns is None:
        sun, note = default_sun(scattering)
        suns, notes = (sun,), (*notes, *([note] if note else []))
    layers = []
    for number, cloud in enumerate(declared.clouds):
        air = cloud.place.air
        layers.append(
            Layer(
                model.clouds[name_of(declared, number)],
                medium,
                dataclasses.replace(base, **cloud.look),
                None if air is None else Haze(declared.sky.haze, air),
                scattering=scattering,
            )
        )
    picture = draw_layers(
        layers,
        view.camera or eye(declared, model, view),
        suns,
        declared.sky,
        tolerance=view.tolerance,
        seed=view.seed,
        observe=view.observe,
        backend=view.backend,
        kept=view.kept,
    )
    return dataclasses.replace(picture, notes=(*notes, *picture.notes))
