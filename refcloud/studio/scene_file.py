"""Scenes as TOML: the choice, and those values that differ from its start."""

from __future__ import annotations

import tomllib
from typing import Any

from refcloud.refusal import complaint
from refcloud.studio.choices import find_setup
from refcloud.studio.knobs import plain
from refcloud.studio.setups import Setup, Values

FORMAT, VERSION = "refcloud.studio", 1
OFF = "off"  # a block that is left to the scene
AUTO = "auto"  # a value that is chosen by itself


def scene_text(setup: Setup, values: Values) -> str:
    """Write a scene as TOML.

    Parameters
    ----------
    setup, values
        The choice and its checked values.

    Returns
    -------
    The text; `scene_of` reads it back to the same values.
    """
    lines = [f'format = "{FORMAT}"', f"version = {VERSION}", f'scene = "{setup.name}"']
    for group in setup.groups:
        now = values[group.key]
        if now is None:
            if group.on:
                lines.append(f'{group.key} = "{OFF}"')
            continue
        start = group.started()
        changed = {k: v for k, v in now.items() if plain(v) != plain(start[k])}
        if changed or not group.on:
            lines += ["", f"[{group.key}]"]
            lines += [f"{name} = {_written(v)}" for name, v in changed.items()]
    tables = [line for line in lines if not line.endswith(f'= "{OFF}"')]
    off = [line for line in lines if line.endswith(f'= "{OFF}"')]
    return "\n".join([*tables[:3], *off, *tables[3:]]) + "\n"


def _written(value: Any) -> str:
    value = plain(value)
    if value is None:
        return f'"{AUTO}"'
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list):
        return f"[{', '.join(map(_written, value))}]"
    return f'"{value}"' if isinstance(value, str) else repr(value)


def scene_of(text: str) -> tuple[Setup, Values]:
    """Read a scene from TOML; every value is checked.

    Parameters
    ----------
    text
        Of the file.

    Returns
    -------
    The choice and its values.

    Raises
    ------
    ValueError, TypeError
        It is no such file, or a value does not fit: one line.
    """
    try:
        found = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        line = " ".join(str(error).split())[:100]
        raise ValueError(complaint("scene", "a TOML file", line)) from None
    kind, version = found.pop("format", None), found.pop("version", None)
    if kind != FORMAT or version != VERSION:
        expected = f'format = "{FORMAT}" and version = {VERSION}'
        got = f"{kind!r:.40} and {version!r:.20}"
        raise ValueError(complaint("scene", expected, got))
    setup = find_setup(found.pop("scene", None))
    given = {}
    for key, block in found.items():
        if block == OFF:
            given[key] = None
        elif isinstance(block, dict):
            given[key] = {k: None if v == AUTO else v for k, v in block.items()}
        else:
            given[key] = block
    return setup, setup.taken(given)


def as_json(values: Values) -> dict[str, Any]:
    """Give checked values as the page takes them."""
    return {
        key: None if block is None else {k: plain(v) for k, v in block.items()}
        for key, block in values.items()
    }
