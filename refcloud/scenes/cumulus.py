"""The scene ``cumulus``: one large cloud in front of a field of small ones.

The balls take their light from the solved field: every order of scattering. With
``scattering="single"``, or by rules that the solution does not model (the paper's, a
coloured medium), pass 1 carries it from ball to ball.
"""

from __future__ import annotations

import dataclasses
import math
import time
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Literal

import numpy as np

from refcloud.camera import Camera
from refcloud.checking import check_fields
from refcloud.choices import SUN
from refcloud.cloudmap import generate
from refcloud.compose import Layer, draw_layers
from refcloud.conventions import Positive, Range, Seed, Skipped, Vector
from refcloud.declared import Kind, Scale, enter_kind
from refcloud.extremes import refuse_small
from refcloud.image import Picture
from refcloud.lighting import Haze, Look, named
from refcloud.lighting.look import GROUND_LIGHT, SKY_LIGHT
from refcloud.metaballs import Metaballs, approximate, errors_of_fit, placed, prune
from refcloud.optics import Medium, Sun
from refcloud.refusal import counted, within
from refcloud.scene import Model, Motion, Own, View
from refcloud.sky import Sky
from refcloud.transport.plans import PLANS

SOLVED = {"relief": 0.4, "sky_light": 1.3 * SKY_LIGHT, "ground_light": GROUND_LIGHT}
# Of the light, whatever the tolerance of the picture: that chooses its precision alone.
PLAN, SINGLE_PRECISION = PLANS["standard"], 1e-5
HAZE = Sky().haze
FIELD_BUFFERS = {"buffer": 96, "sky_buffer": 64}  # pixels: they are seen small


@dataclass(frozen=True)
class Placed:
    """A cloud of the scene: which, where, how large, how turned, in how much air.

    Attributes
    ----------
    seed
        Which cloud.
    x, z
        Its place on the ground.
    scale
        Factor on its size.
    turn
        About y.
    air
        Distance over which its light falls to 1/e.
    """

    seed: Seed
    x: Annotated[float, Range(-1e6, 1e6, "scene units")] = 0.0
    z: Annotated[float, Range(-1e6, 1e6, "scene units")] = 0.0
    scale: Scale = 1.0
    turn: Annotated[float, Range(-7.0, 7.0, "radians")] = 0.0
    air: Annotated[float, Positive] = 900.0

    def __post_init__(self) -> None:
        check_fields(self)
        refuse_small("air", self.air)


@dataclass(frozen=True)
class Cumulus:
    """A large cloud of metaballs over small ones.

    Attributes
    ----------
    eye, target
        The camera.
    hero, field
        The large cloud, and the small ones, farthest first.
    count, field_count
        Metaballs of the large cloud and of each small one.
    field_voxel
        Edge of a voxel of the small ones.
    sun, medium
        The light, and what clouds are made of.
    single_sun, single_medium
        In the place of sun and medium where light is scattered once: with --scattering
        single, by the paper's rules (--look man), or in a coloured medium.
    """

    eye: Vector
    target: Vector
    hero: Placed
    field: tuple[Placed, ...]
    count: Annotated[int, Range(1, 100_000)]
    field_count: Annotated[int, Range(1, 100_000)]
    field_voxel: Annotated[float, Positive]
    sun: Sun
    medium: Medium
    single_sun: Sun
    single_medium: Medium

    def __post_init__(self) -> None:
        check_fields(self)


OWN = Cumulus(
    eye=np.array([0.0, -16.0, 130.0]),
    target=np.array([1.0, 19.0, 0.0]),
    # Its seed was chosen by eye among 24, as was the turn.
    hero=Placed(12, turn=math.radians(20.0), air=1500.0),
    # They give scale and a horizon; without them the large cloud floats.
    field=(
        Placed(20, 20.0, -700.0, 1.3),
        Placed(11, -60.0, -560.0, 1.2),
        Placed(18, 205.0, -420.0, 1.1),
        Placed(4, -150.0, -330.0, 1.0),
        Placed(7, 95.0, -300.0, 0.75),
    ),
    count=1000,
    field_count=300,
    field_voxel=2.0,
    # What solved light loses to a little absorption draws the folds between lumps, and
    # a weaker sun is enough where nothing else is lost.
    sun=Sun(SUN.direction, 0.6 * SUN.irradiance),
    medium=Medium(2.4, 0.97),
    single_sun=SUN,
    single_medium=Medium(1.2),  # balls of optical depth 1 to 5
)


def model(of: Cumulus = OWN) -> Model:
    """Generate and approximate the clouds of the scene."""
    seconds: dict[str, float] = {}
    notes: list[str] = []
    skipped: list[Skipped] = []
    clouds = {}
    names = ["cloud", *(f"field {k}" for k in range(len(of.field)))]
    small = ((row.seed, of.field_voxel, of.field_count) for row in of.field)
    recipes = [(of.hero.seed, None, of.count), *small]
    for name, (seed, voxel, count) in zip(names, recipes, strict=True):
        start = time.perf_counter()
        with within("parameters.", voxel="field_voxel"):
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
                f"{name}: {counted(voxels, 'voxel')},"
                f" {counted(len(balls.radii), 'ball')},"
                f" relative error of the fit {error:.3f}"
            )
            skipped += [*grid.skipped, *balls.skipped]
    total = sum(len(clouds[name].radii) for name in names[1:])
    notes.append(
        f"field: {counted(len(of.field), 'cloud')} of {counted(total, 'ball')} together"
    )
    return Model(clouds, tuple(notes), tuple(skipped), seconds)


def brings(of: Cumulus, model: Model | None, view: View) -> Own:
    """Give sun, medium and look: those of solved light, or of light scattered once."""
    look: Look = named(view.look or "cumulus")
    scattering = view.scattering or _best(view)
    if scattering == "single":
        return Own((of.single_sun,), of.single_medium, look, scattering)
    if view.look is None:
        look = dataclasses.replace(look, **SOLVED)
    return Own((of.sun,), of.medium, look, scattering)


def draw(of: Cumulus, model: Model, view: View) -> Picture:
    """Light and draw the clouds, the farthest first."""
    own = brings(of, model, view)
    look, medium = own.look, view.medium or own.medium
    assert look is not None
    assert medium is not None
    plan = dataclasses.replace(PLAN, double=view.tolerance < SINGLE_PRECISION)
    far = dataclasses.replace(look, **FIELD_BUFFERS)
    here = {"scattering": own.scattering, "plan": plan}
    layers = [
        Layer(
            standing(model.clouds[name], place),
            medium,
            look if name == "cloud" else far,
            Haze(HAZE, place.air),
            **here,
        )
        for name, place in (
            *((f"field {k}", place) for k, place in enumerate(of.field)),
            ("cloud", of.hero),
        )
    ]
    return draw_layers(
        layers,
        view.camera or camera(view, of),
        own.suns or () if view.suns is None else view.suns,
        Sky(),
        tolerance=view.tolerance,
        seed=view.seed,
        observe=view.observe,
        backend=view.backend,
        kept=view.kept,
    )


def standing(balls: Metaballs, place: Placed) -> Metaballs:
    """Stand a cloud at its place."""
    at = np.array([place.x, 0.0, place.z])
    return placed(balls, at, turn=place.turn, scale=place.scale)


def _best(view: View) -> Literal["single", "multiple"]:
    """Solve the light where the solution models what was asked for."""
    look, medium = named(view.look or "cumulus"), view.medium
    grey = medium is None or not (np.ndim(medium.sigma_t) or np.ndim(medium.albedo))
    own = look.tau is None and look.scattering == "split"
    return "multiple" if grey and own else "single"


def camera(view: View, of: Cumulus = OWN) -> Camera:
    """Look up at the cloud from below, the horizon just under the picture."""
    return Camera(of.eye, of.target, width=view.width, height=view.height)


def own_eye(model: Model, view: View, *, of: Cumulus) -> Camera:
    """Give the scene's own camera, which knows nothing of its clouds."""
    return camera(view, of)


def turning(of: Cumulus) -> Motion:
    """Turn eye and sun."""
    return Motion(partial(own_eye, of=of), (of.sun,))


enter_kind(
    Kind(
        "cumulus",
        "a cumulus over a field of small clouds",
        OWN,
        draw,
        turning,
        model,
        ("scattering", "seed"),
        brings,
    )
)
