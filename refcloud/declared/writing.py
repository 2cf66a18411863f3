"""Scenes to TOML: what has its default is left out, floats keep their last bit."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from refcloud.conventions import Array
from refcloud.declared.declaration import FORMAT, VERSION, Declaration, Placement
from refcloud.files import write_atomically
from refcloud.lighting import named
from refcloud.optics import Sun
from refcloud.sky import Sky

DELETE, ESCAPED_DELETE = "\x7f", "\\u007f"  # JSON writes it as it is, TOML forbids it


def save_scene(path: str | Path, scene: Declaration) -> Path:
    """Write a declaration as TOML; what has its default is left out.

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
    text = "\n".join(_lines(scene)) + "\n"
    write_atomically(path, lambda file: file.write(text.encode()))
    return Path(path)


def _lines(scene: Declaration) -> list[str]:
    lines = [f'format = "{FORMAT}"', f"version = {VERSION}"]
    lines += [f"name = {_value(scene.name)}", f"title = {_value(scene.title)}"]
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
