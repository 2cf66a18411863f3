"""A scene's own camera, suns and medium, with the numbers changed that were typed.

Numbers that were not typed stay the scene's own (`refcloud.scene.Own`). What a scene
has none of is refused, as is what cannot be told: one direction for several suns that
shine differently.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

from refcloud.choices import default_sun
from refcloud.cli.setting import directed, with_phase
from refcloud.conventions import Array
from refcloud.optics import Medium, Sun
from refcloud.refusal import complaint
from refcloud.scene import Own, Scene, View, own_of

ONCE = (
    "light: scattered once, since that of a coloured medium is not solved; what was not"
    " typed is what the scene has for it"
)


def changed(
    scene: Scene,
    view: View,
    *,
    camera: Mapping[str, Any],
    suns: Mapping[str, Any],
    medium: Mapping[str, Any],
) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Put typed numbers in the place of a scene's own.

    Parameters
    ----------
    scene, view
        Which; the view has the size, and look and scattering where they were typed.
    camera, suns, medium
        What was typed, by the library's names; directions and irradiances as lists.

    Returns
    -------
    Camera, suns and medium for `render`, None where nothing was typed; and what to say.

    Raises
    ------
    ValueError
        The scene has no such thing, or what was typed can be meant in several ways.
    """
    own = own_of(scene, view)
    model = None
    if (camera and scene.frames) or (medium and own.open):
        model = scene.model()
        own = own_of(scene, view, model)
    for given, part, what in (
        (camera, own.camera, "camera"),
        (suns, own.suns, "sun"),
        (medium, own.medium, "medium"),
    ):
        if given and part is None:
            flag = _flag(next(iter(given)))
            expected = f"none beside {scene.name}, which has no {what}"
            raise ValueError(complaint(flag, expected, "one"))
    parts: dict[str, Any] = {"camera": None, "suns": None, "medium": None}
    notes: tuple[str, ...] = ()
    if camera and own.camera is not None:
        parts["camera"] = dataclasses.replace(own.camera, **camera)
    if medium and own.medium is not None:
        parts["medium"] = medium_changed(own.medium, medium)
        again = own_of(scene, dataclasses.replace(view, medium=parts["medium"]), model)
        if again.scattering != own.scattering and again.medium is not None:
            own, notes = again, (ONCE,)
            parts["medium"] = medium_changed(again.medium, medium)
    if suns and own.suns is not None:
        parts["suns"] = suns_changed(own, suns, scene.name)
    return parts, notes


def _flag(name: str) -> str:
    """Give what is typed for a field."""
    return "--sun" if name == "direction" else "--" + name.replace("_", "-")


def medium_changed(own: Medium, given: Mapping[str, Any]) -> Medium:
    """Change fields of a medium; a g brings the phase function that has one."""
    return dataclasses.replace(own, **with_phase(given))


def suns_changed(own: Own, given: Mapping[str, Any], name: str) -> tuple[Sun, ...]:
    """Turn a scene's suns, or change their light.

    Directions take the place of the scene's. With one sun of its own all of them shine
    like that; with several each shines as the one in its place, and there must be as
    many, unless an irradiance is given too.
    """
    suns = own.suns or ()
    directions: Sequence[Array] = directed(given)
    light: list[Array] = list(given.get("irradiance", []))
    if not directions:
        if not suns:
            expected, advice = "it beside --irradiance", f"{name} has no sun of its own"
            raise ValueError(complaint("--sun", expected, "none", advice))
        directions = [sun.direction for sun in suns]
    if not light:
        light = [sun.irradiance for sun in suns]
        light = light or [default_sun(own.scattering)[0].irradiance]
        if len(light) not in (1, len(directions)):
            expected = f"{len(light)} of them, as many as {name} has suns"
            advice = "or give --irradiance too, once or for each"
            got = f"{len(directions)}"
            raise ValueError(complaint("--sun", expected, got, advice))
    elif len(light) not in (1, len(directions)):
        expected = f"one for all or {len(directions)}, one for each sun"
        raise ValueError(complaint("--irradiance", expected, f"{len(light)}"))
    light = light * len(directions) if len(light) == 1 else light
    return tuple(Sun(d, i) for d, i in zip(directions, light, strict=True))
