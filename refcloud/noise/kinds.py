"""The kinds of noise that octaves can be summed of: one plain table.

Each kind has a function for points in rows and one that fills a grid. Both give values
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
from refcloud.noise.gradient import _by_corners, _gradient
from refcloud.noise.gradient_grid import Layer, _fill
from refcloud.noise.scattered import CHUNK, PERIOD, Dtype, Numbers
from refcloud.noise.simplex import WRAP, _simplex
from refcloud.noise.simplex_grid import simplex_grid
from refcloud.noise.value import _value
from refcloud.noise.value_grid import _add_grid
from refcloud.noise.value_table import How as ValueHow

KindName = Literal["value", "gradient", "simplex"]


@dataclass(frozen=True)
class Octave:
    """One octave on a grid: its weight, coordinates in its cells, seed and period."""

    scale: float
    lines: list[Array]
    seed: int
    period: int | None


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
    fill
        Fills an array with the sum of octaves on a grid, one at the least, or of their
        absolute values: (array, octaves, absolute).
    """

    dimensions: tuple[int, ...]
    tiles: bool
    wrap: float
    points: Callable[[Array, int, int | None, Dtype], Numbers]
    fill: Callable[[Numbers, list[Octave], bool], None]


def _value_points(
    columns: Array, seed: int, period: int | None, dtype: Dtype
) -> Numbers:
    return _value(columns, ValueHow(seed, "quintic", True, period, dtype))


def _fill_value(out: Numbers, octaves: list[Octave], absolute: bool) -> None:
    out[...] = 0.0
    for octave in octaves:
        x, y, z = octave.lines
        how = ValueHow(octave.seed, "quintic", True, octave.period, _dtype(out))
        _add_grid(out, octave.scale, (x, y, z), how, absolute)


def _gradient_points(
    columns: Array, seed: int, period: int | None, dtype: Dtype
) -> Numbers:
    name = USUAL[len(columns)]
    how = GradientHow(seed, "quintic", name, period, "mixed", dtype)
    return _by_corners(columns, how) if len(columns) == 4 else _gradient(columns, how)


def _fill_gradient(out: Numbers, octaves: list[Octave], absolute: bool) -> None:
    if len(octaves[0].lines) == 4:
        _fill_four(out, octaves, absolute)
        return
    layers = []
    for octave in octaves:
        name, period = USUAL[len(octave.lines)], octave.period
        how = GradientHow(octave.seed, "quintic", name, period, "mixed", _dtype(out))
        layers.append(Layer(tuple(octave.lines), how, octave.scale))
    _fill(out, layers, absolute)


def _fill_four(out: Numbers, octaves: list[Octave], absolute: bool) -> None:
    """Sum octaves of four dimensions point by point: they have no grid form."""
    out[...] = 0.0
    for octave in octaves:
        mesh = np.meshgrid(*octave.lines[::-1], indexing="ij")
        columns = np.stack([axis.ravel() for axis in mesh[::-1]])
        for first in range(0, columns.shape[1], CHUNK):
            part = columns[:, first : first + CHUNK]
            values = _gradient_points(part, octave.seed, octave.period, _dtype(out))
            flat = out.reshape(-1)[first : first + CHUNK]
            flat += octave.scale * (np.abs(values) if absolute else values)


def _simplex_points(
    columns: Array, seed: int, period: int | None, dtype: Dtype
) -> Numbers:
    del period  # refused before
    return _simplex(columns, seed, "continuous", "mixed", dtype)


def _fill_simplex(out: Numbers, octaves: list[Octave], absolute: bool) -> None:
    out[...] = 0.0
    for octave in octaves:  # a period is refused before
        values = simplex_grid(*octave.lines, seed=octave.seed, dtype=_dtype(out))
        if absolute:
            np.abs(values, out=values)
        values *= octave.scale
        out += values


def _dtype(out: Numbers) -> Dtype:
    return "float32" if out.dtype == np.float32 else "float64"


KINDS: dict[KindName, Kind] = {
    "value": Kind((3,), True, PERIOD, _value_points, _fill_value),
    "gradient": Kind((2, 3, 4), True, PERIOD, _gradient_points, _fill_gradient),
    "simplex": Kind((2, 3, 4), False, float(WRAP), _simplex_points, _fill_simplex),
}


def _octave_columns(columns: Array, octave: int, shift: Array, wrap: float) -> Array:
    """Give coordinates in cells of an octave; reducing first keeps them exact."""
    placed = np.fmod(np.fmod(columns, wrap) * 2.0**octave, wrap)
    placed += np.reshape(shift, (-1, 1))
    return np.fmod(placed, wrap)
