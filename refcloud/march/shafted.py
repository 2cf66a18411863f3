"""The quadrature with its light from leaning lattices, for the choice by tolerance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Array
from refcloud.march.cubics import Smooth, Straight
from refcloud.march.shafts import Shafts, shafts
from refcloud.march.slices import single
from refcloud.march.task import Task
from refcloud.march.view import sides_touched


@dataclass(frozen=True)
class Shafting:
    """How finely light is tabulated, and at how many Gauss points of a piece it is met.

    Attributes
    ----------
    finer
        Samples of the leaning lattice per voxel, along each axis.
    points
        Gauss points in each space between voxel centres.
    """

    finer: int
    points: int


# From coarse to fine. Largest errors seen of a cloud with .6 of optical depth per voxel
# and edges of one voxel: .0044, .0019 and .0009 of white (the finest was not needed).
SHAFTINGS = (Shafting(3, 2), Shafting(3, 3), Shafting(4, 3), Shafting(6, 4))


def shafts_of(task: Task, cloud: VoxelGrid, finer: int) -> list[Shafts] | None:
    """Tabulate the light of each sun; None where leaning lattices cannot serve.

    Cloud that ends at a side of its box has light with a kink there, and what single
    precision cannot hold, or 128 MB for each sun, is left to the quadrature.
    """
    if sides_touched(cloud) or not single(cloud, task.medium):
        return None
    found = []
    for sun in task.suns:
        table = shafts(cloud, sun.direction, finer)
        if table is None:
            return None
        found.append(table)
    return found


def shafted(
    task: Task, tables: Sequence[Shafts | Smooth | Straight], points: int, least: float
) -> tuple[Array, Array]:
    """Integrate rays with their light from tables that are read by cubics.

    Parameters
    ----------
    task
        N rays.
    tables
        One for each sun: of `shafts_of`, or light volumes.
    points
        Gauss points in each space between voxel centres.
    least
        Transmittance behind which nothing need be looked for.

    Returns
    -------
    Radiance of shape (N, 3), and columns of density of shape (N,).
    """
    by_sun = {
        sun.direction.tobytes(): table
        for sun, table in zip(task.suns, tables, strict=True)
    }
    return task.exact(
        least, points, lambda places, sun: by_sun[sun.tobytes()].columns(places)
    )
