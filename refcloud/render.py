"""One door to the renderers: any cloud, or a named scene, to a picture."""

from __future__ import annotations

import dataclasses
from typing import Annotated, Literal

import numpy as np

from refcloud.camera import Camera, OrthographicCamera, frame, refuse_large
from refcloud.checking import checked, complaint
from refcloud.cloudmap import VoxelGrid
from refcloud.compose import Layer, draw_layers, passes_of
from refcloud.conventions import (
    MOST_PIXELS,
    WHOLE_SPHERE,
    Array,
    Backend,
    Colour,
    Observer,
    Range,
    Seed,
    Shape,
    Tolerance,
)
from refcloud.image import Picture
from refcloud.lighting import Haze, LitMetaballs, Look, named
from refcloud.lighting.depths import through_the_middle
from refcloud.lighting.look import LookName
from refcloud.metaballs import Metaballs, voxel_balls
from refcloud.optics import ALBEDO_MAN2003, Medium, Sun
from refcloud.scene import View, find_scene
from refcloud.sky import Sky

Side = Annotated[int, Range(1, MOST_PIXELS, "pixels")]
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


@checked
def render(
    cloud: Metaballs | LitMetaballs | VoxelGrid | str,
    *,
    camera: Camera | OrthographicCamera | None = None,
    width: Side | None = None,
    height: Side | None = None,
    suns: Sun | tuple[Sun, ...] | None = None,
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
    backend: Backend = "numpy",
) -> Picture:
    """Render metaballs, a cloud map or a named scene.

    Formula: pass 1 (eq 27) for each sun, then pass 2 (eq 29) over the background

    Parameters
    ----------
    cloud
        Metaballs; balls with their light, of `sunward`, which is then not carried again
        and brings suns, medium and look; a cloud map, drawn as one ball per occupied
        voxel; or a scene's name.
    camera
        The eye; None frames the cloud, or takes the scene's own.
    width, height
        Size where no camera is given, pixels; by quality 320 x 240 or 1024 x 768. One
        alone keeps that shape, 4 to 3.
    suns
        The lights, one or several; None for one from the front left.
    medium
        What the cloud is made of; None sets sigma_t so that the optical depth through
        the cloud's middle is 40.
    background
        A sky, one colour, or "transparent"; None for the default sky. Or a picture of
        the camera's size, shape (H, W, 3). Scenes bring their own.
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
    backend
        What runs the two passes: "numpy", or "gl" for OpenGL in float32, through
        moderngl.

    Returns
    -------
    The picture, with what was skipped, chosen, and the time of each stage.

    Raises
    ------
    ValueError
        No scene has that name; the picture is over 64 megapixels; the backend is
        missing.

    Source: paper M, section 4 (W03).
    """
    if isinstance(suns, Sun):
        suns = (suns,)
    width, height = size_of(width, height, quality)
    passes_of(backend)  # refuses here, before the clouds are made
    if isinstance(cloud, str):
        scene = find_scene(cloud)
        refuse_large(width, height)  # before the clouds are made
        if background is not None or haze is not None:
            raise ValueError(
                complaint(
                    "background" if haze is None else "haze",
                    "none beside a scene's name, which brings its own",
                    "one",
                )
            )
        how = tolerance, seed, observe, backend
        view = View(width, height, camera, suns, medium, look, *how)
        model = scene.model()
        picture = scene.draw(model, view)
        return dataclasses.replace(
            picture,
            skipped=model.skipped + picture.skipped,
            seconds={**model.seconds, **picture.seconds},
            notes=model.notes + picture.notes,
        )
    notes: list[str] = []
    lit = None
    if isinstance(cloud, LitMetaballs):
        for name, part in (("suns", suns), ("medium", medium), ("look", look)):
            if part is not None:
                expected = "none beside lit balls, which bring their own"
                advice = "light the balls with sunward"
                raise ValueError(complaint(name, expected, "one", advice))
        lit, suns, medium, look = cloud, cloud.suns, cloud.medium, cloud.look
        cloud = lit.balls
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
        [Layer(cloud, medium, rules, haze, lit)],
        camera,
        (SUN,) if suns is None else suns,
        Sky() if background is None else background,
        tolerance=tolerance,
        seed=seed,
        observe=observe,
        backend=backend,
    )
    return dataclasses.replace(picture, notes=(*notes, *picture.notes))


def size_of(width: int | None, height: int | None, quality: str) -> tuple[int, int]:
    """Complete a picture's size; one side alone keeps the shape of the default."""
    across, down = SIZES[quality]
    if width is None and height is None:
        return across, down
    if width is None:
        return max(round((height or 1) * across / down), 1), height or 1
    return width, height or max(round(width * down / across), 1)


def default_medium(balls: Metaballs, look: Look) -> tuple[Medium, str]:
    """Choose a medium, and say which."""
    if look.tau is not None:
        medium = Medium(1.0, ALBEDO_MAN2003)
        return medium, f"medium: tau {look.tau:g} for every ball, albedo 0.9"
    per_unit = through_the_middle(balls, 1.0)
    if not per_unit > THICKNESS / 1e300:
        return Medium(1.0), "medium: sigma_t 1, since the cloud's middle is empty"
    sigma_t = THICKNESS / per_unit
    note = f"medium: sigma_t {sigma_t:.4g}, optical depth {THICKNESS:g} in the middle"
    return Medium(sigma_t), note


def framed(balls: Metaballs, width: int, height: int) -> Camera:
    """Frame a cloud's bounds; an empty cloud gets a unit box."""
    if not len(balls.radii):
        return frame(-np.ones(3), np.ones(3), width=width, height=height)
    lower = (balls.centers - balls.radii[:, None]).min(axis=0)
    upper = (balls.centers + balls.radii[:, None]).max(axis=0)
    return frame(lower, upper, width=width, height=height)
