"""Controls of the page, read from the library's annotations; and values from them."""

from __future__ import annotations

import dataclasses
import math
import typing
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, Union

import numpy as np

from refcloud.checking import check
from refcloud.conventions import Array, Range
from refcloud.parameters import MISSING, Option, base_of, mark, options_of, size_of
from refcloud.refusal import complaint

# Where a slider ends when the annotation has no near end: so many times the start.
REACH = 4.0
FAR = 50.0  # times the start: an end farther away than this is not near
DECADES = 100.0  # from this ratio of its ends on a slider is logarithmic
SEEDS = 99  # a slider's last seed; others are typed
PLAIN = Range()


@dataclass(frozen=True)
class Group:
    """Parameters of one function or dataclass, as a block of the page.

    Attributes
    ----------
    key, title
        What files call the block, and its heading.
    options
        The parameters.
    start
        Values that the studio starts with where they are not the library's defaults.
    near
        Values that a control begins with where the library's own choice is left.
    about
        A sentence under the heading.
    may_be_off
        Whether the block can be left to the scene.
    on
        Whether it counts at the start.
    """

    key: str
    title: str
    options: tuple[Option, ...]
    start: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    near: Mapping[str, Any] = dataclasses.field(default_factory=dict)
    about: str = ""
    may_be_off: bool = False
    on: bool = True

    def started(self) -> dict[str, Any]:
        """Give the starting value of every parameter."""
        found = {o.name: self.start.get(o.name, o.default) for o in self.options}
        return {k: None if v is MISSING else v for k, v in found.items()}


def group_of(
    key: str,
    title: str,
    source: Callable[..., Any],
    *,
    without: tuple[str, ...] = (),
    alone: tuple[str, ...] = (),
    **how: Any,
) -> Group:
    """Read a block from a function's or dataclass's annotations.

    Parameters
    ----------
    key, title
        As `Group`.
    source
        The function or dataclass.
    without
        Parameters that are left out.
    alone
        The only parameters that are taken; none for all.
    how
        Further fields of the block.

    Returns
    -------
    The block.
    """
    options = options_of(source, without=without)
    if alone:
        options = tuple(option for option in options if option.name in alone)
    return Group(key, title, options, **how)


def described(group: Group) -> dict[str, Any]:
    """Describe a block to the page."""
    start = group.started()
    return {
        "key": group.key,
        "title": group.title,
        "about": group.about,
        "mayBeOff": group.may_be_off,
        "on": group.on,
        "knobs": [
            _knob(option, start[option.name], group.near.get(option.name))
            for option in group.options
        ],
    }


def _knob(option: Option, start: Any, near: Any) -> dict[str, Any]:
    """Describe one parameter: its text, its start, and the ways to give it."""
    begin = near if start is None else start
    ways = [_way(kind, begin, len(option.kinds) > 1) for kind in option.kinds]
    if option.default is None or start is None:
        ways.insert(0, {"kind": "auto", "label": "chosen by itself"})
    return {
        "name": option.name,
        "label": option.name.replace("_", " "),
        "text": option.text,
        "start": plain(start),
        "begin": plain(begin),
        "ways": ways,
    }


def _way(kind: Any, start: Any, beside: bool) -> dict[str, Any]:
    """Describe one kind of value; beside a number, three are one for each colour."""
    base = base_of(kind)
    if base is bool:
        return {"kind": "switch", "label": "on or off"}
    if base is Literal:
        return {"kind": "choice", "label": "by name", "choices": typing.get_args(kind)}
    limits = mark(kind, Range) or PLAIN
    near = np.abs(np.asarray(start, float)).max() if _is_number(start) else 1.0
    low, high = slider_ends(limits, float(near), whole=base is int)
    colour = limits.unit.startswith("radiance")
    colour = colour or (beside and limits.unit != "scene units")
    names = {int: "whole", float: "number"}
    labels = {"whole": "a number", "number": "a number", "colour": "red, green, blue"}
    shown = names.get(base, "colour" if colour else "vector")
    return {
        "kind": shown,
        "label": labels.get(shown, "number by number"),
        "size": size_of(kind),
        "range": str(limits),
        "unit": "" if limits.unit == "1" else limits.unit,
        "from": low,
        "to": high,
        "log": low > 0.0 and high / low >= DECADES,
    }


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float, np.ndarray)) and not isinstance(value, bool)


def slider_ends(limits: Range, near: float, *, whole: bool) -> tuple[float, float]:
    """Choose where a slider begins and ends; every number of the range can be typed.

    Parameters
    ----------
    limits
        The range of the annotation.
    near
        Size of the value that it starts at.
    whole
        Whether whole numbers alone are meant.

    Returns
    -------
    The two ends, in the range.

    Examples
    --------
    >>> slider_ends(Range(0, 1), 0.5, whole=False)
    (0.0, 1.0)
    >>> slider_ends(Range(0), 6.0, whole=False)
    (0.0, 24.0)
    """
    size = near or 1.0
    low, high = float(limits.lower), float(limits.upper)
    if whole and low < -FAR * max(size, SEEDS) and high > SEEDS:
        return 0.0, float(SEEDS)
    # 1. Bring far ends near; a range that lies far out itself keeps its nearer end.
    if high > FAR * size:
        nearer = (10.0 if whole else REACH) * size
        if nearer > low or high == math.inf:
            high = nearer if nearer > low else low + size
    if low < -FAR * size:
        nearer = -high if high > 0.0 else high - REACH * size
        low = max(low, nearer)
    # 2. Stay clear of ends that do not belong to the range, and of zero on a scale of
    #    even ratios.
    span = high - low
    if limits.open_lower and low == limits.lower:
        low += 0.001 * span
    if limits.open_upper and high == limits.upper:
        high -= 0.001 * span
    if 0.0 < low < size / FAR < high:
        low = size / FAR
    if whole:
        low, high = math.ceil(low), math.floor(high)
    return float(low), float(high)


def plain(value: Any) -> Any:
    """Give a value as JSON and TOML know it; what is chosen by itself is None."""
    if isinstance(value, np.ndarray):
        return [float(v) for v in value]
    if isinstance(value, np.generic):
        return value.item()
    return value


def taken(group: Group, given: Any) -> dict[str, Any] | None:
    """Check what came for a block, and complete it; None where it is switched off.

    Parameters
    ----------
    group
        The block.
    given
        Values by name, or None for "off".

    Returns
    -------
    Every parameter's value, as the library takes it.

    Raises
    ------
    ValueError, TypeError
        A name is unknown, or a value does not fit its annotation: one line.
    """
    if given is None:
        if group.may_be_off:
            return None
        raise ValueError(complaint(group.key, "values by name", "none"))
    if not isinstance(given, dict):
        raise TypeError(complaint(group.key, "values by name", type(given).__name__))
    options = {option.name: option for option in group.options}
    for name in given:
        if name not in options:
            expected = "one of " + ", ".join(options)
            raise ValueError(complaint(group.key, expected, repr(str(name)[:60])))
    values, start = group.started(), group.started()
    for name, value in given.items():
        open_ = options[name].default is None or start[name] is None
        where = f"{group.key}.{name}"
        values[name] = _checked(where, options[name], value, may_be_none=open_)
    return values


def _checked(where: str, option: Option, value: Any, *, may_be_none: bool) -> Any:
    kinds: tuple[Any, ...] = option.kinds
    if may_be_none:
        kinds = (*kinds, None)
    if isinstance(value, list) and not any(base_of(k) is Array for k in option.kinds):
        raise TypeError(complaint(where, "one value", f"{len(value)} values"))
    # Of kinds that are known only here, `|` would need a loop.
    return check(where, value, Union[kinds])  # noqa: UP007
