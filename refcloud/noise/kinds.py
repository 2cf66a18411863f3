"""The kinds of noise that octaves can be summed of: one plain table.

Each kind has a function for points in rows and one that gives a grid. Both give values
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
from refcloud.noise.gradient_grid import gradient_grid
from refcloud.noise.scattered import PERIOD, Dtype, Numbers
from refcloud.noise.simplex import WRAP, _simplex
from refcloud.noise.simplex_grid import simplex_grid
from refcloud.noise.value import How as ValueHow
from refcloud.noise.value import _value
from refcloud.noise.value_grid import value_grid

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
    grid
        Gives noise on a grid: (lines, seed, period, dtype).
    """

    dimensions: tuple[int, ...]
    tiles: bool
    wrap: float
    points: Callable[[Array, int, int | None, Dtype], Numbers]
    grid: Callable[[Lines, int, int | None, Dtype], Numbers]


def _value_points(
    columns: Array, seed: int, period: int | None, dtype: Dtype
) -> Numbers:
    return _value(columns, ValueHow(seed, "quintic", True, period, dtype))


def _value_grid(lines: Lines, seed: int, period: int | None, dtype: Dtype) -> Numbers:
    x, y, z = lines
    how = {"seed": seed, "period": period, "dtype": dtype}
    return value_grid(x, y, z, interpolant="quintic", **how)


def _gradient_points(
    columns: Array, seed: int, period: int | None, dtype: Dtype
) -> Numbers:
    name = USUAL[len(columns)]
    how = GradientHow(seed, "quintic", name, period, "mixed", dtype)
    return _gradient(columns, how)


def _gradient_grid(
    lines: Lines, seed: int, period: int | None, dtype: Dtype
) -> Numbers:
    return gradient_grid(*lines, seed=seed, period=period, dtype=dtype)


def _simplex_points(
    columns: Array, seed: int, period: int | None, dtype: Dtype
) -> Numbers:
    del period  # refused before
    return _simplex(columns, seed, "continuous", "mixed", dtype)


def _simplex_grid(lines: Lines, seed: int, period: int | None, dtype: Dtype) -> Numbers:
    del period  # refused before
    return simplex_grid(*lines, seed=seed, dtype=dtype)


KINDS: dict[KindName, Kind] = {
    "value": Kind((3,), True, PERIOD, _value_points, _value_grid),
    "gradient": Kind((2, 3), True, PERIOD, _gradient_points, _gradient_grid),
    "simplex": Kind((2, 3, 4), False, float(WRAP), _simplex_points, _simplex_grid),
}


def _octave_columns(columns: Array, octave: int, shift: Array, wrap: float) -> Array:
    """Give coordinates in cells of an octave; reducing first keeps them exact."""
    placed = np.fmod(np.fmod(columns, wrap) * 2.0**octave, wrap)
    placed += np.reshape(shift, (-1, 1))
    return np.fmod(placed, wrap)
