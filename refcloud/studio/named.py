"""The named scenes on the page: their own settings as starting values."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from refcloud.choices import SUN
from refcloud.lighting import Look
from refcloud.optics import Medium, Sun
from refcloud.parameters import options_of
from refcloud.render import render
from refcloud.scene import SCENES, Own, Scene, View, own_of
from refcloud.scenes import cumulus
from refcloud.studio.knobs import Group, group_of
from refcloud.studio.named_recipe import KINDS, scene_recipe
from refcloud.studio.setups import (
    FILE,
    TOLERANCE,
    Setup,
    camera_group,
    second_sun,
)

# Pictures of the page are 4 to 3. A number that is not the same at both of these sizes
# is the scene's own at each: "chosen by itself".
SIZES = View(320, 240), View(1024, 768)
# What is taken out of a scene's hands begins with these where they are not known.
BEGIN = Own((SUN,), Medium(1.0), Look(), camera=cumulus.camera(SIZES[0]))
# Eyes of figures 4 and 8 to 10 frame clouds that are made later; all of one map.
NEAR_MAP = {"eye": np.array([0, -32.0, 112.0]), "target": np.array([0, -1.0, 1.5])}
SIDES = ("width", "height")


def setup_of(scene: Scene) -> Setup:
    """Make the page's choice of a named scene.

    Parameters
    ----------
    scene
        Its blocks begin with what it is drawn with. One that does not say is offered
        every part of a view, each its own until it is switched on.

    Returns
    -------
    The choice.
    """
    blocks = (*part_groups(scene), *quality_groups(scene))
    takes = [block.key for block in blocks]
    views = ("light's buffer", "error") if "look" in takes else ("error",)
    if not {"camera", "sun", "medium", "look"}.intersection(takes):
        views = ()
    return Setup(
        scene.name,
        scene.title,
        blocks,
        functools.partial(scene_recipe, scene, blocks),
        views,
        "named scenes",
    )


def part_groups(scene: Scene) -> list[Group]:
    """Give the blocks of what a scene takes: camera, suns, medium, look."""
    silent = scene.brings is None
    own, again = (BEGIN if silent else own_of(scene, size) for size in SIZES)
    how = {"may_be_off": True, "about": "Off: the scene's own.", "on": not silent}
    groups: list[Group] = []
    if scene.frames and not silent:
        unknown = {"eye": None, "target": None}
        groups.append(camera_group(unknown, near=NEAR_MAP, **how))
    elif own.camera is not None and again.camera is not None:
        start = told("camera", own.camera, again.camera)
        near = {name: getattr(own.camera, name) for name in start}
        groups.append(camera_group(start, near=near, **how))
    if own.suns is not None:
        one = len(own.suns) == 1  # several are not told apart here
        sun = own.suns[0] if one else SUN
        start = {"direction": sun.direction, "irradiance": sun.irradiance}
        on = one and not silent
        groups.append(group_of("sun", "Light", Sun, start=start, **{**how, "on": on}))
        groups.append(second_sun())
    if own.medium is not None:
        start = told("medium", own.medium, own.medium)
        start |= dict.fromkeys(own.open)
        near = {"sigma_t": 1.0}
        groups.append(
            group_of(
                "medium",
                "What the cloud is made of",
                Medium,
                start=start,
                near=near,
                **how,
            )
        )
    if own.look is not None:
        start = told("look", own.look, own.look)
        groups.append(group_of("look", "Rules of light", Look, start=start, **how))
    return groups


def told(key: str, own: Any, again: Any) -> dict[str, Any]:
    """Give the fields that a block shows, None for those that depend on the size."""
    names = [o.name for o in options_of(KINDS[key][1]) if o.name not in SIDES]
    return {
        name: getattr(own, name)
        if np.array_equal(getattr(own, name), getattr(again, name))
        else None
        for name in names
    }


def quality_groups(scene: Scene) -> tuple[Group, Group]:
    """Give the blocks that every scene has."""
    splats = scene.brings is None or own_of(scene, SIZES[0]).look is not None
    alone = ("tolerance", "seed") + (("backend",) if splats else ())
    start = {"tolerance": TOLERANCE}
    title = "Time against error"
    return group_of("quality", title, render, alone=alone, start=start), FILE


def named() -> tuple[Setup, ...]:
    """Give a choice for every named scene."""
    return tuple(setup_of(SCENES[name]) for name in sorted(SCENES))
