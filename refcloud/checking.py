"""The one check of every argument, read from the annotations.

A refusal is one line: the argument, what was expected, what came, what to do. It names
shapes and never prints an array's contents.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
import math
import numbers
import operator
import os
import re
import types
import typing
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Literal, ParamSpec, TypeVar

import numpy as np

from refcloud.conventions import Array, MayBeNotFinite, Observer, Range, Shape
from refcloud.frozen import only_looking, settled
from refcloud.paths import refuse_path
from refcloud.refusal import (
    advice,
    all_of,
    complaint,
    describe,
    digits,
    kind_name,
    loading,
    meant,
    unit_of,
)
from refcloud.shapes import elementwise, refuse_unlike

P = ParamSpec("P")
Result = TypeVar("Result")
FEW = 16  # numbers of vectors, colours and matrices: a copy takes no time worth saving


def check(name: str, value: Any, hint: Any, sizes: dict[str, int] | None = None) -> Any:
    """Return a value as its annotation asks for it, or refuse it in one line.

    Parameters
    ----------
    name
        What the refusal calls the argument.
    value
        What came.
    hint
        The annotation: a type, ``Annotated`` with `Range` or `Shape`, ``Literal``,
        a union, a class, or a tuple of these.
    sizes
        Sizes of shape letters seen so far; filled in.

    Returns
    -------
    The value: numbers as int or float, arrays as read-only float64 views; an observer
    will be shown arrays that it cannot write into.

    Raises
    ------
    TypeError
        The value is of another kind.
    ValueError
        It is out of range, not finite, or of another shape.

    Examples
    --------
    >>> check("persistence", 1, Annotated[float, Range(0, 1)])
    1.0
    """
    sizes = {} if sizes is None else sizes
    origin = typing.get_origin(hint)
    if origin is Annotated:
        base, *marks = typing.get_args(hint)
        return _check_annotated(name, value, base, marks, sizes)
    if hint is Any or isinstance(hint, TypeVar):
        return value
    if origin is Literal:
        return _check_choice(name, value, typing.get_args(hint))
    if origin in (typing.Union, types.UnionType):
        return _check_union(name, value, typing.get_args(hint), sizes)
    if origin is tuple:
        return _check_tuple(name, value, typing.get_args(hint), sizes)
    if hint in (int, float):
        return _check_number(name, value, hint, None)
    if hint == Array:
        return _check_array(name, value, None, None, sizes, finite=True)
    kind = origin or hint
    if kind is Callable or hint is Callable:
        kind = Callable
    if hint is None or hint is type(None):
        kind = type(None)
    if isinstance(kind, type) and not isinstance(value, kind):
        raise TypeError(
            complaint(name, kind_name(kind), describe(value), loading(value))
        )
    return only_looking(value) if hint == Observer else value


def _check_annotated(
    name: str, value: Any, base: Any, marks: list[Any], sizes: dict[str, int]
) -> Any:
    limits = next((m for m in marks if isinstance(m, Range)), None)
    shape = next((m for m in marks if isinstance(m, Shape)), None)
    finite = not any(m is MayBeNotFinite for m in marks)
    if base in (int, float):
        return _check_number(name, value, base, limits)
    if shape is not None or base is Array:
        return _check_array(name, value, shape, limits, sizes, finite)
    return check(name, value, base, sizes)


def _check_number(name: str, value: Any, base: type, limits: Range | None) -> Any:
    whole = base is int
    expected = "a whole number" if whole else "a finite number"
    if limits is not None:
        expected += f" in {limits}" + unit_of(limits)
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value.item()
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Real):
        raise TypeError(complaint(name, expected, describe(value)))
    if whole and not isinstance(value, numbers.Integral):
        raise TypeError(complaint(name, expected, describe(value)))
    real: Any = value
    try:
        number = operator.index(real) if whole else float(real)
    except OverflowError:
        number = math.inf
    if not whole and not math.isfinite(number):
        raise ValueError(complaint(name, expected, f"{number}"))
    if limits is not None and not limits.holds(number):
        raise ValueError(
            complaint(name, expected, digits(number), advice(limits, number))
        )
    return number


def _check_array(
    name: str,
    value: Any,
    shape: Shape | None,
    limits: Range | None,
    sizes: dict[str, int],
    finite: bool,
) -> Array:
    expected = "an array" + (f" of shape {shape}" if shape else "")
    try:
        array = np.asarray(value)
    except ValueError:
        raise ValueError(complaint(name, expected, "rows of unequal length")) from None
    if array.dtype.kind not in "iuf" and not (array.size == 0 and array.ndim == 1):
        raise TypeError(complaint(name, expected + " of numbers", describe(value)))
    if shape is not None and not shape.fits(array.shape, sizes):
        known = {k: v for k, v in sizes.items() if k in shape.axes and k != "..."}
        where = ", ".join(f"{k} = {v}" for k, v in known.items())
        expected += f" ({where})" if where else ""
        raise ValueError(complaint(name, expected, f"shape {array.shape}"))
    with np.errstate(over="ignore", invalid="ignore"):
        array = array.astype(np.float64, copy=False).view()
    if finite and not np.isfinite(array).all():
        bad = int(array.size - np.isfinite(array).sum())
        raise ValueError(
            complaint(name, "finite numbers", f"{bad} NaN or infinite of {array.size}")
        )
    if limits is not None and array.size and not limits.holds(array):
        low, high = float(array.min()), float(array.max())
        raise ValueError(
            complaint(
                name,
                f"numbers in {limits}" + unit_of(limits),
                f"{low:g} to {high:g}",
                advice(limits),
            )
        )
    array.flags.writeable = False
    return array


def _check_choice(name: str, value: Any, choices: tuple[Any, ...]) -> Any:
    if not isinstance(value, (str, int, float, bool)) or value not in choices:
        expected = "one of " + ", ".join(repr(choice) for choice in choices)
        raise ValueError(complaint(name, expected, describe(value)))
    return value


def _check_union(
    name: str, value: Any, members: tuple[Any, ...], sizes: dict[str, int]
) -> Any:
    if value is None and type(None) in members:
        return None
    if isinstance(value, (str, os.PathLike)) and any(map(_is_path, members)):
        refuse_path(name, value)
    refusals: list[Exception] = []
    for member in members:
        if member is type(None):
            continue
        try:
            return check(name, value, member, sizes)
        except (TypeError, ValueError) as refusal:
            refusals.append(refusal)
    # An array of the right shape is refused for its numbers: no other kind was meant.
    numbers = [
        r for r in refusals if re.search(r": expected (finite )?numbers", str(r))
    ]
    if len(refusals) == 1 or numbers:
        raise (numbers or refusals)[0]
    raise all_of(name, refusals, value)


def _is_path(hint: Any) -> bool:
    kind = typing.get_origin(hint) or hint
    return kind in (Path, os.PathLike)


def _check_tuple(
    name: str, value: Any, members: tuple[Any, ...], sizes: dict[str, int]
) -> tuple[Any, ...]:
    if not isinstance(value, (tuple, list)):
        raise TypeError(complaint(name, "a tuple", describe(value)))
    if len(members) == 2 and members[1] is Ellipsis:
        members = (members[0],) * len(value)
    if len(members) != len(value):
        raise ValueError(
            complaint(name, f"{len(members)} values", f"{len(value)} values")
        )
    return tuple(
        check(f"{name}[{i}]", item, member, sizes)
        for i, (item, member) in enumerate(zip(value, members, strict=True))
    )


def checked(function: Callable[P, Result]) -> Callable[P, Result]:
    """Let a function refuse arguments that do not fit their annotations.

    Parameters
    ----------
    function
        A function whose parameters are annotated; it receives the converted values.

    Returns
    -------
    The function with the check in front, under the same name and signature.
    """
    signature = inspect.signature(function)
    hints: dict[str, Any] = {}
    own: dict[str, int] = {}

    @functools.wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> Result:
        if not hints:
            hints.update(typing.get_type_hints(function, include_extras=True))
            own.update(elementwise(hints))
        try:
            bound = signature.bind(*args, **kwargs)
        except TypeError as error:
            near = meant(kwargs, list(signature.parameters))
            raise TypeError(f"{function.__name__}: {error}{near}") from None
        sizes: dict[str, int] = {}
        for name, value in bound.arguments.items():
            kind = signature.parameters[name].kind
            if name in hints and kind is not inspect.Parameter.VAR_KEYWORD:
                bound.arguments[name] = check(name, value, hints[name], sizes)
        refuse_unlike(bound.arguments, own)
        return function(*bound.args, **bound.kwargs)

    return wrapper


def check_fields(instance: Any, *, own: bool = False) -> None:
    """Check and convert the fields of a frozen dataclass, in ``__post_init__``.

    Parameters
    ----------
    instance
        A frozen dataclass whose fields are annotated.
    own
        Whether its arrays are its own: no later write of the caller's shows. Those of
        a few numbers always are.

    Raises
    ------
    TypeError, ValueError
        As `check`.
    """
    hints = typing.get_type_hints(type(instance), include_extras=True)
    sizes: dict[str, int] = {}
    for field in dataclasses.fields(instance):
        given = getattr(instance, field.name)
        value = check(field.name, given, hints[field.name], sizes)
        if isinstance(value, np.ndarray) and (own or value.size <= FEW):
            value = settled(given, value)
        object.__setattr__(instance, field.name, value)
