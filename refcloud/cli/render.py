"""``refcloud render``: a cloud or a named scene to a picture, the third program."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from refcloud.camera import AnyCamera
from refcloud.choices import framed
from refcloud.cli.changed import changed
from refcloud.cli.clouds import denser, describe, find, load, scene_of
from refcloud.cli.docstrings import parameter_texts, summary
from refcloud.cli.options import Option, options_of
from refcloud.cli.outputs import OVER, ready, report
from refcloud.cli.parser import Command, Given
from refcloud.cli.progress import Stages
from refcloud.cli.setting import (
    CAMERA,
    MEDIUM,
    SUN,
    backdrop,
    background_for,
    camera_for,
    medium_for,
    size_for,
    suns_for,
)
from refcloud.cli.studio_file import is_studio_file, studio_picture
from refcloud.cloudmap import VoxelGrid
from refcloud.extremes import refuse_bright, refuse_far
from refcloud.image import Picture
from refcloud.march import Mixing
from refcloud.metaballs import Levels, Metaballs, choose_level
from refcloud.metaballs.levels import covered_share, picture_bounds
from refcloud.refusal import complaint, counted
from refcloud.render import as_drawn, is_marched, render
from refcloud.scenes import Scene, View

ABOUT = summary(render)
TEXTS = parameter_texts(render)
# Savings that stay below one step of an 8-bit picture: nobody sees them in a PNG.
TOLERANCE = 1.0 / 255.0
SUFFIXES = (".png", ".npy")


def _options() -> tuple[tuple[Option, ...], tuple[Option, ...]]:
    """Give the options of `render` itself, and its background."""
    own, behind = [], []
    for option in options_of(render, without=("cloud",)):
        if option.name == "background":
            behind.append(backdrop(option))
        elif option.name == "tolerance":
            own.append(dataclasses.replace(option, default=TOLERANCE))
        else:
            own.append(option)
    return tuple(own), tuple(behind)


OPTIONS, BACKGROUND = _options()
SAVING = options_of(Picture.codes)
DENSITY = options_of(denser, without=("cloud",))
MIXING = options_of(Mixing)
PARTS = {"camera": CAMERA, "suns": SUN, "medium": MEDIUM}
SEVERAL = "A scene with several suns takes as many directions, or an irradiance too."
BESIDE = "Beside a scene what is not given stays the scene's own."


def command() -> Command:
    """Give the command's argument and options."""
    made = Command(
        "render",
        ABOUT,
        output="name of the picture (.png, or .npy for linear light); by default"
        " WHAT.png" + OVER,
    )
    made.argument(
        "WHAT",
        "a scene (see refcloud list, or a .toml), metaballs or a cloud map (.npz)",
    )
    add_groups(made, OPTIONS)
    return made


def add_groups(made: Command, options: Iterable[Option]) -> None:
    """Add the options of pictures under their titles."""
    made.group("the picture", "", options)
    made.group("the camera", f"{TEXTS['camera']} {BESIDE}", CAMERA)
    made.group("the light", f"{TEXTS['suns']} {BESIDE} {SEVERAL}", SUN)
    made.group("the cloud's medium", f"{TEXTS['medium']} {BESIDE}", (*MEDIUM, *DENSITY))
    made.group("how marched light mixes", TEXTS["mixing"], MIXING)
    made.group("behind the cloud", "", BACKGROUND)
    made.group("the file", "", SAVING)


def run(words: Sequence[str]) -> int:
    """Render a cloud and write its picture."""
    given = command().parse(words)
    what = given.arguments[0]
    find(what)
    name = Path(what).stem
    chosen = chosen_of(given)
    path = ready(given.named(f"{name}.png"), SUFFIXES, inputs=[what])
    stages, notes, saving = Stages(), [], given.of(SAVING)
    if is_studio_file(what):
        with stages.stage("render"):
            picture, saving = studio_picture(given, what)
    else:
        cloud, parts, notes = prepared(given, chosen, stages)
        with stages.stage("render"):
            picture = render(cloud, **parts, **chosen, observe=stages.watch)
    # What the picture knows of its own stages says more than their sum.
    stages.seconds.pop("render")
    stages.seconds.update(picture.seconds)
    with stages.stage("save"):
        picture.save(path, **saving)
    report([*notes, *picture.notes], picture.skipped, stages.line(), path)
    return 0


def chosen_of(given: Given) -> dict[str, Any]:
    """Give the keywords of `render` that were typed as they are."""
    behind = background_for(given.of(BACKGROUND))
    return {"tolerance": TOLERANCE, **given.of(OPTIONS), **behind}


def prepared(
    given: Given, chosen: Mapping[str, Any], stages: Stages
) -> tuple[Metaballs | VoxelGrid | Scene, dict[str, Any], list[str]]:
    """Load what is drawn, and put together its camera, suns, medium and mixing.

    Parameters
    ----------
    given
        What was typed.
    chosen
        Of `chosen_of`.
    stages
        Times the loading.

    Returns
    -------
    The cloud or the scene's name, further keywords of `render`, and what to say.
    """
    what, size = given.arguments[0], size_for(chosen)
    _refuse_extreme(given)
    if find(what):
        return of_scene(given, chosen, scene_of(what))
    suns = suns_for(given.of(SUN), False, chosen.get("scattering"))
    with stages.stage("load"):
        cloud = load(what)
    notes = [f"{what}: {describe(cloud)}"]
    levels = cloud if isinstance(cloud, Levels) else None
    cloud = cloud.finest if isinstance(cloud, Levels) else cloud
    method = chosen.get("method")
    _refuse_idle_mixing(given, chosen, is_marched(cloud, method))
    shown = as_drawn(cloud, method)
    camera = camera_for(given.of(CAMERA), shown, size)
    scale, mixing = given.of(DENSITY), given.of(MIXING)
    # A factor on the density counts against the file's own optical depth.
    medium, note = medium_for(
        given.of(MEDIUM),
        shown,
        chosen.get("look"),
        method,
        density=scale.get("density"),
    )
    if levels is not None:
        camera = camera or framed(levels.finest, *size)
        cloud = choose_level(levels, camera, tolerance=chosen["tolerance"])
        notes.append(level_note(levels, camera, cloud))
    parts = {
        "camera": camera,
        "suns": suns,
        "medium": medium,
        "mixing": Mixing(**mixing) if mixing else None,
    }
    return denser(cloud, **scale), parts, [*notes, *note]


def _refuse_extreme(given: Given) -> None:
    """Refuse typed places and lights beyond the ends of scenes, as they are typed."""
    for flag in ("--eye", "--target"):
        if flag in given.options:
            refuse_far(flag, given.options[flag])
    for light in given.options.get("--irradiance", ()):
        refuse_bright("--irradiance", light)


def _refuse_idle_mixing(given: Given, chosen: Mapping[str, Any], march: bool) -> None:
    """Refuse a way of mixing where no ray is marched through light mixed so."""
    for option in MIXING:
        if option.flag not in given.options:
            continue
        if not march:
            expected = "none beside --method splat"
            advice = f"choose --method march, or leave {option.flag} out"
            raise ValueError(complaint(option.flag, expected, "one", advice))
        if chosen.get("scattering") == "multiple":
            expected = "none beside --scattering multiple"
            raise ValueError(complaint(option.flag, expected, "one"))


def of_scene(
    given: Given, chosen: Mapping[str, Any], scene: Scene
) -> tuple[Scene, dict[str, Any], list[str]]:
    """Change a scene's own camera, suns and medium by what was typed."""
    for option in (*DENSITY, *MIXING):
        if option.flag in given.options:
            raise ValueError(complaint(option.flag, "none beside a scene", "one"))
    size, scattering = size_for(chosen), chosen.get("scattering")
    if scene.brings is None:
        medium, note = medium_for(given.of(MEDIUM), None, chosen.get("look"), None)
        suns = suns_for(given.of(SUN), True, scattering)
        camera = camera_for(given.of(CAMERA), None, size)
        return scene, {"camera": camera, "suns": suns, "medium": medium}, [*note]
    typed = {name: given.of(each) for name, each in PARTS.items()}
    view = View(*size, look=chosen.get("look"), scattering=scattering)
    parts, notes = changed(scene, view, **typed)
    return scene, parts, list(notes)


def level_note(levels: Levels, camera: AnyCamera, chosen: Metaballs) -> str:
    """Say which level was chosen, and from which tolerance on others would be.

    What counts is the share of the picture that the cloud covers, not its pixels.
    """
    share = covered_share(levels.finest, camera)
    bounds = picture_bounds(levels, share)
    fewer = [
        f"{len(balls)} from --tolerance {math.ceil(1e3 * bound) / 1e3:g}"
        for balls, bound in zip(levels.levels, bounds, strict=True)
        if len(balls) < len(chosen) and bound <= 1.0
    ]
    size = f"{100.0 * share:.3g} % of the picture"
    line = f"level of {counted(len(chosen), 'ball')}, at {size}"
    return f"{line}: {', '.join(fewer)}" if fewer else line
