"""A named scene's picture as a recipe: what stands as it started is the scene's own."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

import numpy as np

from refcloud.camera import Camera
from refcloud.conventions import Backend, Observer
from refcloud.image import Picture
from refcloud.lighting import Look
from refcloud.optics import Medium, Sun
from refcloud.render import render
from refcloud.scene import Model, Own, Scene, View, find_scene, own_of
from refcloud.studio.glimpse import glimpse_of_multiple
from refcloud.studio.knobs import Group, plain
from refcloud.studio.recipe import Call, Recipe, Stage, evaluated
from refcloud.studio.setups import (
    ROUGH,
    Frame,
    Values,
    by_key,
    differing,
    saving,
    suns_of,
)

# Coarse frames of splatted scenes: one flat colour for a ball, no noise on it.
COARSE_LOOK = {
    **{"erosion": 0.0, "relief": 0.0, "light_reach": 0.0},
    **{"buffer": 64, "sky_buffer": 32},
}
MOST_MODELS = 4  # clouds of that many scenes are kept
HELD = {"suns": "sun", "medium": "medium", "look": "look"}  # parts, and their blocks
KINDS = {
    "camera": ("rc.Camera", Camera),
    "medium": ("rc.Medium", Medium),
    "look": ("rc.Look", Look),
}


def scene_recipe(
    scene: Scene, blocks: tuple[Group, ...], values: Values, frame: Frame
) -> Recipe:
    """Write a scene; blocks that stand as they started are left to it."""
    name, groups = scene.name, by_key(blocks)
    given = [key for key in groups if is_moved(groups[key], values)]
    quality = dict(values["quality"] or {})
    backend = quality.pop("backend", "numpy")
    view, model = View(frame.width, frame.height), None
    own = own_of(scene, view)
    if ("camera" in given and scene.frames) or ("medium" in given and own.open):
        model = model_of(name)
        own = own_of(scene, view, model)
    keywords: dict[str, Any] = {"width": frame.width, "height": frame.height}
    if "camera" in given:
        size = keywords
        keywords = {"camera": part_call("camera", groups, values, own).but(**size)}
    if "sun" in given or values.get("second_sun") is not None:
        keywords["suns"] = sun_calls(groups, values, own)
    for key in ("medium", "look"):
        if key in given:
            keywords[key] = part_call(key, groups, values, own)
    # What the scene would choose anew beside these is held as the page shows it.
    chosen = {k: evaluated(v, {}) for k, v in keywords.items() if k in HELD}
    after = own_of(scene, replace(view, **chosen), model)
    for part, key in HELD.items():
        is_on = key in groups and groups[key].on and values[key] is not None
        if is_on and part not in keywords and not alike(own, after, part):
            keywords[part] = (
                sun_calls(groups, values, own)
                if key == "sun"
                else part_call(key, groups, values, own)
            )
    keywords["tolerance"] = quality["tolerance"]
    if quality["seed"]:
        keywords["seed"] = quality["seed"]
    if backend != "numpy":
        keywords["backend"] = backend
    call = Call("rc.render", render, (name,), keywords, run=drawn_scene)
    if frame.coarse:
        call = call.but(tolerance=max(ROUGH, quality["tolerance"]))
        if own.look is not None:
            now = dict(values)
            now["look"] = now["look"] or groups["look"].started()
            look = part_call("look", groups, now, own)
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


def whole(group: Group, now: Mapping[str, Any], own: Any) -> dict[str, Any]:
    """Give a block's values; those that stand as they started are the scene's own."""
    start = group.started()
    return {
        name: getattr(own, name)
        if own is not None and group.on and plain(value) == plain(start[name])
        else value
        for name, value in now.items()
    }


def part_call(key: str, groups: Mapping[str, Group], values: Values, own: Own) -> Call:
    """Write a camera, a medium or a look."""
    now = whole(groups[key], values[key] or {}, getattr(own, key))
    text, kind = KINDS[key]
    return Call(text, kind, (), differing(groups[key], now))


def sun_calls(
    groups: Mapping[str, Group], values: Values, own: Own
) -> tuple[Call, ...]:
    """Write the suns that are on."""
    sun = values.get("sun")
    if sun is None:
        return suns_of(groups, values)
    mine = own.suns[0] if own.suns else None
    return suns_of(groups, {**values, "sun": whole(groups["sun"], sun, mine)})


def alike(own: Own, after: Own, part: str) -> bool:
    """Tell whether a part is the same in both, in every field."""
    one, other = (getattr(each, part) for each in (own, after))
    if part != "suns":
        one, other = (one,), (other,)
    return len(one) == len(other) and all(
        np.array_equal(getattr(a, f.name), getattr(b, f.name))
        for a, b in zip(one, other, strict=True)
        for f in fields(a)
    )


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
