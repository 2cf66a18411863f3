"""Scenes to TOML: what has its default is left out, floats keep their last bit."""

from __future__ import annotations

import dataclasses
import json
import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from refcloud.conventions import Array
from refcloud.declared.declaration import FORMAT, VERSION, Declaration, Placement
from refcloud.declared.kinds import Changed
from refcloud.files import write_atomically
from refcloud.lighting import named
from refcloud.optics import Sun
from refcloud.parameters import parameter_texts
from refcloud.sky import Sky

WIDTH = 88  # of a line of comment
DELETE, ESCAPED_DELETE = "\x7f", "\\u007f"  # JSON writes it as it is, TOML forbids it


def save_scene(path: str | Path, scene: Declaration | Changed) -> Path:
    """Write a declaration as TOML; what has its default is left out.

    Parameters of a kind are all written, so that they can be seen and changed, each
    under a comment that says what it is.

    Parameters
    ----------
    path
        Name of the file; an old one is replaced.
    scene
        What is written; reading the file gives it again, to the last bit.

    Returns
    -------
    The path.
    """
    lines = _kind_lines(scene) if isinstance(scene, Changed) else _lines(scene)
    text = "\n".join(lines) + "\n"
    write_atomically(path, lambda file: file.write(text.encode()))
    return Path(path)


def _lines(scene: Declaration) -> list[str]:
    lines = [f'format = "{FORMAT}"', f"version = {VERSION}"]
    lines += [f"name = {_value(scene.name)}", f"title = {_value(scene.title)}"]
    if scene.scattering != "single":
        lines += [f"scattering = {_value(scene.scattering)}"]
    if scene.camera is not None:
        lines += _section("[camera]", scene.camera)
    for sun in scene.suns:
        lines += _section("[[sun]]", _changed(sun, Sun(sun.direction)), sun)
    if scene.medium is not None:
        lines += _section("[medium]", _changed(scene.medium, None))
    like = "man" if scene.look.scattering == "man2003" else "cumulus"
    look = _changed(scene.look, named(like))
    lines += _section("[look]", {"like": like, **look})
    lines += _section("[sky]", _changed(scene.sky, Sky()))
    for cloud in scene.clouds:
        lines += _section("[[cloud]]", _changed(cloud.place, Placement()))
        lines += _section("[cloud.shape]", cloud.shape)
        if cloud.balls is not None:
            lines += _section("[cloud.balls]", cloud.balls)
        if cloud.look:
            lines += _section("[cloud.look]", cloud.look)
    return lines


def _kind_lines(scene: Changed) -> list[str]:
    lines = [f'format = "{FORMAT}"', f"version = {VERSION}"]
    lines += [f"kind = {_value(scene.kind)}"]
    lines += [f"name = {_value(scene.name)}", f"title = {_value(scene.title)}"]
    texts = parameter_texts(type(scene.of))
    return [*lines, *_nested("parameters", scene.of, texts=texts)]


def _nested(
    name: str, thing: Any, marks: str = "[]", *, texts: Mapping[str, str] | None = None
) -> list[str]:
    """Write a dataclass as a table, its plain fields before those with tables.

    Fields that have a text get it as a comment.
    """
    texts = texts or {}
    fields = {f.name: getattr(thing, f.name) for f in dataclasses.fields(thing)}
    rows = {
        key: value
        for key, value in fields.items()
        if isinstance(value, tuple) and value and dataclasses.is_dataclass(value[0])
    }
    inner = {k: v for k, v in fields.items() if dataclasses.is_dataclass(v)}
    plain = {k: v for k, v in fields.items() if k not in rows and k not in inner}
    half = len(marks) // 2
    lines = ["", f"{marks[:half]}{name}{marks[half:]}"]
    told = ""
    for key, value in plain.items():
        text = texts.get(key, "")
        # Fields that share their text follow each other.
        lines += [] if text == told else _comment(text)
        told = text
        lines += [] if value is None else [f"{key} = {_value(value)}"]
    for key, value in inner.items():
        table = _nested(f"{name}.{key}", value)[1:]
        lines += ["", *_comment(texts.get(key, "")), *table]
    for key, values in rows.items():
        lines += ["", *_comment(texts.get(key, ""))] if values else []
        for number, value in enumerate(values):
            # The first stands right under its comment.
            lines += _nested(f"{name}.{key}", value, "[[]]")[number == 0 :]
    return lines


def _comment(text: str) -> list[str]:
    """Write a text as lines of comment."""
    return [f"# {line}" for line in textwrap.wrap(text, WIDTH - 2)]


def _changed(thing: Any, default: Any) -> dict[str, Any]:
    """Give the fields that differ from those of the default, None for all."""
    return {
        f.name: getattr(thing, f.name)
        for f in dataclasses.fields(thing)
        if default is None
        or not np.array_equal(getattr(thing, f.name), getattr(default, f.name))
    }


def _section(head: str, table: Mapping[str, Any], sun: Sun | None = None) -> list[str]:
    if sun is not None:
        table = {"direction": sun.direction, **table}
    rows = [f"{k} = {_value(v)}" for k, v in table.items() if v is not None]
    return ["", head, *rows]


def _value(value: Any) -> str:
    """Write a value as TOML does: nearly as JSON, every float to its last bit."""
    if isinstance(value, (np.ndarray, tuple, list)):
        numbers: Array = np.asarray(value)
        return "[" + ", ".join(_value(v) for v in numbers.tolist()) + "]"
    text = json.dumps(value, ensure_ascii=False)
    return text.replace(DELETE, ESCAPED_DELETE)
