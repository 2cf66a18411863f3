"""A number typed beside a scene changes that number, and none of the scene's others."""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np
import pytest

import refcloud as rc
from refcloud.cli.changed import changed
from refcloud.cli.render import PARTS
from refcloud.declared import Declaration, scene_from
from refcloud.scene import SCENES, Scene, View, own_of

VIEW = View(16, 12)
NOTHING = {"camera": {}, "suns": {}, "medium": {}}
MEDIUM = {"sigma_t": 3.25, "albedo": 0.75, "g": 0.125, "phase": "isotropic"}
CAMERA = {
    "eye": np.array([1.0, -2.0, 150.0]),
    "target": np.array([0.5, 3.0, 1.0]),
    "up": np.array([0.25, 1.0, 0.0]),
    "fov_y": 0.625,
}
# man-10 has cheap clouds, which its eye frames; `multiple` a medium of its cloud.
NAMES = [name for name in sorted(SCENES) if name not in ("man-08", "man-09")]


def differing(one: object, other: object) -> set[str]:
    """Name the fields in which two dataclasses differ."""
    return {
        f.name
        for f in fields(one)  # pyright: ignore[reportArgumentType]
        if not np.array_equal(getattr(one, f.name), getattr(other, f.name))
    }


def own(name: str) -> rc.scenes.Own:
    scene = SCENES[name]
    needs = scene.frames or bool(own_of(scene, VIEW).open)
    return own_of(scene, VIEW, scene.model() if needs else None)


@pytest.mark.parametrize("name", NAMES)
def test_one_number_changes_one_number(name: str) -> None:
    mine = own(name)
    for part, before, numbers in (
        ("medium", mine.medium, MEDIUM),
        ("camera", mine.camera, CAMERA),
    ):
        if before is None:
            continue
        for field, value in numbers.items():
            typed = {**NOTHING, part: {field: value}}
            parts, notes = changed(SCENES[name], VIEW, **typed)
            wanted = {field, "phase"} if field == "g" else {field}  # hg alone has a g
            assert differing(parts[part], before) <= wanted
            assert np.array_equal(getattr(parts[part], field), value)
            assert [k for k, v in parts.items() if v is not None] == [part]
            assert notes == ()


@pytest.mark.parametrize("name", NAMES)
def test_what_a_scene_has_typed_again_changes_nothing(name: str) -> None:
    mine = own(name)
    typed = {key: {} for key in PARTS}
    if mine.camera is not None:
        typed["camera"] = {"eye": mine.camera.eye}
    if mine.medium is not None:
        typed["medium"] = {"sigma_t": mine.medium.sigma_t}
    if mine.suns:
        typed["suns"] = {"direction": [sun.direction for sun in mine.suns]}
    parts, notes = changed(SCENES[name], VIEW, **typed)
    assert notes == ()
    for part, before in (("camera", mine.camera), ("medium", mine.medium)):
        assert before is None or differing(parts[part], before) == set()
    for sun, old in zip(parts["suns"] or (), mine.suns or (), strict=True):
        assert np.array_equal(sun.irradiance, old.irradiance)
        assert np.allclose(sun.direction, old.direction, rtol=0.0, atol=1e-15)


def lit_by(count: int) -> Scene:
    """Declare a scene with so many suns; its clouds are never made."""
    suns = tuple(rc.Sun([k, 1.0, 0.5], [k + 1.0, 2.0, 3.0]) for k in range(count))
    camera = {"eye": np.array([0.0, 0.0, 9.0]), "target": np.zeros(3)}
    return scene_from(Declaration("lit", "", (), camera, suns, rc.Medium(2.0, 0.5)))


UP, DOWN = np.array([0.0, 1.0, 0.0]), np.array([0.0, -1.0, 0.0])
RED = np.array([1.0, 0.0, 0.0])


@pytest.mark.parametrize(
    ("has", "directions", "light", "reds"),
    [
        (1, [UP], [], [1.0]),
        (1, [UP, DOWN], [], [1.0, 1.0]),
        (1, [], [5 * RED], [5.0]),
        (2, [UP, DOWN], [], [1.0, 2.0]),
        (2, [], [5 * RED], [5.0, 5.0]),
        (2, [], [5 * RED, 6 * RED], [5.0, 6.0]),
        (2, [UP], [5 * RED], [5.0]),
        (3, [UP, DOWN, UP], [], [1.0, 2.0, 3.0]),
    ],
)
def test_suns_keep_what_was_not_typed(has, directions, light, reds) -> None:
    scene = lit_by(has)
    typed = {"direction": directions, "irradiance": light}
    parts, _ = changed(scene, VIEW, **{**NOTHING, "suns": typed})
    assert [sun.irradiance[0] for sun in parts["suns"]] == reds
    wanted = directions or [sun.direction for sun in scene.motion.suns]
    for sun, direction in zip(parts["suns"], wanted, strict=True):
        assert np.allclose(sun.direction, direction, rtol=0.0, atol=1e-15)


@pytest.mark.parametrize(("has", "count"), [(2, 1), (2, 3), (3, 1), (3, 2)])
def test_directions_that_fit_no_suns_are_refused(has: int, count: int) -> None:
    line = f"^--sun: expected {has} of them, as many as lit has suns, got {count}; or"
    with pytest.raises(ValueError, match=line):
        changed(lit_by(has), VIEW, **{**NOTHING, "suns": {"direction": [UP] * count}})
    line = f"^--irradiance: expected one for all or {has}, .*, got {has + 1}$"
    light = {"irradiance": [RED] * (has + 1)}
    with pytest.raises(ValueError, match=line):
        changed(lit_by(has), VIEW, **{**NOTHING, "suns": light})


@pytest.mark.parametrize("name", ["cumulus", "demand"])
@pytest.mark.parametrize("scattering", [None, "single", "multiple"])
def test_the_kind_of_scattering_says_which_numbers_stay(name, scattering) -> None:
    """Coloured light is scattered once, with the numbers that the scene has for it."""
    view = replace(VIEW, scattering=scattering)
    before = own_of(SCENES[name], view).medium
    once = own_of(SCENES[name], replace(VIEW, scattering="single")).medium
    for albedo in (0.75, np.array([1.0, 0.9, 0.8])):
        typed = {**NOTHING, "medium": {"albedo": albedo}}
        parts, notes = changed(SCENES[name], view, **typed)
        turns = scattering is None and np.ndim(albedo) == 1
        assert differing(parts["medium"], once if turns else before) <= {"albedo"}
        assert bool(notes) == turns


@pytest.mark.parametrize(
    "typed",
    ["--sigma-t 1", "--sun -0.62 0.62 0.42", "--albedo 0.9", "--up 0 1 0"],
)
def test_a_line_that_says_what_the_scene_has_draws_the_scene(typed, run, here) -> None:
    line = "render man-10 --width 12 --height 9 -o"
    for name, more in (("a.npy", ""), ("b.npy", typed)):
        ended = run(*f"{line} {name} {more}".split())
        assert ended.status == 0, ended.err
    one, other = (rc.load_picture(name).linear for name in ("a.npy", "b.npy"))
    assert np.array_equal(one, other)
