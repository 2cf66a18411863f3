"""Sunlight inside voxels: what each takes out of the beam, and all of them together."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.conventions import Array, Range, Shape, Vector, unit_vector
from refcloud.transport.sweep import mean_transmittance, step_of


@checked
def cell_mean(
    tau: Annotated[Array, Range(0.0)], own: Annotated[Array, Range(0.0)]
) -> Array:
    """Average sunlight over a voxel, from the depth at its centre.

    Formula: T sinh(x) / x with T = exp(-tau) and x = own / 2, so that own times the
    mean is what the beam loses in the voxel

    Parameters
    ----------
    tau
        Optical depth from the sun to the centre.
    own
        Optical depth of the whole path through the voxel; tau holds half of it.

    Returns
    -------
    The mean transmittance, in [0, 1], of the broadcast shape.

    Source: an extension of paper M (multiple scattering, X09).

    Examples
    --------
    >>> float(cell_mean([1.0], [2.0])[0]) == float(-np.expm1(-2.0) / 2.0)
    True
    """
    # e^-tau sinh(x)/x = e^-(tau - x) (1 - e^-2x) / 2x: no factor can overflow.
    return np.exp(-np.maximum(tau - 0.5 * own, 0.0)) * mean_transmittance(own)


@checked
def intercepted(
    grid: VoxelGrid,
    direction: Vector,
    *,
    scale: Annotated[Array, Shape("N"), Range(0.0, unit="1 / scene unit")],
) -> Array:
    """Measure how much of a parallel beam a cloud takes out.

    Formula: the integral of 1 - exp(-tau) over a plane across the beam, tau = scale
    times the column of density; one ray per voxel of the slices that it crosses

    Parameters
    ----------
    grid
        The cloud map.
    direction
        Toward the sun, shape (3,), any length but 0.
    scale
        Extinctions at density 1, shape (N,): each is answered.

    Returns
    -------
    Areas, shape (N,), scene units squared.

    Source: an extension of paper M (multiple scattering, X09).

    Examples
    --------
    >>> grid = VoxelGrid(np.ones((3, 4, 5)), [0, 0, 0], [5, 4, 3])
    >>> intercepted(grid, [0.0, 0, 1], scale=[1.0]).round(6)
    array([19.004259])
    """
    columns, area = columns_across(grid, direction)
    return np.array([-np.expm1(-s * columns).sum() * area for s in scale])


def columns_across(grid: VoxelGrid, direction: Array) -> tuple[Array, float]:
    """Give the columns of density along rays of a beam, and the area of each ray."""
    cell = cell_size(grid)
    step = step_of(-unit_vector(direction), cell)
    slices = np.moveaxis(grid.density, step.axis, 0)[:: step.sense]
    K, h, w = slices.shape
    # Rays stand still in a frame that slides by `side` voxels from slice to slice; in
    # the middle of the grid they go through centres.
    middle = 0.5 * (K - 1)
    room = [int(np.ceil(abs(side) * middle)) for side in step.side]
    columns = np.zeros([n + 2 * r + 1 for n, r in zip((h, w), room, strict=True)])
    for k, density in enumerate(slices):
        at = [r - (k - middle) * s for s, r in zip(step.side, room, strict=True)]
        j, i = (int(a) for a in at)
        v, u = at[0] - j, at[1] - i
        near, far = (1.0 - v) * density, v * density
        for down, rows in ((j, near), (j + 1, far)):
            columns[down : down + h, i : i + w] += (1.0 - u) * rows
            columns[down : down + h, i + 1 : i + 1 + w] += u * rows
    # A voxel's volume over its path is the area that its ray stands for.
    return columns[columns > 0.0] * step.length, float(cell.prod()) / step.length
