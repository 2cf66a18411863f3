"""Words of the command line to values: numbers, vectors, names, all checked."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from refcloud.checking import check
from refcloud.cli.options import Option, base_of, size_of
from refcloud.conventions import Array
from refcloud.refusal import complaint


def number(word: str) -> float | None:
    """Read a number or a fraction such as 1/255; None for anything else.

    Examples
    --------
    >>> number("-1e-3"), number("1/4"), number("cumulus")
    (-0.001, 0.25, None)
    """
    above, slash, below = word.partition("/")
    try:
        return float(above) / float(below) if slash else float(word)
    except (ValueError, ArithmeticError):
        return None


def value_of(option: Option, text: str) -> Any:
    """Turn what was typed for an option into the value that the library takes.

    Raises
    ------
    ValueError, TypeError
        It does not fit the annotation; the line names the option.
    """
    words = text.split()
    for kind in option.kinds:
        if base_of(kind) is not Literal and size_of(kind) == len(words):
            value = _numbers(words, kind)
            if value is not None:
                return check(option.flag, value, kind)
    if len(option.kinds) == 1:
        kind = option.kinds[0]
        if base_of(kind) is not Array:
            return check(option.flag, text, kind)  # a name, or refused with its range
    if text in option.choices:
        return text
    expected = " or ".join(dict.fromkeys(_wanted(kind) for kind in option.kinds))
    raise ValueError(complaint(option.flag, expected, repr(text[:60])))


def _wanted(kind: Any) -> str:
    """Say in words what a kind of value is typed as."""
    if base_of(kind) is Literal:
        return " or ".join(kind.__args__)
    if base_of(kind) is not Array:
        return "a number"
    return "two numbers" if size_of(kind) == 2 else "three numbers"


def _numbers(words: list[str], kind: Any) -> Any:
    """Read one number or a vector; None where a word is no such number."""
    if base_of(kind) is int:
        try:
            return int(words[0])
        except ValueError:
            return None
    values = [number(word) for word in words]
    if None in values:
        return None
    return np.array(values, dtype=np.float64) if base_of(kind) is Array else values[0]
