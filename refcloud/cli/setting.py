"""Camera, suns, medium and background from options; what is left out is completed.

A file's cloud is there to be framed and measured, so each part may be given alone.
What completes a scene's parts is in `refcloud.cli.changed`; a scene that does not say
what it is drawn with is given whole parts.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any, Literal

import numpy as np

from refcloud.camera import Camera
from refcloud.choices import default_medium, default_sun, framed, size_of
from refcloud.cli.options import Option, options_of
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import unit_vector
from refcloud.lighting import named
from refcloud.metaballs import Metaballs
from refcloud.optics import ALBEDO_MAN2003, Medium, Sun
from refcloud.refusal import complaint
from refcloud.render import is_marched, render
from refcloud.sky import Sky

SKY = "sky"
CAMERA = options_of(Camera, without=("width", "height"))
MEDIUM = options_of(Medium)
SUN = tuple(
    dataclasses.replace(
        option,
        flag="--sun" if option.name == "direction" else option.flag,
        repeated=True,
    )
    for option in options_of(Sun)
)
QUALITY = next(o.default for o in options_of(render) if o.name == "quality")


def backdrop(option: Option) -> Option:
    """Let the default sky be asked for by name beside what `render` takes."""
    return dataclasses.replace(option, kinds=(Literal["sky"], *option.kinds))


def background_for(given: Mapping[str, Any]) -> dict[str, Any]:
    """Put the default sky in the place of its name."""
    return {
        name: Sky() if isinstance(value, str) and value == SKY else value
        for name, value in given.items()
    }


def size_for(chosen: Mapping[str, Any]) -> tuple[int, int]:
    """Give the picture's width and height.

    Raises
    ------
    ValueError
        The picture is too large; found before any work.
    """
    width, height = size_of(
        chosen.get("width"), chosen.get("height"), chosen.get("quality", QUALITY)
    )
    Camera(np.ones(3), np.zeros(3), width=width, height=height)
    return width, height


def camera_for(
    given: Mapping[str, Any], cloud: Metaballs | VoxelGrid | None, size: tuple[int, int]
) -> Camera | None:
    """Complete the camera from the cloud's frame; None where nothing was given.

    Raises
    ------
    ValueError
        A scene's camera is given in part.
    """
    if not given:
        return None
    width, height = size
    if cloud is None:
        for flag in ("eye", "target"):
            if flag not in given:
                expected = f"it beside --{next(iter(given)).replace('_', '-')}"
                advice = "a scene's camera is given with --eye and --target"
                raise ValueError(complaint(f"--{flag}", expected, "none", advice))
        return Camera(**given, width=width, height=height)
    return dataclasses.replace(framed(cloud, width, height), **given)


def medium_for(
    given: Mapping[str, Any],
    cloud: Metaballs | VoxelGrid | None,
    look: Literal["cumulus", "man"] | None,
    method: Literal["splat", "march"] | None,
    *,
    density: float | None = None,
) -> tuple[Medium | None, tuple[str, ...]]:
    """Complete the medium from `render`'s own choice; None where that is left to it.

    Parameters
    ----------
    given
        What was typed.
    cloud
        What is drawn: balls, or a cloud map that is marched; None for a scene.
    look, method
        How.
    density
        Factor by which the cloud's density will change after the choice, if it will.

    Returns
    -------
    The medium, and what was chosen.

    Raises
    ------
    ValueError
        A scene's medium is given without its extinction.
    """
    if not given and density is None:
        return None, ()
    given = with_phase(given)
    rules = (
        None
        if cloud is not None and is_marched(cloud, method)
        else named(look or "cumulus")
    )
    paper = rules is not None and rules.tau is not None  # its albedo is not 1
    if "sigma_t" in given and not paper:
        return Medium(**given), ()
    if cloud is None:
        if "sigma_t" in given:
            return Medium(**{"albedo": ALBEDO_MAN2003, **given}), ()
        expected = f"it beside --{next(iter(given), 'density')}"
        advice = "a scene's medium is given as a whole"
        raise ValueError(complaint("--sigma-t", expected, "none", advice))
    factor = 1.0 if density is None else density
    medium, note = default_medium(cloud, rules, density=factor, **given)
    return medium, (note,)


def with_phase(given: Mapping[str, Any]) -> Mapping[str, Any]:
    """Add the phase function that has a g, where a g was typed and no phase.

    Raises
    ------
    ValueError
        Another phase function was typed beside a g.
    """
    if given.get("phase", "hg") != "hg" and "g" in given:
        expected = f"none beside --phase {given['phase']}"
        raise ValueError(complaint("--g", expected, "one", "--phase hg has a g"))
    return {**given, "phase": "hg"} if "g" in given else given


def directed(given: Mapping[str, Any]) -> list[Any]:
    """Give the directions that were typed; a zero is refused by the name typed."""
    directions = given.get("direction", [])
    for direction in directions:
        unit_vector(direction, "--sun")
    return directions


def suns_for(
    given: Mapping[str, Any], is_scene: bool, scattering: str | None = None
) -> tuple[Sun, ...] | None:
    """Pair directions with irradiances; None where nothing was given.

    Raises
    ------
    ValueError
        Their numbers do not fit, a direction is zero, or a scene's light is given
        without a direction.
    """
    if not given:
        return None
    default, _ = default_sun(scattering)
    directions = directed(given)
    light = given.get("irradiance", [])
    if not directions:
        if is_scene:
            advice = "a scene's light is given with its direction"
            raise ValueError(
                complaint("--sun", "it beside --irradiance", "none", advice)
            )
        directions = [default.direction]
    if len(light) not in (0, 1, len(directions)):
        expected = f"one for all or {len(directions)}, one for each --sun"
        raise ValueError(complaint("--irradiance", expected, f"{len(light)}"))
    light = light or [default.irradiance]  # a moved sun shines as it did
    light = light * len(directions) if len(light) == 1 else light
    return tuple(Sun(d, i) for d, i in zip(directions, light, strict=True))
