"""Metaballs and cloud maps as scenes that can be animated."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from functools import partial
from typing import Any

from refcloud.camera import AnyCamera
from refcloud.choices import SUN, default_medium, default_sun, framed
from refcloud.cloudmap import VoxelGrid
from refcloud.compose import LIGHT, passes_of
from refcloud.image import Picture
from refcloud.lighting import named
from refcloud.metaballs import Metaballs
from refcloud.refusal import complaint, describe
from refcloud.render import as_drawn, is_marched, render
from refcloud.scene import Model, Motion, Scene, View, find_scene

NAME = "cloud"


def as_scene(
    cloud: Metaballs | VoxelGrid | Scene | str, view: View, own: dict[str, Any]
) -> tuple[Scene, View, tuple[str, ...]]:
    """Give the scene, and choose once what a cloud's frames have in common.

    Parameters
    ----------
    cloud
        A scene, its name, metaballs or a cloud map.
    view
        At rest.
    own
        Keywords of `render` that a view does not hold; scenes bring their own.

    Returns
    -------
    The scene, the view with its medium, and what was chosen.

    Raises
    ------
    ValueError
        No scene has that name; something is given that scenes bring.
    """
    if isinstance(cloud, (Scene, str)):
        for name, value in own.items():
            if value is not None and not (isinstance(value, str) and value == "single"):
                expected = "none beside a scene, which brings its own"
                raise ValueError(complaint(name, expected, describe(value)))
        return find_scene(cloud) if isinstance(cloud, str) else cloud, view, ()
    scene = scene_of(cloud, own)
    if view.medium is not None:
        return scene, view, ()
    marched = is_marched(cloud, own["method"])
    rules = None if marched else named(view.look or "cumulus")
    medium, note = default_medium(as_drawn(cloud, own["method"]), rules)
    return scene, dataclasses.replace(view, medium=medium), (note,)


def scene_of(cloud: Metaballs | VoxelGrid, how: Mapping[str, Any]) -> Scene:
    """Make a scene of a cloud: the eye and the suns may turn, wind carries the cloud.

    Parameters
    ----------
    cloud
        Metaballs or a cloud map.
    how
        Keywords of `render` that a view does not hold.

    Returns
    -------
    The scene.
    """
    drawn = as_drawn(cloud, how.get("method"))
    return Scene(
        NAME,
        "a cloud",
        partial(Model, {}),
        partial(draw, cloud, dict(how)),
        Motion(partial(frame_of, drawn), (default_sun(how.get("scattering"))[0],)),
    )


def frame_of(drawn: Metaballs | VoxelGrid, model: Model, view: View) -> AnyCamera:
    """Frame the cloud, as `render` does where it is told no camera."""
    return framed(drawn, view.width, view.height)


def draw(
    cloud: Metaballs | VoxelGrid, how: Mapping[str, Any], model: Model, view: View
) -> Picture:
    """Draw a cloud; light that still holds is taken from ``view.kept``."""
    kept = {} if view.kept is None else view.kept
    common = {
        "camera": view.camera,
        "width": view.width,
        "height": view.height,
        "tolerance": view.tolerance,
        "seed": view.seed,
        "backend": view.backend,
    }
    solved = how.get("scattering", "single")
    if is_marched(cloud, how.get("method")) or solved != "single":
        # What was solved or marched for one eye serves the next: same cloud, same suns.
        def keep(name: str, value: Any) -> None:
            if name in ("light volumes", "scattered light"):
                kept[name] = value
            if view.observe is not None:
                view.observe(name, value)

        again = {
            "volumes": kept.get("light volumes", ()),
            "scattering": kept.get("scattered light", solved),
        }
        lights = {"suns": view.suns, "medium": view.medium, "look": view.look}
        return render(cloud, **{**how, **common, **lights, **again}, observe=keep)
    if "lit" not in kept:
        kept["lit"] = _lit(cloud, how, view)
    brought = ("method", "scattering")  # lit balls bring their light
    rest = {name: value for name, value in how.items() if name not in brought}
    return render(kept["lit"], **{**rest, **common}, observe=view.observe)


def _lit(cloud: Metaballs | VoxelGrid, how: Mapping[str, Any], view: View) -> Any:
    """Carry the light to the balls as `render` would within the same tolerance."""
    balls = as_drawn(cloud, how.get("method"))
    return passes_of(view.backend)[0](
        balls,
        (SUN,) if view.suns is None else view.suns,
        medium=view.medium,
        look=named(view.look or "cumulus"),
        tolerance=LIGHT * view.tolerance,
        observe=view.observe,
    )
