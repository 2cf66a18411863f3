"""Arguments that go together element by element: their shapes have to broadcast."""

from __future__ import annotations

import typing
from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np

from refcloud.conventions import Array, Shape
from refcloud.refusal import complaint


def elementwise(hints: Mapping[str, Any]) -> dict[str, int]:
    """Find the parameters that are arrays of any shape, or of any leading axes.

    Parameters
    ----------
    hints
        Annotations by the parameters' names.

    Returns
    -------
    By name, how many axes an element has itself: 1 for ``Shape("...", 3)``; nothing
    where there are not two such parameters.
    """
    own: dict[str, int] = {}
    for name, hint in hints.items():
        marks: list[Any] = []
        if typing.get_origin(hint) is Annotated:
            hint, *marks = typing.get_args(hint)
        shape = next((mark for mark in marks if isinstance(mark, Shape)), None)
        axes = ("...",) if shape is None else shape.axes
        if name != "return" and hint == Array and axes[:1] == ("...",):
            own[name] = len(axes) - 1
    return own if len(own) > 1 else {}


def refuse_unlike(arguments: Mapping[str, Any], own: Mapping[str, int]) -> None:
    """Refuse two arguments whose leading axes do not broadcast, by both names.

    Parameters
    ----------
    arguments
        Checked values by name.
    own
        Of `elementwise`. Shapes that broadcast two by two do so all together.

    Raises
    ------
    ValueError
        Two do not.
    """
    shapes = {n: arguments[n].shape for n in own if n in arguments}
    leading = {name: s[: len(s) - own[name]] for name, s in shapes.items()}
    if len(set(leading.values())) < 2:
        return
    names = list(leading)
    for number, name in enumerate(names):
        for other in names[:number]:
            try:
                np.broadcast_shapes(leading[other], leading[name])
            except ValueError:
                expected = f"a shape that fits {other} of {shapes[other]}"
                got = f"shape {shapes[name]}"
                raise ValueError(complaint(name, expected, got)) from None
