"""The cloud map: densities on a grid of cells that fills a box."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from refcloud.checking import check_fields, checked
from refcloud.conventions import Array, Range, Shape, Skipped, Vector

MOST_VOXELS = 1 << 28  # 2 GiB of float64: larger grids are refused before allocation
# Larger ones are not made: whoever makes one holds up to 32 bytes a cell at the worst
# moment, 1 GiB in all.
MOST_MADE = 1 << 25
STEP = 1 << 20  # cells of a grid that are made at a time


@dataclass(frozen=True, eq=False, repr=False)
class VoxelGrid:
    """A cloud as densities on a grid; the value sits at its cell's centre.

    It holds copies of arrays that could still be written into; one that is read-only
    it keeps. A grid equals itself alone: compare its arrays.

    Attributes
    ----------
    density
        Shape (D, H, W) as ``[z, y, x]``, at least 0.
    lower, upper
        Corners of the box that the grid fills, shape (3,) in x, y, z, scene units.
        Outside it the density is 0.
    skipped
        What the generator left out.
    """

    density: Annotated[Array, Shape("D", "H", "W"), Range(0.0)]
    lower: Vector
    upper: Vector
    skipped: tuple[Skipped, ...] = ()

    def __post_init__(self) -> None:
        check_fields(self, own=True)
        if min(self.density.shape) < 1:
            raise ValueError(
                "density: expected at least one cell along each axis,"
                f" got shape {self.density.shape}"
            )
        if not np.all(self.upper > self.lower):
            raise ValueError(
                "upper: expected above lower on every axis,"
                f" got {self.lower.tolist()} to {self.upper.tolist()}"
            )
        with np.errstate(over="ignore"):
            size = self.upper - self.lower
        if not np.all(np.isfinite(size)):
            raise ValueError("upper: expected a box of finite size, got one too large")

    def __repr__(self) -> str:
        """Say what it is without its numbers."""
        lower, upper = (
            " ".join(f"{v:.4g}" for v in c) for c in (self.lower, self.upper)
        )
        occupied = int(np.count_nonzero(self.density))
        return (
            f"VoxelGrid(shape {self.density.shape}, {occupied} occupied,"
            f" {lower} to {upper})"
        )


@checked
def cell_size(grid: VoxelGrid) -> Array:
    """Give the edges of one cell.

    Formula: (upper - lower) / (W, H, D)

    Parameters
    ----------
    grid
        The cloud map.

    Returns
    -------
    Shape (3,), in x, y, z, scene units.

    Source: paper M, section 3 (V04).

    Examples
    --------
    >>> cell_size(VoxelGrid(np.ones((1, 2, 4)), [0, 0, 0], [4, 4, 4]))
    array([1., 2., 4.])
    """
    return (grid.upper - grid.lower) / np.array(grid.density.shape[::-1])


@checked
def cell_centres(grid: VoxelGrid) -> tuple[Array, Array, Array]:
    """Give the coordinates of the cells' centres along each axis.

    Formula: lower + (i + 1/2) (upper - lower) / n

    Parameters
    ----------
    grid
        The cloud map.

    Returns
    -------
    x of shape (W,), y of shape (H,), z of shape (D,), scene units.

    Source: paper M, section 3 (V04).

    Examples
    --------
    >>> cell_centres(VoxelGrid(np.ones((1, 1, 2)), [0, 0, 0], [4, 1, 1]))[0]
    array([1., 3.])
    """
    size = cell_size(grid)
    x, y, z = (
        low + (np.arange(n) + 0.5) * edge
        for low, edge, n in zip(grid.lower, size, grid.density.shape[::-1], strict=True)
    )
    return x, y, z


def steps_of(layers: int, layer: int) -> Iterator[slice]:
    """Cut a grid's layers into steps of at most STEP cells, one layer at the least.

    Parameters
    ----------
    layers, layer
        How many there are, and the cells in one.
    """
    thick = max(1, STEP // max(layer, 1))
    for first in range(0, layers, thick):
        yield slice(first, min(first + thick, layers))
