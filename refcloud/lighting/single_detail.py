"""The noise that erodes footprints, in single precision, where balls look it up.

`detail_grid` fills a box of the world. A ball shows the front half of itself, flattened
by half, and looks once more a step toward each sun: the cubes of the table that none of
these boxes meets are not made.
"""

from __future__ import annotations

import dataclasses
import itertools
from dataclasses import dataclass

import numpy as np

from refcloud.conventions import Array, Skipped
from refcloud.lighting.erosion import (
    NEARLY_ALL,
    OCTAVES,
    PERSISTENCE,
    lattice_of,
)
from refcloud.metaballs import Metaballs
from refcloud.noise import octave_sum_grid
from refcloud.noise.octave_products import EDGE, Cubes, octave_sum_products
from refcloud.raster.quadratics import Floats

ROUNDED = 1e-6  # cells: more than what rounding moves a place by


@dataclass(frozen=True, eq=False)
class SingleDetail:
    """A table of noise.

    Attributes
    ----------
    values
        At the centres of cells, float32, shape (D, H, W) as ``[z, y, x]``, in [0, 1];
        0 where no ball looks.
    lower
        Corner of its box, scene units, shape (3,).
    spacing
        Edge of a cell.
    skipped
        Octaves left out.
    """

    values: Floats
    lower: Array
    spacing: float
    skipped: tuple[Skipped, ...]


def single_detail(
    lower: Array,
    upper: Array,
    balls: Metaballs,
    frame: Array,
    toward: Array,
    *,
    front: float,
    cell: float,
    pixel: float,
    seed: int,
) -> SingleDetail:
    """Tabulate the noise where balls look it up, unchecked.

    Parameters
    ----------
    lower, upper, cell, pixel, seed
        As `detail_grid`, whose values these are, rounded.
    balls
        Those in the picture.
    frame
        The camera's right, up and back, shape (3, 3).
    toward
        Steps toward the suns, scene units, shape (S, 3).
    front
        Where a pixel looks, between a ball's middle plane, 0, and its front, 1.
    """
    table = lattice_of(lower, upper, cell=cell, pixel=pixel)
    how = {"seed": seed, "octaves": OCTAVES, "persistence": PERSISTENCE}
    # Which octaves are left out does not depend on the place.
    one = (axis[:1] for axis in table.axes)
    finest = table.spacing / cell
    _, rows = octave_sum_grid(*one, normalize="none", finest=finest, **how)
    rows = tuple(
        dataclasses.replace(row, stage="erosion", bound=row.bound / NEARLY_ALL)
        for row in rows
    )
    how["octaves"] -= sum(row.skipped for row in rows)
    # A place is center + R (q cos right + q sin up + front sqrt(1 - q^2) back): along
    # an axis it goes as far as an ellipse does, backward as far as a disc.
    right, up, back = frame
    disc = np.square(right) + np.square(up)
    ends = [
        np.sqrt(disc + np.square(front * np.maximum(sign * back, 0.0)))
        for sign in (-1.0, 1.0)
    ]
    size = tuple(len(axis) for axis in table.axes)
    wanted = np.zeros([-(-n // EDGE) for n in size[::-1]], bool)
    for step in (np.zeros(3), *toward):
        middle = (balls.centers + step - table.lower) / table.spacing - 0.5
        reach = balls.radii[:, None] / table.spacing
        _mark(wanted, middle - ends[0] * reach, middle + ends[1] * reach, size)
    values = octave_sum_products(table.axes, wanted, per=NEARLY_ALL, **how)
    return SingleDetail(values, table.lower, table.spacing, rows)


def _mark(wanted: Cubes, low: Array, high: Array, size: tuple[int, ...]) -> None:
    """Mark the cubes that hold cells between two places, and the cells after them."""
    last = np.array(size) - 1
    first = np.clip(np.floor(low - ROUNDED), 0, last).astype(np.intp) // EDGE
    stop = np.clip(np.floor(high + ROUNDED) + 1.0, 0, last).astype(np.intp) // EDGE + 1
    # A box counts 1 from its corner on, and what lies past it takes that back.
    count = np.zeros([n + 1 for n in wanted.shape], np.int64)
    for corner in itertools.product((0, 1), repeat=3):
        x, y, z = (
            (stop if past else first)[:, axis] for axis, past in enumerate(corner)
        )
        np.add.at(count, (z, y, x), (-1) ** sum(corner))
    for axis in range(3):
        np.cumsum(count, axis=axis, out=count)
    wanted |= count[:-1, :-1, :-1] > 0
