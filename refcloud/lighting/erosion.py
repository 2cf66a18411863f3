"""Eroded footprints: noise, anchored in the world, that eats into a ball's edge.

An extension of the paper: a smooth footprint shows as cotton; where the noise is low
the footprint is cut back, most where it is thin. Erosion only takes: the weight never
grows, so that no light is made.
"""

from __future__ import annotations

import dataclasses
from typing import Annotated, Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Array, Positive, Range, Seed, Shape
from refcloud.frozen import sealed
from refcloud.noise import octave_sum_grid

Numbers = TypeVar("Numbers", bound=NDArray[np.floating[Any]])

OCTAVES = 4
PERSISTENCE = 0.6
NEARLY_ALL = 0.64  # 99 % of 4 million samples of |eq 1| with these octaves lie below
SAMPLES = 2.0  # per cell of the finest octave: its bumps must show, not only exist
LEAST_SPACING = 1e-90  # counts of cells stay finite numbers, whatever the radii
MOST_CELLS = 8_000_000  # 64 MB of float64; a wider cloud gets a coarser table
SOFT = 0.3  # width over which the cut-back footprint rises


@checked
def detail_grid(
    lower: Annotated[Array, Shape(3)],
    upper: Annotated[Array, Shape(3)],
    *,
    cell: Annotated[float, Positive],
    pixel: Annotated[float, Range(0.0, unit="scene units")] = 0.0,
    seed: Seed = 0,
) -> VoxelGrid:
    """Tabulate the noise that erodes footprints, over a box of the world.

    Formula: min(|sum of 4 octaves| / 0.64, 1) at cell centres on whole multiples of the
    spacing, so that two boxes agree where they overlap

    Parameters
    ----------
    lower, upper
        Corners of the box, shape (3,), scene units.
    cell
        Coarsest cell of the noise, scene units, above 0.
    pixel
        What one pixel covers of the nearest place, scene units: the table is no finer
        than that, and octaves with cells below it are left out; 0 keeps all.
    seed
        Chooses the noise.

    Returns
    -------
    The table, values in [0, 1]; octaves left out because the box is wide stand in its
    `skipped`.

    Source: an extension of paper M, eq 12.
    """
    table = lattice_of(lower, upper, cell=cell, pixel=pixel)
    noise, skipped = octave_sum_grid(
        *table.axes,
        seed=seed,
        octaves=OCTAVES,
        persistence=PERSISTENCE,
        normalize="none",
        finest=table.spacing / cell,
    )
    rows = tuple(
        dataclasses.replace(row, stage="erosion", bound=row.bound / NEARLY_ALL)
        for row in skipped
    )
    return VoxelGrid(
        sealed(np.minimum(noise / NEARLY_ALL, 1.0)),
        table.lower,
        table.upper,
        rows,
    )


class Lattice(NamedTuple):
    """Where a table's values sit.

    Attributes
    ----------
    spacing
        Between them, scene units.
    lower, upper
        Corners of the table's box.
    axes
        x, y and z of the values, in cells of the coarsest octave.
    """

    spacing: float
    lower: Array
    upper: Array
    axes: tuple[Array, Array, Array]


def lattice_of(lower: Array, upper: Array, *, cell: float, pixel: float) -> Lattice:
    """Lay a table over a box of the world, as `detail_grid` does."""
    spacing = max(cell / 2 ** (OCTAVES - 1) / SAMPLES, LEAST_SPACING)
    while spacing < pixel:
        spacing *= 2.0
    while np.prod(np.ceil((upper - lower) / spacing) + 3.0) > MOST_CELLS:
        spacing *= 2.0
    # From the centre below each corner to the one above: no place in the box is
    # clamped when the table is sampled.
    first = np.floor(lower / spacing - 0.5)
    count = (np.floor(upper / spacing + 0.5) - first + 1.0).astype(int)
    x, y, z = (
        (a + np.arange(n) + 0.5) * (spacing / cell)
        for a, n in zip(first, count, strict=True)
    )
    return Lattice(spacing, first * spacing, (first + count) * spacing, (x, y, z))


@checked
def eroded(
    weight: Annotated[Array, Range(0.0, 1.0)],
    noise: Annotated[Array, Range(0.0, 1.0)],
    *,
    erosion: Annotated[float, Range(0.0, 1.0, open_upper=True)],
) -> Array:
    """Cut a footprint back where the noise is low.

    Formula: lo = e (1 - n), w' = (1 + 0.3) max(w - lo, 0) / (1 + 0.3 - lo) <= w

    Parameters
    ----------
    weight
        Footprint, any shape, in [0, 1].
    noise
        Of `detail_grid`, the same shape, in [0, 1].
    erosion
        e, in [0, 1); 0 leaves the footprint as it is.

    Returns
    -------
    The weight, the same shape, in [0, weight].

    Source: an extension of paper M, eq 12.

    Examples
    --------
    >>> eroded([0.2, 1.0], [0.0, 1.0], erosion=0.5)
    array([0., 1.])
    """
    return eroded_of(weight, noise, erosion)


def eroded_of(weight: Array, noise: Array, erosion: float) -> Array:
    """Cut a footprint back without a check: the inner form of `eroded`.

    Parameters
    ----------
    weight, noise, erosion
        As `eroded`.

    Returns
    -------
    As `eroded`, a new array.
    """
    low = erosion * (1.0 - noise)
    kept = np.maximum(weight - low, 0.0)
    kept *= 1.0 + SOFT
    kept /= (1.0 + SOFT) - low
    return kept


@checked
def lit_share(
    noise: Annotated[Array, Range(0.0, 1.0)],
    ahead: Annotated[Array, Range(0.0, 1.0)],
    *,
    relief: Annotated[float, Range(0.0, 1.0)],
) -> Array:
    """Give the share of a sun's light that the detail lets reach a place.

    Formula: 1 - relief (1 + n_ahead - n) / 2, in [1 - relief, 1]

    Parameters
    ----------
    noise, ahead
        Of `detail_grid`, at the place and a step toward the sun, one shape, in [0, 1].
    relief
        Largest share kept back, in [0, 1].

    Returns
    -------
    The same shape; it only takes light.

    Source: an extension of paper M, eq 29.

    Examples
    --------
    >>> lit_share([0.0, 1.0], [1.0, 0.0], relief=0.5)
    array([0.5, 1. ])
    """
    return lit_share_of(noise, ahead, relief)


def lit_share_of(noise: Numbers, ahead: Numbers, relief: float) -> Numbers:
    """Give the share without a check: the inner form of `lit_share`.

    Parameters
    ----------
    noise, ahead, relief
        As `lit_share`.

    Returns
    -------
    As `lit_share`, a new array.
    """
    share: Any = ahead - noise
    share += 1.0
    share *= -0.5 * relief
    share += 1.0
    return share
