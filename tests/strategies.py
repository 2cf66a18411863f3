"""Hypothesis strategies made from the same annotations that `checked` reads.

``values_for(hint)`` draws what fits an annotation, ``arguments_for(function)`` what
fits a whole call: a shape letter stands for one size in it. Numbers without an end are
drawn up to a physical size, since overflow is no law of clouds.
"""

from __future__ import annotations

import inspect
import math
import types
import typing
from collections.abc import Callable
from typing import Annotated, Any, Literal

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from refcloud.conventions import Array, Range, Shape

FARTHEST = 1e3  # where a range has no end
LONGEST_AXIS = 4
MOST_LEADING_AXES = 2
EVERYTHING = Range()


def values_for(
    hint: Any, sizes: dict[str, int] | None = None
) -> st.SearchStrategy[Any]:
    """Draw values that fit an annotation; sizes of shape letters are filled in."""
    sizes = {} if sizes is None else sizes
    origin = typing.get_origin(hint)
    if origin is Annotated:
        base, *marks = typing.get_args(hint)
        limits = next((m for m in marks if isinstance(m, Range)), EVERYTHING)
        shape = next((m for m in marks if isinstance(m, Shape)), None)
        if base in (int, float):
            return numbers_in(limits, whole=base is int)
        if base is Array:
            return _arrays(shape or Shape("..."), limits, sizes)
        return values_for(base, sizes)
    if origin is Literal:
        return st.sampled_from(typing.get_args(hint))
    if origin in (typing.Union, types.UnionType):
        return st.one_of(values_for(part, sizes) for part in typing.get_args(hint))
    if origin is tuple:
        members = typing.get_args(hint)
        if len(members) == 2 and members[1] is Ellipsis:
            return st.lists(values_for(members[0], sizes), max_size=3).map(tuple)
        return st.tuples(*(values_for(member, sizes) for member in members))
    if hint in (int, float):
        return numbers_in(EVERYTHING, whole=hint is int)
    if hint is Array:
        return _arrays(Shape("..."), EVERYTHING, sizes)
    if hint is bool:
        return st.booleans()
    if hint is str:
        return st.text(max_size=8)
    if hint in (None, type(None)):
        return st.none()
    raise TypeError(f"no strategy for {hint!r}: give one by hand")


def numbers_in(limits: Range, *, whole: bool = False) -> st.SearchStrategy[Any]:
    """Draw numbers of a range, its ends among them where they belong to it."""
    lower, upper = _ends(limits)
    if whole:
        first, last = math.ceil(lower), math.floor(upper)
        first += limits.open_lower and first == limits.lower
        last -= limits.open_upper and last == limits.upper
        return st.integers(first, last)
    return st.floats(
        lower,
        upper,
        exclude_min=limits.open_lower and lower == limits.lower,
        exclude_max=limits.open_upper and upper == limits.upper,
        allow_subnormal=False,
    )


def _ends(limits: Range) -> tuple[float, float]:
    """Replace a missing end by one that lies FARTHEST beyond the other, or beyond 0."""
    lower, upper = limits.lower, limits.upper
    if lower == -math.inf:
        lower = min(-FARTHEST, upper - FARTHEST)
    if upper == math.inf:
        upper = max(FARTHEST, lower + FARTHEST)
    return lower, upper


@st.composite
def _arrays(
    draw: st.DrawFn, shape: Shape, limits: Range, sizes: dict[str, int]
) -> np.ndarray:
    size = st.integers(1, LONGEST_AXIS)
    drawn: list[int] = []
    for axis in shape.axes:
        if axis == "...":
            drawn += draw(st.lists(size, max_size=MOST_LEADING_AXES))
        elif isinstance(axis, int):
            drawn.append(axis)
        else:
            if axis not in sizes:
                sizes[axis] = draw(size, label=f"size of {axis}")
            drawn.append(sizes[axis])
    return draw(arrays(np.float64, tuple(drawn), elements=numbers_in(limits)))


@st.composite
def arguments_for(
    draw: st.DrawFn, function: Callable[..., Any], **given: st.SearchStrategy[Any]
) -> dict[str, Any]:
    """Draw keyword arguments for a checked function; a default is drawn at times.

    Strategies given by name stand for parameters that annotations cannot describe.
    """
    hints = typing.get_type_hints(function, include_extras=True)
    sizes: dict[str, int] = {}
    drawn = {}
    for name, parameter in inspect.signature(function).parameters.items():
        optional = parameter.default is not inspect.Parameter.empty
        if name not in given and optional and draw(st.booleans(), label=f"omit {name}"):
            continue
        by_hand = name in given
        strategy = given[name] if by_hand else values_for(hints[name], sizes)
        drawn[name] = draw(strategy, label=name)
    return drawn
