"""Every parameter of the library has a control, and every value is checked."""

from __future__ import annotations

import inspect
import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import numbers_in

import refcloud as rc
from refcloud.cloudmap import box_cloud
from refcloud.conventions import Range
from refcloud.lighting import Octaves
from refcloud.march import Mixing
from refcloud.noise_pictures import noise_picture
from refcloud.parameters import options_of
from refcloud.studio import Box, box_picture, setups
from refcloud.studio.knobs import described, slider_ends

# What the page builds from, and the parameters that are no sliders: clouds and
# intermediates, and those that another block or the page's own controls give.
VIEW = {"width", "height"}
SOURCES: dict[str, list[tuple[str, Callable[..., Any], set[str]]]] = {
    "cloud": [
        ("generate", rc.generate, set()),
        ("approximate", rc.approximate, set()),
        ("sun", rc.Sun, set()),
        ("second_sun", rc.Sun, set()),
        ("medium", rc.Medium, set()),
        ("look", rc.Look, set()),
        ("camera", rc.Camera, VIEW),
        ("sky", rc.Sky, set()),
        ("haze", rc.Haze, set()),
        ("file", rc.Picture.codes, set()),
    ],
    "march": [("mixing", Mixing, set())],
    "box": [
        ("box", Box, set()),
        ("texture", box_cloud, {"first", "second"}),
        ("octaves", Octaves, set()),
        ("quality", box_picture, set()),
    ],
    "noise": [("noise", noise_picture, set())],
}
EVERY = [(name, *row) for name, rows in SOURCES.items() for row in rows]
# Of `render` itself: what no block of the page stands for.
OF_RENDER = {"tolerance", "seed", "backend", "scattering", "ambient"}
ELSEWHERE = {"width", "height", "background", "look", "method", "quality"}


@pytest.mark.parametrize(("setup", "key", "source", "without"), EVERY)
def test_every_parameter_has_a_control(setup, key, source, without) -> None:
    group = next(g for g in setups()[setup].groups if g.key == key)
    names = {o.name for o in options_of(source)} - without
    assert {knob["name"] for knob in described(group)["knobs"]} == names
    assert len(names) > 0


def test_every_parameter_of_render_has_a_control() -> None:
    names = {o.name for o in options_of(rc.render)}
    assert names == OF_RENDER | ELSEWHERE
    keys = ("cloud", "march")
    groups = [g for k in keys for g in setups()[k].groups if g.key == "quality"]
    assert {o.name for g in groups for o in g.options} == OF_RENDER


def test_every_scene_is_a_choice() -> None:
    assert set(rc.scenes.SCENES) < set(setups())


@pytest.mark.parametrize("name", sorted(setups()))
def test_starting_values_fit_and_can_be_sent(name) -> None:
    setup = setups()[name]
    assert json.loads(json.dumps(setup.described()))["name"] == name
    assert setup.taken(setup.started()).keys() == {g.key for g in setup.groups}
    for group in setup.groups:
        for knob in described(group)["knobs"]:
            assert knob["text"], f"{group.key}.{knob['name']}: no text"
            for way in knob["ways"]:
                check_slider(way, knob["begin"])


def check_slider(way: dict[str, Any], begin: Any) -> None:
    if "from" not in way:
        return
    assert way["from"] < way["to"]
    assert not way["log"] or way["from"] > 0.0
    if isinstance(begin, (int, float)) and way["kind"] in ("number", "whole"):
        assert way["from"] <= begin <= way["to"]


@given(
    numbers_in(Range(-1e6, 1e6)),
    st.sampled_from([0.0, 1e-3, 1.0, 100.0, math.inf]),
    st.booleans(),
    st.booleans(),
    st.sampled_from([0.0, 0.5, 3.0, 1e4]),
)
def test_sliders_stay_in_the_range(low, wide, open_lower, open_upper, near) -> None:
    limits = Range(low, low + wide + 1e-3, "1", open_lower, open_upper)
    first, last = slider_ends(limits, near, whole=False)
    assert limits.holds(first)
    assert limits.holds(last)
    assert first < last


BAD = [
    ({"generate": {"persistence": 2}}, "generate.persistence: expected"),
    ({"generate": {"persistence": float("nan")}}, "generate.persistence: expected"),
    ({"generate": {"persistence": "0.5"}}, "generate.persistence: expected"),
    ({"generate": {"persistence": True}}, "generate.persistence: expected"),
    ({"generate": {"persistence": None}}, "generate.persistence: expected"),
    ({"generate": {"octaves": 2.5}}, "generate.octaves: expected"),
    ({"generate": {"octaves": [4]}}, "generate.octaves: expected one value"),
    ({"generate": {"shape": "cube"}}, "generate.shape: expected one of"),
    ({"generate": {"shape": {}}}, "generate.shape: expected"),
    ({"generate": {"size": 1}}, "generate: expected one of shape"),
    ({"generate": {"diameters": [1, 2]}}, "generate.diameters: expected"),
    ({"generate": {"diameters": [1, 2, "3"]}}, "generate.diameters: expected"),
    ({"generate": {"diameters": [1, 2, 1e200]}}, "generate.diameters: expected"),
    ({"generate": []}, "generate: expected values by name"),
    ({"generate": None}, "generate: expected values by name"),
    ({"clouds": {}}, "values: expected one of generate"),
    ([], "values: expected blocks by name"),
]


@pytest.mark.parametrize(("values", "line"), BAD)
def test_values_that_do_not_fit_are_refused(values, line) -> None:
    with pytest.raises((ValueError, TypeError)) as refusal:
        setups()["cloud"].taken(values)
    assert str(refusal.value).startswith(line)
    assert "\n" not in str(refusal.value)


def test_arrays_come_out_as_the_library_takes_them() -> None:
    taken = setups()["cloud"].taken({"generate": {"diameters": [9, 8, 7]}})
    assert isinstance(taken["generate"]["diameters"], np.ndarray)
    assert "observe" in inspect.signature(rc.generate).parameters
