"""The scene ``cumulus``: one large cloud in front of a field of small ones."""

from __future__ import annotations

import dataclasses
import math
import time

import numpy as np

from refcloud.camera import Camera
from refcloud.cloudmap import generate
from refcloud.compose import Layer, draw_layers
from refcloud.conventions import Skipped
from refcloud.image import Picture
from refcloud.lighting import Haze, Look, named
from refcloud.metaballs import approximate, errors_of_fit, placed, prune
from refcloud.optics import Medium
from refcloud.render import SUN
from refcloud.scene import Model, Motion, Scene, View, enter
from refcloud.sky import Sky

# The cloud: its seed was chosen by eye among 24, as was the turn.
SEED, COUNT, TURN = 12, 1000, math.radians(20.0)
SIGMA_T = 1.2  # 1 / scene unit: balls of optical depth 1 to 5
EYE, TARGET = (0.0, -16.0, 130.0), (1.0, 19.0, 0.0)
HAZE = Sky().haze
HERO_AIR, FIELD_AIR = 1500.0, 900.0  # scene units over which light falls to 1/e

# The field: seed, x, z and scale of each small cloud, farthest first. They give scale
# and a horizon; without them the large cloud floats.
FIELD = (
    (20, 20.0, -700.0, 1.3),
    (11, -60.0, -560.0, 1.2),
    (18, 205.0, -420.0, 1.1),
    (4, -150.0, -330.0, 1.0),
    (7, 95.0, -300.0, 0.75),
)
FIELD_COUNT, FIELD_VOXEL = 300, 2.0
FIELD_BUFFERS = {"buffer": 96, "sky_buffer": 64}  # pixels: they are seen small


def model() -> Model:
    """Generate and approximate the clouds of the scene."""
    seconds: dict[str, float] = {}
    notes: list[str] = []
    skipped: list[Skipped] = []
    clouds = {}
    names = ["cloud", *(f"field {k}" for k in range(len(FIELD)))]
    small = ((row[0], FIELD_VOXEL, FIELD_COUNT) for row in FIELD)
    recipes = [(SEED, None, COUNT), *small]
    for name, (seed, voxel, count) in zip(names, recipes, strict=True):
        start = time.perf_counter()
        grid = generate(seed=seed, voxel=voxel)
        middle = time.perf_counter()
        method = "standard" if name == "cloud" else "quick"
        balls = prune(approximate(grid, count=count, method=method, seed=seed))
        end = time.perf_counter()
        seconds["generate"] = seconds.get("generate", 0.0) + middle - start
        seconds["approximate"] = seconds.get("approximate", 0.0) + end - middle
        clouds[name] = balls
        if name == "cloud":
            error = errors_of_fit(grid, balls).density
            voxels = int(np.count_nonzero(grid.density))
            notes.append(
                f"{name}: {voxels} voxels, {len(balls.radii)} balls,"
                f" relative error of the fit {error:.3f}"
            )
            skipped += [*grid.skipped, *balls.skipped]
    total = sum(len(clouds[name].radii) for name in names[1:])
    notes.append(f"field: {len(FIELD)} clouds of {total} balls together")
    return Model(clouds, tuple(notes), tuple(skipped), seconds)


def draw(model: Model, view: View) -> Picture:
    """Light and draw the clouds, the farthest first."""
    look: Look = named(view.look or "cumulus")
    medium = view.medium or Medium(SIGMA_T)
    far = dataclasses.replace(look, **FIELD_BUFFERS)
    layers = [
        Layer(
            placed(model.clouds[f"field {k}"], np.array([x, 0.0, z]), scale=scale),
            medium,
            far,
            Haze(HAZE, FIELD_AIR),
        )
        for k, (_, x, z, scale) in enumerate(FIELD)
    ]
    hero = placed(model.clouds["cloud"], np.zeros(3), turn=TURN)
    layers.append(Layer(hero, medium, look, Haze(HAZE, HERO_AIR)))
    return draw_layers(
        layers,
        view.camera or camera(view),
        (SUN,) if view.suns is None else view.suns,
        Sky(),
        tolerance=view.tolerance,
        seed=view.seed,
        observe=view.observe,
        backend=view.backend,
        kept=view.kept,
    )


def camera(view: View) -> Camera:
    """Look up at the cloud from below, the horizon just under the picture."""
    return Camera(np.array(EYE), np.array(TARGET), width=view.width, height=view.height)


def eye(model: Model, view: View) -> Camera:
    """Give the scene's own camera, which knows nothing of its clouds."""
    return camera(view)


enter(
    Scene(
        "cumulus",
        "a cumulus over a field of small clouds",
        model,
        draw,
        Motion(eye, (SUN,)),
    )
)
