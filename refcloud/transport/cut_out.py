"""The part of a grid that is solved, and what it takes out of each sun's beam."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.conventions import Array
from refcloud.frozen import sealed
from refcloud.optics import Medium, Sun
from refcloud.refusal import complaint
from refcloud.transport.delta_m import delta_m
from refcloud.transport.directions import sphere_directions
from refcloud.transport.folded import folded_beams, passed_and_returned
from refcloud.transport.plans import Plan
from refcloud.transport.sunlight import cell_mean, columns_across
from refcloud.transport.sweep import step_of

SMALLEST = 4  # voxels along the longest axis that stages leave
# Voxels along the longest axis that a plan's finest grid keeps, however thin they are:
# with half of them shapes are lost, and five times the error.
ENOUGH = 48


# Optical depth of a voxel beyond which the iteration stalls: at 1e6 a white furnace is
# still off by half after 500 sweeps, at 1e4 by 4e-3.
THICKEST_VOXEL = 1e4


def thickest_voxel(grid: VoxelGrid, medium: Medium) -> float:
    """Give the largest optical depth of one voxel, along its longest edge."""
    extinction = float(medium.sigma_t_rgb.max()) * float(grid.density.max())
    return extinction * float(cell_size(grid).max())


def refuse_thick(grid: VoxelGrid, medium: Medium) -> None:
    """Refuse voxels so thick that no number of sweeps carries light through them."""
    edges = cell_size(grid)  # light leaves a flat voxel across its shortest edge
    tau = thickest_voxel(grid, medium) * float(edges.min() / edges.max())
    if not tau <= THICKEST_VOXEL:
        expected = f"an optical depth of at most {THICKEST_VOXEL:g} in a voxel"
        advice = "lower sigma_t or use smaller voxels"
        raise ValueError(complaint("sigma_t", expected, f"{tau:.3g}", advice))


def cut_out(grid: VoxelGrid, plan: Plan, sigma: float) -> tuple[Plan, VoxelGrid, int]:
    """Cut the cloud out, with room for all halvings; count those before the plan."""
    size = cell_size(grid)
    occupied = np.argwhere(grid.density > 0.0)
    if not len(occupied):
        occupied = np.zeros((1, 3), int)
    first = np.maximum(occupied.min(axis=0) - 1, 0)
    last = np.minimum(occupied.max(axis=0) + 2, grid.density.shape)
    extent = last - first
    # As many halvings as keep voxels thin, and leave some to be swept.
    most = max(int(np.log2(extent.max() / SMALLEST)), 0)
    thin = float(grid.density.max()) * sigma * float(size.max())
    spare = int(np.log2(plan.depth / thin)) if 0.0 < thin < plan.depth else 0
    base = min(spare, max(int(np.log2(extent.max() / ENOUGH)), 0))
    stages = tuple(s for s in plan.stages if base + s.halvings <= most)
    room = -extent % 2 ** (base + max(s.halvings for s in stages))
    kept = tuple(slice(a, b) for a, b in zip(first, last, strict=True))
    density = np.pad(grid.density[kept], [(0, int(n)) for n in room])
    lower = grid.lower + first[::-1] * size
    upper = lower + (extent + room)[::-1] * size
    return replace(plan, stages=stages), VoxelGrid(sealed(density), lower, upper), base


def beam_norms(
    cloud: VoxelGrid,
    columns: list[NDArray[Any]],
    behind: list[NDArray[Any]],
    suns: tuple[Sun, ...],
    medium: Medium,
    plan: Plan,
) -> dict[int, Array]:
    """Give the factors that make voxels take out of each beam what the cloud does.

    By degree of the phase function; `behind` is empty where no light is turned round.
    """
    cell = cell_size(cloud)
    near = np.nonzero(cloud.density)
    density = cloud.density[near]
    degrees = {sphere_directions(stage.directions).degree for stage in plan.stages}
    factors = {degree: np.ones(len(suns)) for degree in degrees}
    for s, sun in enumerate(suns):
        path = step_of(sun.direction, cell).length
        lines, area = columns_across(cloud, sun.direction)
        for degree in degrees:
            scaled = delta_m(medium, degree)
            sigma = float(scaled.sigma_t[0])
            turned = float(scaled.albedo[0]) * scaled.backward
            own = density * (sigma * path)
            tau = sigma * columns[s][near]
            if turned > 0.0:
                beams = folded_beams(
                    tau, tau + sigma * behind[s][near], own, turned=turned
                )
                T = (1.0 - turned) * (beams[0] + beams[1])
                passed, returned = passed_and_returned(sigma * lines, turned)
                whole = float((1.0 - passed - returned).sum()) * area
            else:
                T = cell_mean(tau, own)
                whole = float(-np.expm1(-sigma * lines).sum()) * area
            taken = sigma * float(cell.prod()) * float((density * T).sum())
            factors[degree][s] = whole / taken if taken > 0.0 else 1.0
    return factors
