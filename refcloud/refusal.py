"""How a refusal is worded: the argument, what was expected, what came, what to do."""

from __future__ import annotations

import difflib
import math
import os
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from refcloud.conventions import Range


def complaint(name: str, expected: str, got: str, advice: str = "") -> str:
    """Word a refusal: the argument, what was expected, what came, what to do."""
    return f"{name}: expected {expected}, got {got}" + (f"; {advice}" if advice else "")


def counted(count: int, thing: str) -> str:
    """Write how many there are of a thing that takes an s.

    Examples
    --------
    >>> counted(1, "ball"), counted(0, "occupied voxel")
    ('1 ball', '0 occupied voxels')
    """
    return f"{count} {thing}" + ("" if count == 1 else "s")


def refuse_beside(what: str, **given: object) -> None:
    """Refuse arguments that are given beside something that brings its own."""
    for name, value in given.items():
        if value is not None:
            raise ValueError(complaint(name, f"none beside {what}", "one"))


@contextmanager
def within(where: str, **names: str) -> Iterator[None]:
    """Put the place before what is refused inside, such as a file or a table in it.

    Parameters
    ----------
    where
        What stands before the argument's name.
    names
        What arguments are called at that place, by their own names.
    """
    try:
        yield
    except (ValueError, TypeError) as refusal:
        text = str(refusal)
        for name, other in names.items():
            text = re.sub(rf"\b{name}\b", other, text)
        kind = TypeError if isinstance(refusal, TypeError) else ValueError
        raise kind(f"{where}{text}") from None


def digits(number: float) -> str:
    """Write a number in all its digits, as long as a line holds them."""
    if isinstance(number, int):
        # Python refuses to write whole numbers of thousands of digits.
        return (
            str(number) if number.bit_length() < 200 else "a number of over 60 digits"
        )
    short = f"{number:g}"
    # One that is only just out of its range must not look as if it were within.
    return short if float(short) == number else repr(float(number))


def unit_of(limits: Range) -> str:
    """Name a range's unit behind it, if it has one."""
    return "" if limits.unit == "1" else f" ({limits.unit})"


def advice(limits: Range, number: float = 0.0) -> str:
    """Say what to do; a number may have been meant in degrees."""
    angle = math.radians(min(abs(number), 1e9))
    if limits.unit == "radians" and limits.holds(angle):
        return f"in radians, {digits(abs(number))} degrees are {angle:.4g}"
    return f"choose within {limits}"


def kind_name(kind: Any) -> str:
    """Name a kind of value."""
    name = getattr(kind, "__name__", str(kind))
    return {"str": "a text", "bool": "True or False", "Callable": "a function"}.get(
        name, f"a {name}"
    )


def all_of(name: str, refusals: list[Exception], value: Any) -> Exception:
    """Join refusals of one value, of which any kind would have done, to one.

    It names all that would have done, and is a ValueError where one kind was right.
    """
    expected = [str(r).split(": expected ", 1)[1].split(", got ")[0] for r in refusals]
    right = [r for r in refusals if isinstance(r, ValueError)]
    got = str((right or refusals)[0]).split(", got ", 1)[1].split("; ")[0]
    text = complaint(name, " or ".join(dict.fromkeys(expected)), got, loading(value))
    return ValueError(text) if right else TypeError(text)


def meant(given: Iterable[str], known: list[str]) -> str:
    """Name the parameter that an unknown one is spelled like."""
    unknown = [name for name in given if name not in known]
    near = difflib.get_close_matches(unknown[0], known, 1) if unknown else []
    return f"; did you mean {near[0]}?" if near else ""


def installing(extra: str) -> str:
    """Say how an extra of pyproject.toml is installed, as the README does."""
    return f'pip install ".[{extra}]" in refcloud\'s folder'


def loading(value: Any) -> str:
    """Say what to do with a file's name that came in the place of what it holds."""
    if not isinstance(value, os.PathLike):
        return ""
    functions = "load_voxels, load_metaballs, load_levels or load_picture"
    scene = "refcloud.declared.scene_from(load_scene(path)) for a .toml"
    return f"load the file first: {functions}, {scene}"


def describe(value: Any) -> str:
    """Say what came: a kind and a shape, never an array's contents."""
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype} with shape {value.shape}"
    if isinstance(value, int) and not isinstance(value, bool):
        return digits(value)
    if isinstance(value, (str, float, bool)) or value is None:
        text = repr(value)
        return text if len(text) <= 60 else text[:57] + "..."
    return f"a {type(value).__name__}"
