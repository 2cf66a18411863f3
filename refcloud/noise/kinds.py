"""The kinds of noise that octaves can be summed of: one plain table.

Each kind has a function for points in rows and one that adds a grid. Both give values
in [-1, 1], so that every sum of octaves has the same bound.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from refcloud.conventions import Array
from refcloud.noise.directions import USUAL
from refcloud.noise.gradient import How as GradientHow
from refcloud.noise.gradient import _gradient
from refcloud.noise.gradient_grid import _fill
from refcloud.noise.scattered import PERIOD, Dtype, Numbers
from refcloud.noise.simplex import WRAP, _simplex
from refcloud.noise.simplex_grid import simplex_grid
from refcloud.noise.value import _value
from refcloud.noise.value_grid import _add_grid
from refcloud.noise.value_table import How as ValueHow

KindName = Literal["value", "gradient", "simplex"]
Lines = list[Array]  # the coordinates along each axis of a grid


@dataclass(frozen=True)
class Kind:
    """A kind of noise.

    Attributes
    ----------
    dimensions
        How many coordinates a place may have.
    tiles
        Whether it can repeat after a period.
    wrap
        What coordinates are taken modulo.
    points
        Gives noise at finite points (N, n): (columns, seed, period, dtype).
    add
        Adds scaled noise on a grid, or its absolute value, to an array:
        (array, scale, lines, seed, period, absolute).
    """

    dimensions: tuple[int, ...]
    tiles: bool
    wrap: float
    points: Callable[[Array, int, int | None, Dtype], Numbers]
    add: Callable[[Numbers, float, Lines, int, int | None, bool], None]


def _value_points(
    columns: Array, seed: int, period: int | None, dtype: Dtype
) -> Numbers:
    return _value(columns, ValueHow(seed, "quintic", True, period, dtype))


def _add_value(
    out: Numbers,
    scale: float,
    lines: Lines,
    seed: int,
    period: int | None,
    absolute: bool,
) -> None:
    x, y, z = lines
    how = ValueHow(seed, "quintic", True, period, _dtype(out))
    _add_grid(out, scale, (x, y, z), how, absolute)


def _gradient_points(
    columns: Array, seed: int, period: int | None, dtype: Dtype
) -> Numbers:
    name = USUAL[len(columns)]
    how = GradientHow(seed, "quintic", name, period, "mixed", dtype)
    return _gradient(columns, how)


def _add_gradient(
    out: Numbers,
    scale: float,
    lines: Lines,
    seed: int,
    period: int | None,
    absolute: bool,
) -> None:
    def add(part: Numbers, values: Numbers) -> None:
        part += np.abs(values, out=values) if absolute else values

    name = USUAL[len(lines)]
    how = GradientHow(seed, "quintic", name, period, "mixed", _dtype(out))
    _fill(out, tuple(lines), how, add, scale)


def _simplex_points(
    columns: Array, seed: int, period: int | None, dtype: Dtype
) -> Numbers:
    del period  # refused before
    return _simplex(columns, seed, "continuous", "mixed", dtype)


def _add_simplex(
    out: Numbers,
    scale: float,
    lines: Lines,
    seed: int,
    period: int | None,
    absolute: bool,
) -> None:
    del period  # refused before
    values = simplex_grid(*lines, seed=seed, dtype=_dtype(out))
    if absolute:
        np.abs(values, out=values)
    values *= scale
    out += values


def _dtype(out: Numbers) -> Dtype:
    return "float32" if out.dtype == np.float32 else "float64"


KINDS: dict[KindName, Kind] = {
    "value": Kind((3,), True, PERIOD, _value_points, _add_value),
    "gradient": Kind((2, 3), True, PERIOD, _gradient_points, _add_gradient),
    "simplex": Kind((2, 3, 4), False, float(WRAP), _simplex_points, _add_simplex),
}


def _octave_columns(columns: Array, octave: int, shift: Array, wrap: float) -> Array:
    """Give coordinates in cells of an octave; reducing first keeps them exact."""
    placed = np.fmod(np.fmod(columns, wrap) * 2.0**octave, wrap)
    placed += np.reshape(shift, (-1, 1))
    return np.fmod(placed, wrap)
