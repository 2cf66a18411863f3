"""One door to the renderers: any cloud, or a named scene, to a picture."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

import numpy as np

from refcloud.camera import AnyCamera, Camera, OrthographicCamera, frame
from refcloud.checking import checked, complaint
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import (
    WHOLE_SPHERE,
    Array,
    Colour,
    Range,
    Seed,
    Shape,
    Skipped,
    Tolerance,
)
from refcloud.image import Picture
from refcloud.lighting import Haze, Look, eyeward, named, sunward
from refcloud.lighting.look import LookName
from refcloud.lighting.sunward import through_the_middle
from refcloud.metaballs import Metaballs, voxel_balls
from refcloud.optics import ALBEDO_MAN2003, Medium, Sun
from refcloud.sky import Sky, clear_sky

Observer = Callable[[str, Any], None]
Side = Annotated[int, Range(1, 64_000_000, "pixels")]
Quality = Literal["quick", "final"]

# Width and height where the caller names none.
SIZES: dict[str, tuple[int, int]] = {"quick": (320, 240), "final": (1024, 768)}
# Optical depth through a cloud's middle where the caller names no medium: a cumulus of
# this thickness lets almost nothing through its middle and still has soft edges.
THICKNESS = 40.0
# Late-morning sun from the front left, a little warm; relief keeps back a part of it.
SUN = Sun(
    np.array([-0.62, 0.62, 0.42]),
    1.75 * WHOLE_SPHERE * np.array([1.0, 0.96, 0.89]),
)


@dataclass(frozen=True)
class View:
    """How a scene is to be drawn; what is None the scene chooses itself."""

    width: int
    height: int
    camera: AnyCamera | None = None
    suns: tuple[Sun, ...] | None = None
    medium: Medium | None = None
    look: Look | LookName | None = None
    tolerance: float = 0.0
    seed: int = 0
    observe: Observer | None = None


@dataclass(frozen=True)
class Model:
    """The clouds of a scene, by name, and how they came about."""

    clouds: Mapping[str, Metaballs]
    notes: tuple[str, ...] = ()
    skipped: tuple[Skipped, ...] = ()
    seconds: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Scene:
    """A named scene: its clouds, and how they are drawn.

    Attributes
    ----------
    name, title
        What the command line calls it, and what it shows.
    model
        Makes the clouds.
    draw
        Draws them.
    """

    name: str
    title: str
    model: Callable[[], Model]
    draw: Callable[[Model, View], Picture]


# Names to scenes; each file of refcloud/scenes enters its own.
SCENES: dict[str, Scene] = {}


@dataclass(frozen=True)
class Layer:
    """One cloud of a composed picture: its balls and what they are made of."""

    balls: Metaballs
    medium: Medium
    look: Look
    haze: Haze | None = None


@checked
def render(
    cloud: Metaballs | VoxelGrid | str,
    *,
    camera: Camera | OrthographicCamera | None = None,
    width: Side | None = None,
    height: Side | None = None,
    suns: tuple[Sun, ...] | None = None,
    medium: Medium | None = None,
    background: Sky
    | Literal["transparent"]
    | Colour
    | Annotated[Array, Shape("H", "W", 3), Range(0.0)]
    | None = None,
    haze: Haze | None = None,
    look: Look | LookName | None = None,
    tolerance: Tolerance = 0.0,
    quality: Quality = "final",
    seed: Seed = 0,
    observe: Observer | None = None,
) -> Picture:
    """Render metaballs, a cloud map or a named scene.

    Formula: pass 1 (eq 27) for each sun, then pass 2 (eq 29) over the background

    Parameters
    ----------
    cloud
        Metaballs; a cloud map, drawn as one ball per occupied voxel; or a scene's name.
    camera
        The eye; None frames the cloud, or takes the scene's own.
    width, height
        Size where no camera is given, pixels; by quality 320 x 240 or 1024 x 768.
    suns
        The lights; None for one from the front left.
    medium
        What the cloud is made of; None sets sigma_t so that the optical depth through
        the cloud's middle is 40.
    background
        A sky, one colour, a picture of the camera's size, or "transparent"; None for
        the default sky. Scenes bring their own.
    haze
        Air in front of the cloud; None for none. Scenes bring their own.
    look
        Rules of the light, "cumulus" or "man"; None for "cumulus", or the scene's own.
    tolerance
        Largest error of a channel that savings may make; 0 is exact.
    quality
        Which size a scene has by default.
    seed
        Chooses the noise that erodes footprints.
    observe
        Called with (name, value) for each intermediate.

    Returns
    -------
    The picture, with what was skipped, chosen, and the time of each stage.

    Raises
    ------
    ValueError
        No scene has that name; the picture is over 64 megapixels.

    Source: paper M, section 4; design.md, section 5.
    """
    size = SIZES[quality]
    width, height = width or size[0], height or size[1]
    if isinstance(cloud, str):
        scene = find_scene(cloud)
        if background is not None or haze is not None:
            raise ValueError(
                complaint("background", "none beside a scene's name", "one or haze")
            )
        view = View(width, height, camera, suns, medium, look, tolerance, seed, observe)
        model = scene.model()
        picture = scene.draw(model, view)
        return dataclasses.replace(
            picture,
            skipped=model.skipped + picture.skipped,
            seconds={**model.seconds, **picture.seconds},
            notes=model.notes + picture.notes,
        )
    notes: list[str] = []
    if isinstance(cloud, VoxelGrid):
        cloud = voxel_balls(cloud)
        notes.append(f"drawn as one ball per occupied voxel: {len(cloud.radii)} balls")
    rules = named(look or "cumulus")
    if medium is None:
        medium, note = default_medium(cloud, rules)
        notes.append(note)
    if camera is None:
        camera = framed(cloud, width, height)
        notes.append(
            "camera: eye {:.4g} {:.4g} {:.4g}, target {:.4g} {:.4g} {:.4g}".format(
                *camera.eye, *camera.target
            )
        )
    picture = draw_layers(
        [Layer(cloud, medium, rules, haze)],
        camera,
        (SUN,) if suns is None else suns,
        Sky() if background is None else background,
        tolerance=tolerance,
        seed=seed,
        observe=observe,
    )
    return dataclasses.replace(picture, notes=(*notes, *picture.notes))


def find_scene(name: str) -> Scene:
    """Look a scene up, and name all of them where there is none of that name."""
    if name not in SCENES:
        known = ", ".join(sorted(SCENES))
        raise ValueError(complaint("scene", f"one of {known}", repr(name)))
    return SCENES[name]


def default_medium(balls: Metaballs, look: Look) -> tuple[Medium, str]:
    """Choose a medium, and say which."""
    if look.tau is not None:
        medium = Medium(1.0, ALBEDO_MAN2003)
        return medium, f"medium: tau {look.tau:g} for every ball, albedo 0.9"
    per_unit = through_the_middle(balls, 1.0)
    sigma_t = THICKNESS / per_unit if per_unit > THICKNESS / 1e300 else 1.0
    note = f"medium: sigma_t {sigma_t:.4g}, optical depth {THICKNESS:g} in the middle"
    return Medium(sigma_t), note


def framed(balls: Metaballs, width: int, height: int) -> Camera:
    """Frame a cloud's bounds; an empty cloud gets a unit box."""
    if not len(balls.radii):
        return frame(-np.ones(3), np.ones(3), width=width, height=height)
    lower = (balls.centers - balls.radii[:, None]).min(axis=0)
    upper = (balls.centers + balls.radii[:, None]).max(axis=0)
    return frame(lower, upper, width=width, height=height)


def draw_layers(
    layers: Sequence[Layer],
    camera: AnyCamera,
    suns: tuple[Sun, ...],
    background: Any,
    *,
    tolerance: float = 0.0,
    seed: int = 0,
    observe: Observer | None = None,
) -> Picture:
    """Draw clouds one over the other, the farthest first; each is lit by itself.

    Parameters
    ----------
    layers
        The clouds, farthest first; they cast no shadows on each other.
    camera
        The eye.
    suns
        The lights.
    background
        As `render`.
    tolerance
        Largest error of a channel; every layer gets an equal share.
    seed, observe
        As `render`.

    Returns
    -------
    The picture.
    """
    seconds: dict[str, float] = {}
    clock = _Clock(seconds)
    behind = _painted(background, camera, suns)
    clock.stop("sky")
    skipped: list[Skipped] = []
    rgba = np.zeros((camera.height, camera.width, 4))
    if behind is not None:
        rgba[..., :3], rgba[..., 3] = behind, 1.0
    for layer in layers:
        lit = sunward(
            layer.balls, suns, medium=layer.medium, look=layer.look, observe=observe
        )
        clock.stop("light")
        rgba, rows = eyeward(
            lit,
            camera,
            background=None if behind is None else rgba[..., :3],
            haze=layer.haze,
            tolerance=tolerance / len(layers),
            seed=seed,
            observe=observe,
        )
        skipped += rows
        clock.stop("eye")
    skipped = list(merged(skipped))
    alpha = None if behind is not None else np.clip(rgba[..., 3], 0.0, 1.0)
    return Picture(rgba[..., :3], alpha, tuple(skipped), seconds)


def merged(rows: Sequence[Skipped]) -> tuple[Skipped, ...]:
    """Add up the rows of several layers that say the same; errors add up at most."""
    sums: dict[tuple[str, str], Skipped] = {}
    for row in rows:
        key = row.stage, row.what
        old = sums.get(key, Skipped(*key, 0, 0))
        sums[key] = Skipped(
            *key, old.skipped + row.skipped, old.of + row.of, old.bound + row.bound
        )
    return tuple(sums.values())


class _Clock:
    """Adds the time since the last stop to a stage."""

    def __init__(self, seconds: dict[str, float]) -> None:
        self.seconds = seconds
        self.since = time.perf_counter()

    def stop(self, stage: str) -> None:
        now = time.perf_counter()
        self.seconds[stage] = self.seconds.get(stage, 0.0) + now - self.since
        self.since = now


def _painted(background: Any, camera: AnyCamera, suns: tuple[Sun, ...]) -> Array | None:
    """Give what stands behind the clouds, (H, W, 3), or None for nothing."""
    if isinstance(background, str):
        return None
    if isinstance(background, Sky):
        return clear_sky(camera, background, suns=suns)
    shape = (camera.height, camera.width, 3)
    background = np.asarray(background)
    if background.shape not in (shape, (3,)):
        expected = f"shape {shape}, that of the picture"
        raise ValueError(complaint("background", expected, f"shape {background.shape}"))
    return np.broadcast_to(background, shape)
