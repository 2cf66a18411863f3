"""What a cell of the map of stability says, and how it is found.

Formula: error = max |found - exact| / max(|exact|, scale), over the cell's numbers.

* green: the error is at most 1e-10 in float64, 1e-4 in float32.
* amber: larger, and at most 1e-2: digits are lost, the picture is not.
* red: larger, NaN, an overflow, any exception but a refusal.
* refused: the door refuses the parameters with one clear line.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal

import numpy as np

from refcloud.conventions import Array

Colour = Literal["green", "amber", "red", "refused"]
LIMITS = {"float64": 1e-10, "float32": 1e-4}
WRONG = 1e-2


@dataclass(frozen=True)
class Found:
    """What a probe gives for one cell.

    Attributes
    ----------
    values
        The numbers of the function under test.
    exact
        What they should be, as fractions or floats.
    scale
        Least size that an error counts against; 0 for purely relative.
    """

    values: Sequence[float] | Array
    exact: Sequence[Any]
    scale: float = 0.0


@dataclass(frozen=True)
class Cell:
    """The verdict on one cell, its error where there is one, and why."""

    colour: Colour
    error: float | None
    why: str = ""


def judge(measure: Callable[[], Found], dtype: str) -> Cell:
    """Run one cell and say what came of it.

    Parameters
    ----------
    measure
        Runs the function under test and its reference.
    dtype
        Whose limit holds.

    Returns
    -------
    The cell.
    """
    try:
        with np.errstate(all="raise", under="ignore"), warnings.catch_warnings():
            warnings.simplefilter("error")
            found = measure()
    except (ValueError, TypeError) as refusal:
        lines = str(refusal).splitlines()
        clear = len(lines) == 1 and ": expected" in lines[0]
        return Cell("refused" if clear else "red", None, str(refusal))
    except Exception as failure:
        return Cell("red", None, f"{type(failure).__name__}: {failure}")
    error = relative_error(found)
    if not error <= WRONG:
        return Cell("red", error, "a wrong result" if error == error else "NaN")
    return Cell("green" if error <= LIMITS[dtype] else "amber", error)


def relative_error(found: Found) -> float:
    """Give the largest error of a cell's numbers, NaN where one is.

    Parameters
    ----------
    found
        The numbers and what they should be.

    Returns
    -------
    The error, at least 0; infinity where a number is infinite and should not be.
    """
    worst = 0.0
    for value, exact in zip(found.values, found.exact, strict=True):
        value = float(value)
        if math.isnan(value):
            return math.nan
        if math.isinf(value):
            worst = math.inf if value != exact else worst
            continue
        off = abs(Fraction(value) - Fraction(exact))
        # One step of the least floats is no error: nothing between can be written.
        size = max(abs(Fraction(exact)), Fraction(found.scale), TINY)
        worst = max(worst, float(min(off / size, Fraction(10) ** 300)))
    return worst


TINY = Fraction(float(np.finfo(np.float64).tiny))
