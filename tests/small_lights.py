"""Clouds small enough for the laws of light, and what leaves them."""

from __future__ import annotations

import numpy as np

from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.noise import uniform
from refcloud.optics import Medium, Sun
from refcloud.transport import (
    ScatteredLight,
    sweep,
)
from refcloud.transport.sweep import mean_transmittance, shift_matrix, step_of

SUN = Sun([0.5, 0.8, -0.3], [1.0, 1.0, 1.0])
FORWARD = Medium(6.0, g=0.6, phase="hg")


def ball(n: int) -> VoxelGrid:
    """Fill a ball whose density voxels hold well, with an empty border."""
    z, y, x = np.ix_(*[np.linspace(-1.0, 1.0, n)] * 3)
    return VoxelGrid(
        np.clip(1.2 - 1.9 * (x * x + y * y + z * z), 0, 1), [0] * 3, [1] * 3
    )


BALL = ball(16)


def cloud(n: int = 8, seed: int = 1, *, shape: tuple[int, int, int] | None = None):
    """Hash a lumpy ball with an empty border, in a box of edge 1."""
    D, H, W = shape or (n, n, n)
    z, y, x = (np.abs((np.arange(k) + 0.5) / k * 2 - 1) for k in (D, H, W))
    r = np.sqrt(z[:, None, None] ** 2 + y[:, None] ** 2 + x**2)
    lumps = uniform(np.arange(D * H * W), seed=seed).reshape(D, H, W)
    density = np.clip(1.6 - 2.2 * r, 0.0, 1.0) * (0.5 + lumps)
    for axis in range(3):
        np.moveaxis(density, axis, 0)[[0, -1]] = 0.0
    return VoxelGrid(density, [0, 0, 0], [1, 1, 1])


def source_of(light: ScatteredLight) -> np.ndarray:
    """Give the source along each direction, first order too: (N, D, H, W), case 0."""
    level = light.solutions[0].level
    moments = light.moments[0][:, 0].copy()
    first = np.zeros_like(moments)
    first[(slice(None), *level.beams.near)] = level.sunlight[:, 0]
    return np.tensordot(level.Y * level.share, moments + first, axes=1)


def radiance_of(light: ScatteredLight, inflow: np.ndarray | None = None):
    """Sweep the source once more: (N, D, H, W), extinction and cell."""
    level = light.solutions[0].level
    cell = (light.upper - light.lower) / np.array(light.shape[::-1])
    low = np.rint((light.lower - light.grid.lower) / cell_size(light.grid))
    kept = tuple(
        slice(int(a), int(a) + n) for a, n in zip(low[::-1], light.shape, strict=True)
    )
    rho = np.zeros(light.shape)
    part = light.grid.density[kept]
    rho[tuple(slice(0, n) for n in part.shape)] = part
    extinction = rho * level.scaled.sigma_t[0]
    S = source_of(light)
    I = sweep(S, extinction, level.directions, cell=cell, inflow=inflow)
    return S, I, extinction, cell


def leaving(light: ScatteredLight, inflow: np.ndarray | None = None) -> np.ndarray:
    """Give the power per steradian that leaves the grid along each direction, (N,)."""
    level = light.solutions[0].level
    S, I, extinction, cell = radiance_of(light, inflow)
    found = np.zeros(len(S))
    for n, vector in enumerate(level.directions.vectors):
        step = step_of(vector, cell)
        slices, s, mean_I = (
            np.moveaxis(v, step.axis, 0)[:: step.sense]
            for v in (extinction, S[n], I[n])
        )
        tau = slices * step.length
        # What goes on from each voxel, by the voxel's own balance.
        mean = mean_transmittance(tau)
        beam = s + np.exp(-tau) * (mean_I - s) / mean
        down, across = (
            shift_matrix(size, side)
            for size, side in zip(tau.shape[1:], step.side, strict=True)
        )
        kept = down @ beam[:-1] @ across.T
        out = beam[:-1].sum() - kept.sum() + beam[-1].sum()
        found[n] = out * cell.prod() / step.length
    return found


def directions_of(light: ScatteredLight):
    return light.solutions[0].level.directions
