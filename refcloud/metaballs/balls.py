"""The cloud as a set of metaballs, and the one ball for each voxel."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import check_fields, checked
from refcloud.cloudmap.voxels import VoxelGrid, cell_size
from refcloud.conventions import Array, Positive, Range, Shape, Skipped
from refcloud.metaballs.integrals import integral
from refcloud.metaballs.kernels import Kernel
from refcloud.refusal import counted

# A voxel's ball reaches over its neighbours' centres, so that no gaps show between.
VOXEL_REACH = 1.5  # radius in mean cell edges


@dataclass(frozen=True, eq=False, repr=False)
class Metaballs:
    """A cloud as N balls of density, each falling from its centre to 0 at its radius.

    The balls are numbered 0 to N - 1 everywhere (E16). Arrays that could still be
    written into are copied. A set of balls equals itself alone: compare its arrays.

    Attributes
    ----------
    centers
        Shape (N, 3) as x, y, z, scene units.
    radii
        Shape (N,), above 0, scene units.
    densities
        Shape (N,), at the centre, at least 0.
    kernel
        How the density falls: ``"wyvill"`` or ``"gaussian"`` (cut at R = 2 sigma).
    skipped
        What the approximation left out.
    """

    centers: Annotated[Array, Shape("N", 3)]
    radii: Annotated[Array, Shape("N"), Positive]
    densities: Annotated[Array, Shape("N"), Range(0.0)]
    kernel: Literal["wyvill", "gaussian"] = "wyvill"
    skipped: tuple[Skipped, ...] = ()

    def __post_init__(self) -> None:
        check_fields(self, own=True)

    def __repr__(self) -> str:
        """Say what it is without its numbers."""
        if not len(self):
            return f"Metaballs(0 balls, {self.kernel})"
        least, most = float(self.radii.min()), float(self.radii.max())
        return (
            f"Metaballs({counted(len(self), 'ball')}, radii {least:.4g} to {most:.4g},"
            f" {self.kernel})"
        )

    def __len__(self) -> int:
        """Give the number of balls."""
        return len(self.radii)


@checked
def voxel_balls(grid: VoxelGrid, *, kernel: Kernel = "wyvill") -> Metaballs:
    """Put one ball on each occupied voxel, with the mass of its cell.

    Formula: density_ball * integral(kernel, 3) R^3 = density * cell volume

    Parameters
    ----------
    grid
        The cloud map.
    kernel
        How the balls' density falls.

    Returns
    -------
    Balls in the order of the voxels (z, then y, then x), all of radius 1.5 mean edges.

    Source: paper M, eq 11, fig 4.

    Examples
    --------
    >>> balls = voxel_balls(VoxelGrid(np.ones((1, 1, 2)), [0, 0, 0], [2, 1, 1]))
    >>> balls.centers.tolist(), float(balls.radii[0])
    ([[0.5, 0.5, 0.5], [1.5, 0.5, 0.5]], 1.5)
    """
    size = cell_size(grid)
    edge = mean_edge(size)
    where = np.argwhere(grid.density > 0.0)[:, ::-1]  # (N, 3) as x, y, z
    radius = VOXEL_REACH * edge
    share = 1.0 / (integral(kernel, dimension=3) * VOXEL_REACH**3)
    return Metaballs(
        grid.lower + (where + 0.5) * size,
        np.full(len(where), radius),
        grid.density[grid.density > 0.0] * share,
        kernel,
    )


def mean_edge(size: Array) -> float:
    """Give the edge of the cube that has a cell's volume: the geometric mean."""
    return float(np.exp(np.log(size).mean()))  # logarithms cannot overflow
