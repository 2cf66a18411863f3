"""A picture's recipe: calls of the library, which are run, kept, and written as Python.

One description serves all three, so that the Python text that the page hands out is
what the page itself ran. A stage is kept under its own text: what is written alike is
the same, and is not computed again.
"""

from __future__ import annotations

import dataclasses
import inspect
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from refcloud.conventions import Observer

WIDTH = 88  # of a line of text
MOST_KEPT = 512 << 20  # bytes of all results that are kept
INDENT = "    "
CODES = 255


@dataclass(frozen=True)
class Name:
    """The result of an earlier stage."""

    name: str


@dataclass(frozen=True, eq=False)
class Call:
    """A call of the library.

    Attributes
    ----------
    text
        What Python calls the function.
    function
        The function.
    arguments, keywords
        Values, names of earlier stages, or calls.
    run
        What runs in the function's place, with the same result; None for itself.
    """

    text: str
    function: Callable[..., Any]
    arguments: tuple[Any, ...] = ()
    keywords: Mapping[str, Any] = field(default_factory=dict)
    run: Callable[..., Any] | None = None

    def but(self, **changes: Any) -> Call:
        """Give the same call with other keywords."""
        return dataclasses.replace(self, keywords={**self.keywords, **changes})


@dataclass(frozen=True, eq=False)
class Stage:
    """A named step; `coarse` takes its place in a hurry, unless its result is kept."""

    name: str
    call: Call
    coarse: Call | None = None


@dataclass(frozen=True, eq=False)
class Recipe:
    """Stages in order; the last makes the picture, which is saved as told."""

    stages: tuple[Stage, ...]
    saving: Mapping[str, Any]

    def python(self, file: str) -> str:
        """Write the recipe as Python, ending with the picture's file."""
        lines = ["import refcloud as rc", *self._imports(), ""]
        lines += [f"{s.name} = {written(s.call, len(s.name) + 3)}" for s in self.stages]
        save = Call(f"{self.stages[-1].name}.save", print, (file,), self.saving)
        return "\n".join([*lines, written(save)]) + "\n"

    def _imports(self) -> list[str]:
        """Import what the public door does not name."""
        calls = [stage.call for stage in self.stages]
        return [
            f"from {call.function.__module__} import {call.text}"
            for call in calls
            if "." not in call.text
        ]


def written(value: Any, column: int = 0, indent: str = "") -> str:
    """Write a value or a call as Python, in lines of at most 88 signs where they fit.

    Parameters
    ----------
    value
        A value, a name or a call.
    column
        How many signs stand before it on its line.
    indent
        The indent of that line.

    Returns
    -------
    The text.

    Examples
    --------
    >>> written(Call("rc.generate", print, (), {"seed": 7, "cell": np.ones(3)}))
    'rc.generate(seed=7, cell=[1.0, 1.0, 1.0])'
    """
    line = _on_one_line(value)
    if len(indent) + column + len(line) <= WIDTH or not isinstance(
        value, (Call, tuple)
    ):
        return line
    inner = indent + INDENT
    if isinstance(value, tuple):
        parts = [written(v, 1, inner) for v in value]
        left, right = "(", ")"
    else:
        parts = [written(v, 1, inner) for v in value.arguments]
        parts += [
            f"{name}={written(v, len(name) + 2, inner)}"
            for name, v in value.keywords.items()
        ]
        left, right = f"{value.text}(", ")"
    return "\n".join([left, *(f"{inner}{part}," for part in parts), indent + right])


def _on_one_line(value: Any) -> str:
    if isinstance(value, Name):
        return value.name
    if isinstance(value, Call):
        parts = [_on_one_line(v) for v in value.arguments]
        parts += [f"{name}={_on_one_line(v)}" for name, v in value.keywords.items()]
        return f"{value.text}({', '.join(parts)})"
    if isinstance(value, tuple):
        inner = ", ".join(_on_one_line(v) for v in value)
        return f"({inner},)" if len(value) == 1 else f"({inner})"
    if isinstance(value, np.ndarray):
        return f"[{', '.join(_on_one_line(float(v)) for v in value)}]"
    if isinstance(value, float) and 0.0 < value < 1.0:
        codes = round(value * CODES)
        # Tolerances are counted in steps of an 8-bit picture.
        if codes and codes / CODES == value and len(repr(value)) > len("1 / 255"):
            return f"{codes} / {CODES}"
    return repr(value)


class Kept:
    """Results of stages by their whole text; the least recently used go first."""

    def __init__(self, most: int = MOST_KEPT) -> None:
        self.most = most
        self.results: OrderedDict[str, tuple[Any, int]] = OrderedDict()

    def find(self, key: str) -> Any:
        """Give a kept result, or None."""
        if key not in self.results:
            return None
        self.results.move_to_end(key)
        return self.results[key][0]

    def keep(self, key: str, result: Any) -> None:
        """Keep a result, and let go of old ones where all are too large."""
        self.results[key] = result, bytes_of(result)
        while sum(size for _, size in self.results.values()) > self.most:
            self.results.popitem(last=False)


def bytes_of(value: Any) -> int:
    """Count the bytes of the arrays in a result."""
    if isinstance(value, np.ndarray):
        return value.nbytes
    if dataclasses.is_dataclass(value):
        return sum(bytes_of(getattr(value, f.name)) for f in dataclasses.fields(value))
    if isinstance(value, (tuple, list)):
        return sum(map(bytes_of, value))
    return sum(map(bytes_of, value.values())) if isinstance(value, dict) else 0


def cooked(
    recipe: Recipe,
    kept: Kept,
    *,
    coarse: bool = False,
    observe: Observer | None = None,
    until: str = "",
) -> dict[str, Any]:
    """Run a recipe.

    Parameters
    ----------
    recipe
        The stages.
    kept
        Results of earlier runs, and of this one.
    coarse
        Whether stages may be replaced by their coarse forms.
    observe
        Called with each intermediate of the last stage, which then runs again.
    until
        The last stage that is wanted; all without it, or where none is called so.

    Returns
    -------
    The result of every stage by its name.
    """
    results: dict[str, Any] = {}
    texts: dict[str, str] = {}
    for stage in recipe.stages:
        call, last = stage.call, stage is recipe.stages[-1]
        key = _whole(call, texts)
        found = None if last else kept.find(key)
        if coarse and stage.coarse is not None and found is None:
            call = stage.coarse
            key = _whole(call, texts)
            found = None if last else kept.find(key)
        watched = observe is not None and (last or stage.name == until)
        if found is None or watched:
            found = _called(call, results, observe if watched else None)
            if not last:
                kept.keep(key, found)
        results[stage.name], texts[stage.name] = found, key
        if stage.name == until:
            break
    return results


def evaluated(value: Any, results: Mapping[str, Any]) -> Any:
    """Run a call, or a part of one.

    Parameters
    ----------
    value
        A call, a name, a tuple of these, or a value.
    results
        What the names stand for.

    Returns
    -------
    What it gives.
    """
    return _called(value, results, None)


def _whole(call: Call, texts: Mapping[str, str]) -> str:
    """Write a call with the texts of earlier stages in the place of their names."""
    whole = dataclasses.replace(
        call,
        arguments=tuple(_named(v, texts) for v in call.arguments),
        keywords={k: _named(v, texts) for k, v in call.keywords.items()},
    )
    return _on_one_line(whole)


def _named(value: Any, texts: Mapping[str, str]) -> Any:
    return Name(texts[value.name]) if isinstance(value, Name) else value


def _called(value: Any, results: Mapping[str, Any], observe: Observer | None) -> Any:
    if isinstance(value, Name):
        return results[value.name]
    if isinstance(value, tuple):
        return tuple(_called(v, results, observe) for v in value)
    if not isinstance(value, Call):
        return value
    arguments = [_called(v, results, observe) for v in value.arguments]
    keywords = {k: _called(v, results, observe) for k, v in value.keywords.items()}
    function = value.run or value.function
    if observe is not None and "observe" in inspect.signature(function).parameters:
        keywords["observe"] = observe
    return function(*arguments, **keywords)
