"""Numbers without rounding, in which the plain twins run as references.

`Exact` is a fraction that stays one when a float joins in. `exact_numbers` lends the
plain modules a `math` of such numbers for a while: what is rational comes out exactly,
and roots, exponentials and the rest to 60 digits. So the definition that a student
reads is also what the map of stability measures against.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from decimal import Context, Decimal, localcontext
from fractions import Fraction
from types import ModuleType, SimpleNamespace
from typing import Any
from unittest import mock

DIGITS = 60
PRECISE = Context(prec=DIGITS, Emin=-(10**9), Emax=10**9)
# exp is 0 from here on: far below the least float64, 5e-324.
DEEPEST = 2000


class Exact(Fraction):
    """A fraction whose sums and products with floats are exact fractions too."""

    __slots__ = ()

    def _joined(self, other: Any, how: str) -> Any:
        if isinstance(other, float):
            if not math.isfinite(other):
                return getattr(float(self), how)(other)
            other = Fraction(other)
        found = getattr(Fraction, how)(self, other)
        return Exact(found) if isinstance(found, Fraction) else found

    def __add__(self, other: Any) -> Any:
        return self._joined(other, "__add__")

    def __radd__(self, other: Any) -> Any:
        return self._joined(other, "__radd__")

    def __sub__(self, other: Any) -> Any:
        return self._joined(other, "__sub__")

    def __rsub__(self, other: Any) -> Any:
        return self._joined(other, "__rsub__")

    def __mul__(self, other: Any) -> Any:
        return self._joined(other, "__mul__")

    def __rmul__(self, other: Any) -> Any:
        return self._joined(other, "__rmul__")

    def __truediv__(self, other: Any) -> Any:
        return self._joined(other, "__truediv__")

    def __rtruediv__(self, other: Any) -> Any:
        return self._joined(other, "__rtruediv__")

    def __mod__(self, other: Any) -> Any:
        return self._joined(other, "__mod__")

    def __neg__(self) -> Exact:
        return Exact(-Fraction(self))

    def __abs__(self) -> Exact:
        return Exact(abs(Fraction(self)))

    def __pow__(self, power: Any) -> Any:
        if isinstance(power, int):
            return Exact(Fraction(self) ** power)
        if Fraction(power) == Fraction(3, 2):
            return self * root(self)
        return exp(Exact(power) * log(self)) if self else Exact(0)


def decimal(x: Any) -> Decimal:
    """Give a number to 60 digits."""
    ratio = Fraction(x)
    return PRECISE.divide(Decimal(ratio.numerator), Decimal(ratio.denominator))


def root(x: Any) -> Exact:
    """Give the square root to 60 digits."""
    return Exact(PRECISE.sqrt(decimal(x)))


def exp(x: Any) -> Exact:
    """Give e to a power to 60 digits; 0 far below the least float."""
    if x < -DEEPEST:
        return Exact(0)
    return Exact(PRECISE.exp(decimal(x)))


def expm1(x: Any) -> Exact:
    """Give exp(x) - 1, by its series where the difference would cancel."""
    if abs(x) > Fraction(1, 1000):
        return exp(x) - 1
    z = decimal(x)
    return Exact(_series(z, lambda k: z / (k + 1), 24))


def _series(first: Decimal, ratio: Callable[[int], Decimal], terms: int) -> Decimal:
    """Add terms to 60 digits, each made of the one before."""
    with localcontext(PRECISE):
        total = term = first
        for k in range(1, terms):
            term *= ratio(k)
            total += term
    return total


def log(x: Any) -> Exact:
    """Give the natural logarithm to 60 digits."""
    return Exact(PRECISE.ln(decimal(x)))


def pi() -> Fraction:
    """Give pi to 60 digits, by Machin's two arcs."""
    return 4 * (4 * _arctan(5) - _arctan(239))


def _arctan(n: int) -> Fraction:
    terms = (Fraction((-1) ** k, (2 * k + 1) * n ** (2 * k + 1)) for k in range(45))
    return sum(terms, Fraction(0))


PI = Exact(decimal(pi()))


def cos(x: Any) -> Exact:
    """Give the cosine of an angle of a few turns at most, by its series."""
    square = decimal(Exact(x) ** 2)
    return Exact(_series(Decimal(1), lambda k: -square / (2 * k * (2 * k - 1)), 60))


def tan(x: Any) -> Exact:
    """Give the tangent of an angle below half a turn."""
    c = cos(x)
    return root(1 - c * c) / c


def erf(x: Any) -> Exact:
    """Give the error function of a number up to 3, by its series."""
    z = decimal(x)
    square = decimal(Exact(x) ** 2)
    total = _series(z, lambda k: -square * (2 * k - 1) / (k * (2 * k + 1)), 150)
    return Exact(2) * Exact(total) / root(PI)


def fmod(x: Any, y: Any) -> Exact:
    """Give the remainder with the sign of x."""
    x, y = Fraction(x), abs(Fraction(y))
    return Exact(x - y * math.trunc(x / y))


def hypot(*sides: Any) -> Exact:
    """Give the length of a vector."""
    return root(sum((Exact(s) ** 2 for s in sides), Exact(0)))


def dist(a: Sequence[Any], b: Sequence[Any]) -> Exact:
    """Give the distance of two points."""
    return hypot(*(Exact(p) - Exact(q) for p, q in zip(a, b, strict=True)))


def copysign(size: Any, sign: Any) -> Exact:
    """Give a size the sign of another number."""
    return Exact(abs(Fraction(size)) * (-1 if sign < 0 else 1))


MATH = SimpleNamespace(
    inf=math.inf,
    nan=math.nan,
    pi=PI,
    ceil=math.ceil,
    floor=math.floor,
    isfinite=lambda x: isinstance(x, Fraction) or math.isfinite(x),
    prod=math.prod,
    sqrt=root,
    exp=exp,
    expm1=expm1,
    cos=cos,
    tan=tan,
    erf=erf,
    fmod=fmod,
    hypot=hypot,
    dist=dist,
    copysign=copysign,
)


@contextmanager
def exact_numbers(*modules: ModuleType) -> Iterator[None]:
    """Lend plain modules a `math` of exact numbers while the block runs."""
    with ExitStack() as stack:
        for module in modules:
            stack.enter_context(mock.patch.object(module, "math", MATH))
        yield


def exact(values: Any) -> Any:
    """Turn a float, or nested sequences of floats, into exact numbers."""
    if isinstance(values, (list, tuple)):
        return [exact(value) for value in values]
    return Exact(float(values))
