"""What the docstrings of the library say, as plain text for ``--help``."""

from __future__ import annotations

import inspect
import re
from typing import Any

SECTIONS = ("Parameters", "Attributes")
INDENT = "    "


def summary(thing: Any) -> str:
    """Give the first sentence of a docstring."""
    return (inspect.getdoc(thing) or "").split("\n")[0]


def parameter_texts(thing: Any) -> dict[str, str]:
    """Give what a docstring says about each parameter or attribute."""
    texts: dict[str, str] = {}
    names: list[str] = []
    for line in _lines(inspect.getdoc(thing) or ""):
        if line.startswith(INDENT):
            for name in names:
                texts[name] = f"{texts.get(name, '')} {line.strip()}".strip()
        elif line:
            names = [name.strip() for name in line.split(",")]
    return {name: for_command_line(text) for name, text in texts.items()}


def _lines(text: str) -> list[str]:
    """Cut out the section that describes parameters, without its title."""
    lines = text.split("\n")
    for start, line in enumerate(lines[:-1]):
        if line in SECTIONS and set(lines[start + 1]) == {"-"}:
            end = start + 2
            while end < len(lines) and not set(lines[end]) == {"-"}:
                end += 1
            # The line before the next dashes is the next section's title.
            return lines[start + 2 : end - 1 if end < len(lines) else end]
    return []


def for_command_line(text: str) -> str:
    """Leave out what concerns Python alone.

    Examples
    --------
    >>> for_command_line("A cloud; None (Python only) takes the hash.")
    'A cloud.'
    >>> for_command_line("The place, shape (3,), scene units. None for 0.")
    'The place, scene units. No value for 0.'
    """
    text = text.replace("`", "").replace(", shape (3,)", "")
    text = re.sub(r"; None \(Python only\)[^.;]*", "", text)
    text = re.sub(r"(^|\. )None\b", r"\1No value", text)
    return re.sub(r"\bNone\b", "no value", text)
