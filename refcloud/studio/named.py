"""The named scenes on the page: their own settings as starting values."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from refcloud.camera import Camera
from refcloud.choices import SUN
from refcloud.conventions import Backend, Observer
from refcloud.image import Picture
from refcloud.lighting import MAN, Look
from refcloud.optics import Medium, Sun
from refcloud.render import render
from refcloud.scene import SCENES, Model, Scene, View, find_scene
from refcloud.scenes import cumulus, demand, demand_hero, man, multiple
from refcloud.studio.glimpse import glimpse_of_multiple
from refcloud.studio.knobs import Group, group_of, plain
from refcloud.studio.recipe import Call, Recipe, Stage
from refcloud.studio.setups import (
    FILE,
    ROUGH,
    TOLERANCE,
    Frame,
    Setup,
    Values,
    by_key,
    camera_call,
    camera_group,
    medium_group,
    saving,
    second_sun,
    sun_group,
    suns_of,
    written_as,
)

# Coarse frames of splatted scenes: one flat colour for a ball, no noise on it.
COARSE_LOOK = {
    **{"erosion": 0.0, "relief": 0.0, "light_reach": 0.0},
    **{"buffer": 64, "sky_buffer": 32},
}
ALL = ("camera", "sun", "medium", "look")
MOST_MODELS = 4  # clouds of that many scenes are kept


@dataclass(frozen=True)
class Parts:
    """A scene's own settings, and the parts of a view that it takes."""

    takes: tuple[str, ...] = ALL
    eye: Mapping[str, Any] | None = None
    sun: Sun | None = None
    medium: Medium | None = None
    look: Look | None = None


FROM_BELOW = {"eye": cumulus.OWN.eye, "target": cumulus.OWN.target}
AT_BOX = {
    "eye": demand.OWN.eye,
    "target": demand.OWN.target,
    "fov_y": demand.OWN.fov_y,
}
MARCHED = ("camera", "sun", "medium")
IN_BOX = Parts(MARCHED, AT_BOX, demand.OWN.sun, demand.OWN.medium)
FRONT = Parts(sun=man.FRONT, medium=man.CLOUD_MEDIUM, look=MAN)
AGAINST = Parts(ALL, FROM_BELOW, man.BEHIND, look=MAN)
OF_THE_PLANE = Parts(())
PARTS = {
    "cumulus": Parts(ALL, FROM_BELOW, cumulus.OWN.sun, cumulus.OWN.medium, Look()),
    **dict.fromkeys(("man-04", "man-08", "man-09", "man-10"), FRONT),
    "man-13": replace(AGAINST, medium=man.ISOTROPIC),
    "man-14": replace(AGAINST, medium=man.FORWARD),
    "demand": Parts(MARCHED, FROM_BELOW, demand_hero.OWN.sun, demand_hero.OWN.medium),
    **dict.fromkeys(("demand-box", "demand-lit", "demand-background"), IN_BOX),
    "demand-faces": Parts(("camera",), AT_BOX),
    "demand-quad": Parts(("camera", "medium"), AT_BOX, medium=demand.OWN.medium),
    **dict.fromkeys(
        [f"demand-{n}" for n in ("worley", "worley-inverted", "cells", "perlin")],
        OF_THE_PLANE,
    ),
    "demand-sky": OF_THE_PLANE,
    "multiple": Parts(MARCHED, FROM_BELOW, multiple.OWN.sun),
}
# What is taken out of a scene's hands begins with these where they are not known.
BEGIN = Parts(ALL, FROM_BELOW, SUN, Medium(1.0), Look())


def setup_of(scene: Scene) -> Setup:
    """Make the page's choice of a named scene.

    Parameters
    ----------
    scene
        One that the table above knows, or any other: then every part of the view is
        offered, and is the scene's own until it is switched on.

    Returns
    -------
    The choice.
    """
    parts = PARTS.get(scene.name, Parts())
    how = {"may_be_off": True, "about": "Off: the scene's own."}
    groups: list[Group] = []
    if "camera" in parts.takes:
        start = parts.eye or BEGIN.eye or {}
        groups.append(camera_group(start, on=parts.eye is not None, **how))
    if "sun" in parts.takes:
        own = parts.sun or BEGIN.sun or SUN
        groups.append(sun_group(own, on=parts.sun is not None, **how))
        groups.append(second_sun())
    if "medium" in parts.takes:
        medium = parts.medium or Medium(1.0)
        groups.append(medium_group(medium, on=parts.medium is not None, **how))
    if "look" in parts.takes:
        look = parts.look or Look()
        names = Look.__dataclass_fields__
        groups.append(
            group_of(
                "look",
                "Rules of light",
                Look,
                start={name: getattr(look, name) for name in names},
                on=parts.look is not None,
                **how,
            )
        )
    alone = ("tolerance", "seed") + (("backend",) if "look" in parts.takes else ())
    groups.append(
        group_of(
            "quality",
            "Time against error",
            render,
            alone=alone,
            start={"tolerance": TOLERANCE},
        )
    )
    groups.append(FILE)
    blocks = tuple(groups)
    views = ("light's buffer", "error") if "look" in parts.takes else ("error",)
    if scene.name in PARTS and not parts.takes:
        views = ()
    return Setup(
        scene.name,
        scene.title,
        blocks,
        functools.partial(scene_recipe, scene.name, blocks, parts),
        views,
        "named scenes",
    )


def scene_recipe(
    name: str, blocks: tuple[Group, ...], parts: Parts, values: Values, frame: Frame
) -> Recipe:
    """Write a scene; blocks that stand as they started are left to it."""
    groups = by_key(blocks)
    given = {key: values[key] for key in groups if is_moved(groups[key], values)}
    quality = dict(values["quality"] or {})
    backend = quality.pop("backend", "numpy")
    keywords: dict[str, Any] = {"width": frame.width, "height": frame.height}
    if "camera" in given:
        keywords = {"camera": camera_call(groups, values, frame)}
    if "sun" in given or values.get("second_sun") is not None:
        keywords["suns"] = suns_of(groups, values)
    if "medium" in given:
        keywords["medium"] = written_as("rc.Medium", Medium, groups, values, "medium")
    if "look" in given:
        keywords["look"] = written_as("rc.Look", Look, groups, values, "look")
    keywords["tolerance"] = quality["tolerance"]
    if quality["seed"]:
        keywords["seed"] = quality["seed"]
    if backend != "numpy":
        keywords["backend"] = backend
    call = Call("rc.render", render, (name,), keywords, run=drawn_scene)
    if frame.coarse:
        call = call.but(tolerance=max(ROUGH, quality["tolerance"]))
        if "look" in groups and parts.look is not None:
            look = written_as("rc.Look", Look, groups, values, "look")
            if values["look"] is None:
                look = Call("rc.Look", Look, (), groups["look"].start)
            call = call.but(look=look.but(**COARSE_LOOK))
    rough = None
    if name == "multiple":  # solving takes a second, however small the picture
        rough = Call("glimpse_of_multiple", glimpse_of_multiple, (), call.keywords)
    return Recipe((Stage("picture", call, rough),), saving(values))


def is_moved(group: Group, values: Values) -> bool:
    """Tell whether a block is on and differs from how it started."""
    now = values[group.key]
    if now is None:
        return False
    start = {name: plain(value) for name, value in group.started().items()}
    return not group.on or {name: plain(value) for name, value in now.items()} != start


@functools.lru_cache(maxsize=MOST_MODELS)
def model_of(name: str) -> Model:
    """Make a scene's clouds once."""
    return find_scene(name).model()


def drawn_scene(
    name: str,
    *,
    camera: Camera | None = None,
    suns: tuple[Sun, ...] | None = None,
    medium: Medium | None = None,
    look: Look | None = None,
    tolerance: float = 0.0,
    seed: int = 0,
    backend: Backend = "numpy",
    width: int = 0,
    height: int = 0,
    observe: Observer | None = None,
) -> Picture:
    """Draw a scene as `refcloud.render` does, with clouds that are made once.

    Parameters
    ----------
    name, camera, suns, medium, look, tolerance, seed, backend, width, height, observe
        As `render`; the size is the camera's where there is one.

    Returns
    -------
    The picture.
    """
    model = model_of(name)
    if camera is not None:
        width, height = camera.width, camera.height
    how = tolerance, seed, observe, backend
    view = View(width, height, camera, suns, medium, look, *how)
    picture = find_scene(name).draw(model, view)
    return replace(
        picture,
        skipped=model.skipped + picture.skipped,
        notes=model.notes + picture.notes,
    )


def named() -> tuple[Setup, ...]:
    """Give a choice for every named scene."""
    return tuple(setup_of(SCENES[name]) for name in sorted(SCENES))
