"""Scenes from TOML: every number is checked against the library's own range.

Every table of the file is one function's or dataclass's parameters, under their own
names: ``shape`` those of `generate`, ``balls`` those of `approximate`, ``camera``,
``sun``, ``medium``, ``look`` and ``sky`` the fields of those types. What is left out
has the default that it has in Python. A file with a ``kind`` holds ``parameters`` of
that kind instead, see `refcloud.declared.kinds`.
"""

from __future__ import annotations

import dataclasses
import difflib
import inspect
import tomllib
import typing
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Literal

from refcloud.camera import Camera
from refcloud.checking import check
from refcloud.cloudmap import generate
from refcloud.declared.declaration import (
    FORMAT,
    VERSION,
    Cloud,
    Declaration,
    Placement,
)
from refcloud.declared.kinds import Changed, find_kind
from refcloud.lighting import Look, named
from refcloud.metaballs import approximate
from refcloud.optics import Medium, Sun
from refcloud.paths import refuse_path
from refcloud.refusal import complaint, describe, within
from refcloud.sky import Sky

MOST_BYTES = 1_000_000  # of a file; those of the scenes here have about 2000
MOST_CLOUDS = 1000
# Parameters that a file cannot hold, or that stand in a table of their own.
NOT_TYPED = ("observe", "grid", "width", "height")
LookName = Literal["cumulus", "man"]
Scattering = Literal["single", "multiple"]


def load_scene(path: str | Path) -> Declaration | Changed:
    """Read a scene's declaration, every number against the library's own range.

    Parameters
    ----------
    path
        A TOML file.

    Returns
    -------
    The declaration.

    Raises
    ------
    FileNotFoundError
        No such file.
    ValueError, TypeError
        It is no TOML, of another kind or version, or something in it does not fit; the
        line names the file, the table and the key.
    """
    refuse_path("path", path)
    path = Path(path)
    if not path.exists():
        raise FileNotFoundError(f"{path}: expected a scene (.toml), got no such file")
    if not path.is_file():
        kind = "a folder" if path.is_dir() else "a device"
        raise ValueError(complaint(f"{path}", "a scene (.toml)", kind))
    size = path.stat().st_size
    if size > MOST_BYTES:
        expected = f"a scene (.toml) of at most {MOST_BYTES} bytes"
        raise ValueError(complaint(f"{path}", expected, f"{size}"))
    table = _parsed(path)
    with within(f"{path}: "):
        return _declared(table)


def _parsed(path: Path) -> dict[str, Any]:
    """Read a file's tables; editors of Windows put a mark of UTF-8 in front."""
    try:
        return tomllib.loads(path.read_text("utf-8-sig"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        what = " ".join(str(error).split())[:80]
    except ValueError:  # Python's own, of decimal digits
        what = "a whole number of thousands of digits"
    except RecursionError:
        what = "brackets within brackets, too deep to be read"
    raise ValueError(complaint(f"{path}", "a TOML file", what))


def _declared(table: dict[str, Any]) -> Declaration | Changed:
    form = table.pop("format", None), table.pop("version", None)
    if form != (FORMAT, VERSION):
        expected = f'format = "{FORMAT}", version = {VERSION}'
        got = ", ".join(map(describe, form))
        raise ValueError(complaint("format", expected, got))
    if "kind" in table:
        return _changed(table)
    known = (
        *("name", "title", "scattering", "camera", "sun", "medium"),
        *("look", "sky", "cloud"),
    )
    _refuse_unknown("", table, known)
    clouds = _tables("cloud", table.get("cloud", []))
    if not 1 <= len(clouds) <= MOST_CLOUDS:
        expected = f"1 to {MOST_CLOUDS} tables [[cloud]]"
        raise ValueError(complaint("cloud", expected, f"{len(clouds)}"))
    medium, sky = table.get("medium"), table.get("sky", {})
    camera = table.get("camera")
    if camera is not None:
        camera = checked_table("camera", camera, Camera)
        _made("camera", Camera, camera)
    return Declaration(
        check("name", table.get("name", "scene"), str),
        check("title", table.get("title", ""), str),
        tuple(_cloud(f"cloud[{k}]", each) for k, each in enumerate(clouds)),
        camera,
        tuple(
            _made(f"sun[{k}]", Sun, each)
            for k, each in enumerate(_tables("sun", table.get("sun", [])))
        ),
        None if medium is None else _made("medium", Medium, medium),
        _look("look", table.get("look", {})),
        _made("sky", Sky, sky),
        check("scattering", table.get("scattering", "single"), Scattering),
    )


def _changed(table: dict[str, Any]) -> Changed:
    """Read a scene of a kind: what the file leaves out, the kind's own scene has."""
    _refuse_unknown("", table, ("kind", "name", "title", "parameters"))
    kind = find_kind(check("kind", table["kind"], str))
    return Changed(
        check("name", table.get("name", kind.name), str),
        check("title", table.get("title", ""), str),
        kind.name,
        nested("parameters", table.get("parameters", {}), kind.own),
    )


def nested(name: str, table: Any, own: Any) -> Any:
    """Read a dataclass from a table; fields that are dataclasses have their own tables.

    Parameters
    ----------
    name
        What a refusal calls the table.
    table
        What the file holds.
    own
        An instance, which has what the table leaves out.

    Returns
    -------
    One of the same type.

    Raises
    ------
    ValueError, TypeError
        A key is unknown, or its value does not fit.
    """
    hints = typing.get_type_hints(type(own), include_extras=True)
    _refuse_unknown(f"{name}.", _table(name, table), hints)
    given = {}
    for key, value in table.items():
        where, old = f"{name}.{key}", getattr(own, key)
        if dataclasses.is_dataclass(old):
            given[key] = nested(where, value, old)
        elif isinstance(old, tuple) and old and dataclasses.is_dataclass(old[0]):
            # Rows are whole: what they leave out, the type itself has by default.
            given[key] = tuple(
                _made(f"{where}[{k}]", type(old[0]), row)
                for k, row in enumerate(_tables(where, value))
            )
        else:
            given[key] = check(where, value, hints[key])
    with within(f"{name}."):
        made = dataclasses.replace(own, **given)
        if "eye" in hints and "target" in hints:
            Camera(made.eye, made.target)
        return made


def _made(
    name: str, thing: Callable[..., Any], table: Any, *, also: tuple[str, ...] = ()
) -> Any:
    """Make a dataclass of a table; what it refuses itself is named as in the file."""
    given = checked_table(name, table, thing, also=also)
    for key, parameter in inspect.signature(thing).parameters.items():
        if parameter.default is parameter.empty and key not in given:
            expected = "a value, since nothing stands for it"
            raise ValueError(complaint(f"{name}.{key}", expected, "none"))
    with within(f"{name}."):
        return thing(**given)


def _look(name: str, table: Any) -> Look:
    """Read a look: one by name, and what is changed of it."""
    rest = dict(_table(name, table))
    base = named(check(f"{name}.like", rest.pop("like", "cumulus"), LookName))
    given = checked_table(name, rest, Look)
    with within(f"{name}."):
        return dataclasses.replace(base, **given)


def _cloud(name: str, table: Any) -> Cloud:
    parts = ("shape", "balls", "look")
    place = {key: value for key, value in table.items() if key not in parts}
    balls = table.get("balls")
    return Cloud(
        checked_table(f"{name}.shape", table.get("shape", {}), generate),
        None if balls is None else checked_table(f"{name}.balls", balls, approximate),
        _made(name, Placement, place, also=parts),
        checked_table(f"{name}.look", table.get("look", {}), Look),
    )


def checked_table(
    name: str, table: Any, thing: Callable[..., Any], *, also: tuple[str, ...] = ()
) -> dict[str, Any]:
    """Check a table against the annotated parameters of a function or dataclass.

    Parameters
    ----------
    name
        What a refusal calls the table.
    table
        What the file holds.
    thing
        Whose parameters its keys are.
    also
        Further keys that a refusal may suggest.

    Returns
    -------
    The values, converted.

    Raises
    ------
    ValueError, TypeError
        A key is unknown, or its value does not fit.
    """
    table = _table(name, table)
    hints = typing.get_type_hints(thing, include_extras=True)
    names = [n for n in inspect.signature(thing).parameters if n not in NOT_TYPED]
    _refuse_unknown(f"{name}.", table, (*names, *also))
    return {
        key: check(f"{name}.{key}", value, hints[key]) for key, value in table.items()
    }


def _table(name: str, table: Any) -> dict[str, Any]:
    if not isinstance(table, dict):
        raise TypeError(complaint(name, f"a table [{name}]", describe(table)))
    return table


def _tables(name: str, tables: Any) -> list[dict[str, Any]]:
    if not isinstance(tables, list):
        raise TypeError(complaint(name, f"tables [[{name}]]", describe(tables)))
    return [_table(name, each) for each in tables]


def _refuse_unknown(where: str, table: Mapping[str, Any], known: Any) -> None:
    for key in table:
        if key not in known:
            near = difflib.get_close_matches(key, known, 1)
            advice = f"did you mean {near[0]}?" if near else ""
            expected = "one of " + ", ".join(known)
            got = repr(key[:60])
            raise ValueError(complaint(f"{where}{key}", expected, got, advice))
