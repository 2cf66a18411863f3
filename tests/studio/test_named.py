"""Panels of named scenes show what is drawn, and a change of one number is one."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np
import pytest

import refcloud as rc
from refcloud.scene import SCENES, View, own_of
from refcloud.studio import setups
from refcloud.studio.knobs import plain
from refcloud.studio.recipe import evaluated
from refcloud.studio.scene_file import scene_of, scene_text
from refcloud.studio.setups import Frame

FRAME = Frame(24, 18)
# man-10 stands for the other figures whose eye frames clouds: its own are cheap.
NAMES = [n for n in sorted(SCENES) if n not in ("man-04", "man-08", "man-09")]
PARTS = {"camera": "camera", "sun": "suns", "medium": "medium", "look": "look"}


def own(name: str, frame: Frame = FRAME) -> dict[str, Any]:
    """What a scene is drawn with, by the names of blocks."""
    scene, view = SCENES[name], View(frame.width, frame.height)
    needs = scene.frames or bool(own_of(scene, view).open)
    found = own_of(scene, view, scene.model() if needs else None)
    parts = {key: getattr(found, part) for key, part in PARTS.items()}
    parts["sun"] = parts["sun"][0] if parts["sun"] else None
    return {key: part for key, part in parts.items() if part is not None}


def keywords(name: str, values: dict[str, Any]) -> dict[str, Any]:
    """What the recipe of a scene hands to `render`."""
    setup = setups()[name]
    call = setup.recipe(setup.taken(values), FRAME).stages[-1].call
    return {key: evaluated(value, {}) for key, value in call.keywords.items()}


def differing(one: Any, other: Any) -> set[str]:
    names = [f.name for f in fields(one)]
    return {n for n in names if plain(getattr(one, n)) != plain(getattr(other, n))}


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("size", [(320, 240), (24, 18), (1024, 768)])
def test_the_panel_shows_what_is_drawn(name: str, size: tuple[int, int]) -> None:
    mine, groups = own(name, Frame(*size)), {g.key: g for g in setups()[name].groups}
    assert {k for k in PARTS if k in groups and groups[k].on} == set(mine)
    for key, part in mine.items():
        for field, shown in groups[key].started().items():
            if shown is not None or getattr(part, field) is None:
                assert np.array_equal(shown, getattr(part, field)), (key, field)


def moved(value: Any) -> Any:
    """Another value of the same kind, a little off."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    if isinstance(value, np.ndarray):
        return [*(float(v) for v in value[:-1]), float(value[-1]) + 0.25]
    return 0.96875 * value + (0.015625 if value == 0.0 else 0.0)


@pytest.mark.parametrize("name", NAMES)
def test_one_change_in_the_panel_is_one_change_of_the_picture(name: str) -> None:
    mine = own(name)
    for key, part in mine.items():
        group = next(g for g in setups()[name].groups if g.key == key)
        for option in group.options:
            before = getattr(part, option.name)
            if isinstance(before, str) or before is None:
                continue
            found = keywords(name, {key: {option.name: moved(before)}})
            drawn = found[PARTS[key]]
            drawn = drawn[0] if key == "sun" else drawn
            # A direction is kept as a unit vector.
            assert differing(drawn, part) == {option.name}, (key, option.name)
            for other in set(mine) - {key}:
                held = found.get(PARTS[other])
                held = held[0] if isinstance(held, tuple) else held
                assert held is None or not differing(held, mine[other])


@pytest.mark.parametrize("name", NAMES)
def test_an_untouched_panel_is_left_to_the_scene(name: str) -> None:
    start = setups()[name].started()
    for values in ({}, start):
        found = keywords(name, values)
        assert found == {"width": 24, "height": 18, "tolerance": 1 / 255}


@pytest.mark.parametrize("name", ["cumulus", "demand"])
def test_a_coloured_medium_keeps_the_sun_and_the_look_of_the_panel(name: str) -> None:
    """The scene itself would take those of light that is scattered once."""
    mine = own(name)
    found = keywords(name, {"medium": {"albedo": [1.0, 0.9, 0.8]}})
    assert differing(found["medium"], mine["medium"]) == {"albedo"}
    assert not differing(found["suns"][0], mine["sun"])
    if "look" in mine:
        assert not differing(found["look"], mine["look"])


MOVES = {
    "cumulus": {"sun": {"direction": [-0.6, 0.6, 0.43]}, "look": {"relief": 0.3}},
    "demand": {"medium": {"g": 0.4}},
    "demand-background": {"camera": {"eye": [2.5, 0.9, 4.5]}},
    "man-10": {"camera": {"fov_y": 0.5}, "medium": {"albedo": 0.8}},
    "multiple": {"medium": {"g": 0.5}},
    "shader-lit": {"sun": {"irradiance": [9.0, 9.0, 9.0]}, "second_sun": {}},
}


@pytest.mark.parametrize("name", MOVES)
def test_file_python_and_picture_agree(name: str) -> None:
    setup = setups()[name]
    values = setup.taken(MOVES[name])
    text = setup.recipe(values, FRAME).python("a.png")
    found, again = scene_of(scene_text(setup, values))
    assert found is setup
    assert setup.recipe(again, FRAME).python("a.png") == text
    names: dict[str, Any] = {"__name__": "page"}
    drawn: list[dict[str, Any]] = []

    class Saved:
        def save(self, *words: Any, **how: Any) -> None: ...

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rc, "render", lambda name, **how: drawn.append(how) or Saved())
        exec(compile(text, name, "exec"), names)
    wanted = keywords(name, MOVES[name])
    assert set(drawn[0]) == set(wanted)
    for key, value in wanted.items():
        got = drawn[0][key]
        pairs = zip(got, value, strict=True) if key == "suns" else [(got, value)]
        for one, other in pairs:
            same = (
                one == other if key not in PARTS.values() else not differing(one, other)
            )
            assert same, key


def test_what_depends_on_the_size_is_chosen_by_itself() -> None:
    groups = {g.key: g for g in setups()["multiple"].groups}
    assert groups["medium"].started()["sigma_t"] is None
    small, large = own("multiple"), own("multiple", Frame(320, 240))
    found = keywords("multiple", {"medium": {"g": 0.5, "sigma_t": None}})
    assert found["medium"].sigma_t == small["medium"].sigma_t
    assert small["medium"].sigma_t != large["medium"].sigma_t
    with pytest.raises((TypeError, ValueError), match=r"^medium.sigma_t: "):
        setups()["cumulus"].taken({"medium": {"sigma_t": None}})
