"""Arrays that stay as they are: what frozen objects hold, and what observers see."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Iterator
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array, Observer

Kind = TypeVar("Kind", bound=NDArray[Any])


def sealed(array: Kind) -> Kind:
    """Make an array read-only that nothing else refers to: its holder need not copy it.

    Parameters
    ----------
    array
        Any shape; it is changed itself, and so is the memory it is a view of.

    Returns
    -------
    The same array.
    """
    for part in _down_to_owner(array):
        part.flags.writeable = False
    return array


def settled(given: Any, array: Array) -> Array:
    """Give a checked array that no later write changes, in the order of its axes.

    Order and ownership are settled where an object takes an array, not at every
    function's door: sums over an array depend in their last bits on its order in
    memory, so a cloud must not have any other; but functions inside take turned arrays
    on purpose, and a copy of each would only cost time.

    Parameters
    ----------
    given
        What the caller gave.
    array
        What `check` made of it: float64, read-only, perhaps the caller's own memory.

    Returns
    -------
    The same numbers, read-only and C-contiguous. Not copied where they are so already:
    a new array that `check` made, or one that came read-only down to its owner.
    """
    if not array.flags.c_contiguous:
        return sealed(np.array(array, order="C"))
    if isinstance(given, (list, tuple)):
        return array
    if isinstance(given, np.ndarray):
        if not np.may_share_memory(given, array):  # converted
            return array
        if given.flags.writeable:
            return sealed(array.copy())
    loose = any(part.flags.writeable for part in _down_to_owner(array))
    return sealed(array.copy()) if loose else array


def _down_to_owner(array: NDArray[Any]) -> Iterator[NDArray[Any]]:
    """Give an array, what it is a view of, and so on."""
    part: Any = array
    while isinstance(part, np.ndarray):
        yield part
        part = part.base


def shown(value: Any) -> Any:
    """Give what an observer may see: the same numbers, read-only.

    Parameters
    ----------
    value
        An array, a dataclass, a tuple, list or dictionary of these, or anything else.

    Returns
    -------
    Arrays as read-only views, and what holds them with these in place; whatever holds
    nothing that could be written into is given as it is.
    """
    if isinstance(value, np.ndarray):
        if not value.flags.writeable:
            return value
        view = value.view()
        view.flags.writeable = False
        return view
    if type(value) in (tuple, list):
        parts = [shown(part) for part in value]
        same = all(a is b for a, b in zip(parts, value, strict=True))
        return value if same and type(value) is tuple else type(value)(parts)
    if type(value) is dict:
        return {key: shown(part) for key, part in value.items()}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = [field.name for field in dataclasses.fields(value)]
        parts = {name: shown(getattr(value, name)) for name in fields}
        if all(parts[name] is getattr(value, name) for name in fields):
            return value
        twin = copy.copy(value)
        for name, part in parts.items():
            object.__setattr__(twin, name, part)
        return twin
    return value


class Onlooker:
    """An observer that can write into nothing it is shown."""

    def __init__(self, observe: Observer) -> None:
        self.observe = observe

    def __call__(self, name: str, value: Any) -> Any:
        """Show a value."""
        return self.observe(name, shown(value))


def only_looking(observe: Observer) -> Observer:
    """Wrap an observer, once, so that what it does to arrays changes no result."""
    return observe if isinstance(observe, Onlooker) else Onlooker(observe)
