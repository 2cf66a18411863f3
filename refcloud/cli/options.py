"""One function turns a signature into options: kinds, ranges, defaults, texts."""

from __future__ import annotations

import dataclasses
import inspect
import types
import typing
from collections.abc import Callable, Collection
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Any, Literal

import numpy as np

from refcloud.cli.docstrings import parameter_texts
from refcloud.conventions import Array, Range, Shape

MISSING = object()  # the library gives no default
EXACT = 1000  # a default that prints with digits to spare may be such a fraction


@dataclass(frozen=True)
class Option:
    """One parameter of the library, as the command line takes it.

    Attributes
    ----------
    name
        What the library calls the parameter.
    flag
        What the command line calls it.
    kinds
        Those alternatives of its annotation that can be typed.
    default
        The library's default, or MISSING.
    text
        What the docstring says about it.
    repeated
        Whether it may be given several times.
    """

    name: str
    flag: str
    kinds: tuple[Any, ...]
    default: Any
    text: str
    repeated: bool = False

    @property
    def is_switch(self) -> bool:
        """Tell whether it is given without a value."""
        return self.kinds == (bool,)

    @property
    def least_words(self) -> int:
        """Give how many words it takes at least."""
        return min(size_of(kind) for kind in self.kinds)

    @property
    def most_words(self) -> int:
        """Give how many words it takes at most."""
        return max(size_of(kind) for kind in self.kinds)

    @property
    def choices(self) -> tuple[str, ...]:
        """Give the names that it takes."""
        named = [kind for kind in self.kinds if base_of(kind) is Literal]
        return tuple(name for kind in named for name in typing.get_args(kind))

    @property
    def metavar(self) -> str:
        """Give what stands for the value in help."""
        return "|".join(_placeholder(kind, self.kinds) for kind in self.kinds)

    @property
    def help(self) -> str:
        """Give its text, default, range and unit."""
        facts = [f"default {default_text(self.default)}"]
        if self.choices:
            facts.append("one of " + ", ".join(self.choices))
        for kind in self.kinds:
            limits = mark(kind, Range)
            if limits is not None and range_text(limits) not in facts:
                facts.append(range_text(limits))
        if self.repeated:
            facts.append("may be repeated")
        return f"{self.text.rstrip('.')} ({', '.join(facts)})"


class FileOption(Option):
    """An option whose value is a file's name."""

    @property
    def metavar(self) -> str:
        """Give what stands for the value in help."""
        return "FILE"


def options_of(
    thing: Callable[..., Any], *, without: Collection[str] = ()
) -> tuple[Option, ...]:
    """Read the options of a function or dataclass from its annotations and docstring.

    Parameters that cannot be typed, such as clouds and observers, are left out.
    """
    hints = typing.get_type_hints(thing, include_extras=True)
    texts = parameter_texts(thing)
    return tuple(
        Option(name, "--" + name.replace("_", "-"), kinds, default, texts.get(name, ""))
        for name, default in _defaults(thing).items()
        if name not in without and name in hints and (kinds := typeable(hints[name]))
    )


def _defaults(thing: Callable[..., Any]) -> dict[str, Any]:
    """Give every parameter's default, made where a dataclass makes it."""
    if not dataclasses.is_dataclass(thing):
        return {
            name: MISSING if p.default is inspect.Parameter.empty else p.default
            for name, p in inspect.signature(thing).parameters.items()
        }
    found = {}
    for field in dataclasses.fields(thing):
        default = field.default
        if field.default_factory is not dataclasses.MISSING:
            default = field.default_factory()
        found[field.name] = MISSING if default is dataclasses.MISSING else default
    return found


def typeable(hint: Any) -> tuple[Any, ...]:
    """Give the alternatives of an annotation that can be typed as words."""
    origin = typing.get_origin(hint)
    if origin in (typing.Union, types.UnionType):
        return tuple(k for member in typing.get_args(hint) for k in typeable(member))
    if origin is Annotated and typing.get_args(hint)[0] is Array:
        shape = mark(hint, Shape)
        axes = shape.axes if shape else ()
        return (hint,) if len(axes) == 1 and isinstance(axes[0], int) else ()
    if origin is Annotated:
        base = typing.get_args(hint)[0]
        return (hint,) if base in (int, float) else typeable(base)
    return (hint,) if origin is Literal or hint in (bool, int, float) else ()


def mark(kind: Any, mark_type: type[Any]) -> Any:
    """Give the Range or Shape of an annotation, or None."""
    marks = typing.get_args(kind)[1:] if typing.get_origin(kind) is Annotated else ()
    return next((m for m in marks if isinstance(m, mark_type)), None)


def base_of(kind: Any) -> Any:
    """Give the type under an annotation: int, float, bool, Array or Literal."""
    origin = typing.get_origin(kind)
    if origin is Annotated:
        return typing.get_args(kind)[0]
    return Literal if origin is Literal else kind


def size_of(kind: Any) -> int:
    """Give how many words a kind of value takes."""
    shape = mark(kind, Shape)
    return 1 if shape is None else shape.axes[0]


def _placeholder(kind: Any, beside: tuple[Any, ...]) -> str:
    base = base_of(kind)
    if base is Literal:
        # Beside another kind the names themselves tell the kinds apart.
        return "NAME" if len(beside) == 1 else "|".join(typing.get_args(kind))
    if base is Array:
        limits = mark(kind, Range)
        if size_of(kind) == 2:
            return "FROM TO"
        colour = len(beside) > 1 or (limits and limits.unit.startswith("radiance"))
        return "R G B" if colour else "X Y Z"
    return base.__name__.upper()


def range_text(limits: Range) -> str:
    """Say a range and its unit."""
    return f"range {limits}" + ("" if limits.unit == "1" else f" {limits.unit}")


def default_text(default: Any) -> str:
    """Say a default; what is chosen case by case stands in the text before it.

    Examples
    --------
    >>> default_text(0.5), default_text(1 / 255), default_text(np.ones(3))
    ('0.5', '1/255', '1 1 1')
    """
    if default is MISSING or default is None:
        return "as described"
    if isinstance(default, bool):
        return "on" if default else "off"
    if isinstance(default, np.ndarray):
        return " ".join(default_text(float(value)) for value in default)
    if isinstance(default, float) and float(f"{default:g}") != default:
        fraction = Fraction(default).limit_denominator(EXACT)
        if float(fraction) == default:
            return str(fraction)
    return f"{default:g}" if isinstance(default, float) else str(default)
