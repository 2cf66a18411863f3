"""Help names every parameter of the library with its text, default, range and unit."""

from __future__ import annotations

import dataclasses
import inspect
import math
import re
import typing
from collections.abc import Callable, Iterator
from typing import Any, Literal

import numpy as np
import pytest

import refcloud as rc
from refcloud.cli.approximate import Outputs
from refcloud.cli.bench import Measurement
from refcloud.cli.clouds import denser
from refcloud.cli.docstrings import parameter_texts
from refcloud.cli.entry import COMMANDS
from refcloud.cli.figure import Setting
from refcloud.cli.studio import Page
from refcloud.conventions import Range
from refcloud.figure import figures
from refcloud.march import Mixing
from refcloud.noise_pictures import noise_picture

# What each command takes its options from, and the parameters that words cannot give.
PICTURES: list[tuple[Callable[..., Any], set[str]]] = [
    (rc.Camera, {"width", "height"}),
    (rc.Sun, set()),
    (rc.Medium, set()),
    (denser, {"cloud"}),
    (Mixing, set()),
    (rc.Picture.save, {"self", "path"}),
]
SOURCES: dict[str, list[tuple[Callable[..., Any], set[str]]]] = {
    "generate": [(rc.generate, {"observe"})],
    "approximate": [(rc.approximate, {"grid", "observe"}), (Outputs, set())],
    "render": [
        (
            rc.render,
            {
                *("cloud", "camera", "suns", "medium", "haze", "mixing", "observe"),
                "volumes",
            },
        ),
        *PICTURES,
    ],
    "animate": [
        (
            rc.render,
            {
                *("cloud", "camera", "suns", "medium", "haze", "mixing", "observe"),
                *("volumes", "quality"),
            },
        ),
        (rc.Moves, set()),
        (
            rc.animate,
            {
                name
                for name in inspect.signature(rc.animate).parameters
                if name not in ("frames", "fps", "jobs", "redraw")
            },
        ),
        *PICTURES,
    ],
    "compare": [
        (rc.compare_codes, {"a", "b"}),
        (rc.difference_picture, {"a", "b"}),
    ],
    "figure": [(Setting, set())],
    "list": [],
    "scene": [],
    "noise": [(noise_picture, {"kind"})],
    "bench": [(Measurement, set())],
    "studio": [(Page, set())],
}
RENAMED = {"direction": "sun"}
OWN_DEFAULTS = {
    ("render", "tolerance"): "1/255",
    ("animate", "tolerance"): "1/255",
}
PARAMETERS = [
    (command, source, name)
    for command, sources in SOURCES.items()
    for source, without in sources
    for name in inspect.signature(source).parameters
    if name not in without
]


@pytest.fixture
def blocks(run, monkeypatch) -> Callable[[str], dict[str, str]]:
    """Give the help of a command, cut into its options."""

    def blocks(command: str) -> dict[str, str]:
        monkeypatch.setenv("COLUMNS", "80")
        status, out, err = run(command, "--help")
        assert (status, err) == (0, "")
        parts = re.split(r"^  (?=-)", out, flags=re.M)[1:]
        return {re.split(r"[ ,\n]", part)[0]: " ".join(part.split()) for part in parts}

    return blocks


def ranges(hint: Any) -> Iterator[Range]:
    for part in typing.get_args(hint):
        if isinstance(part, Range):
            yield part
        else:
            yield from ranges(part)


def names(hint: Any) -> Iterator[str]:
    if typing.get_origin(hint) is Literal:
        yield from typing.get_args(hint)
    else:
        for part in typing.get_args(hint):
            yield from names(part)


def default_of(source: Callable[..., Any], name: str) -> Any:
    if dataclasses.is_dataclass(source):
        field = next(f for f in dataclasses.fields(source) if f.name == name)
        if field.default_factory is not dataclasses.MISSING:
            return field.default_factory()
    return inspect.signature(source).parameters[name].default


def said(default: Any) -> str:
    if default is None or default is inspect.Parameter.empty:
        return "as described"
    if isinstance(default, bool):
        return "on" if default else "off"
    if isinstance(default, np.ndarray):
        return " ".join(f"{value:g}" for value in default)
    return f"{default:g}" if isinstance(default, float) else str(default)


def test_every_command_is_walked() -> None:
    assert set(SOURCES) == set(COMMANDS)


@pytest.mark.parametrize(
    ("command", "source", "name"), PARAMETERS, ids=lambda v: getattr(v, "__name__", v)
)
def test_help_tells_all_of_a_parameter(command, source, name, blocks) -> None:
    text = blocks(command)["--" + RENAMED.get(name, name).replace("_", "-")]
    default = OWN_DEFAULTS.get((command, name), said(default_of(source, name)))
    assert f"(default {default}" in text
    hint = typing.get_type_hints(source, include_extras=True)[name]
    for limits in ranges(hint):
        assert f"range {limits}" in text
    units = {limits.unit for limits in ranges(hint)} - {"1"}
    assert all(unit in text for unit in units)
    assert all(choice in text for choice in names(hint))
    if source is not rc.Picture.save:  # it refers to `codes`, whose text is shown
        assert parameter_texts(source)[name].rstrip(".") in text


@pytest.mark.parametrize("command", COMMANDS)
def test_help_is_about_the_command_line(command, blocks, run) -> None:
    text = run(command, "--help").out
    text = re.sub(r'\bnumpy(?=[",])', "", text)  # the name of a backend
    assert not re.search(r"None|Python|numpy|`|\(\d,\)|Shape|Array", text)
    assert all(len(line) <= 80 for line in text.split("\n"))


def test_overview_names_every_command(run) -> None:
    status, out, err = run("--help")
    assert (status, err) == (0, "")
    assert all(re.search(rf"^  {name} +[A-Z].*\.$", out, re.M) for name in COMMANDS)


def test_version(run) -> None:
    assert run("--version") == (0, f"refcloud {rc.__version__}\n", "")


def test_list_names_every_scene_with_its_title(run) -> None:
    status, out, err = run("list")
    assert (status, err) == (0, "")
    lines = dict(line.split(maxsplit=1) for line in out.splitlines())
    scenes = {name: scene.title for name, scene in rc.scenes.SCENES.items()}
    assert scenes.items() <= lines.items()
    # And every figure that is no scene.
    assert {*lines} == {*scenes, *figures()}
    assert lines["man-05"] == (
        "document M, figure 5: basis functions (refcloud figure man-05)"
    )


def test_four_pi_is_said_as_a_number(blocks) -> None:
    assert f"default {4 * math.pi:g}" in blocks("render")["--irradiance"]


@pytest.mark.parametrize("command", COMMANDS)
def test_help_says_whether_an_old_file_is_written_over(command, run) -> None:
    text = " ".join(run(command, "--help").out.split())
    if "--output FILE" in text:
        kept = command == "scene"
        assert ("a file of that name is kept, unless with --force" in text) is kept
        assert ("a file of that name is written over" in text) is not kept
