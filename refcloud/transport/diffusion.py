"""Diffusion (P1): scattered light that has forgotten nearly all of its direction.

Of the light at a place two things are kept, its sum phi and its net flow F. With the
delta-Eddington scaling f = g^2 (Joseph 1976) they obey

    -div D grad phi + sigma' (1 - a') phi = sigma' a' E T - div q,   F = q - D grad phi

with D = 1 / (3 sigma' (1 - a' g')) and q = 3 D sigma' a' g' E T along the sunlight.
What leaves the cloud does not come back: at its faces F is phi / 2 (Marshak 1947).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.conventions import Array, Vector, unit_vector
from refcloud.optics import Medium, Sun
from refcloud.transport.delta_m import legendre_moments
from refcloud.transport.sun import sun_depths
from refcloud.transport.sunlight import cell_mean
from refcloud.transport.sweep import step_of

MOST, RESIDUAL = 2000, 1e-4
LEAST = 1e-3  # optical depth of a voxel below which it counts as empty


@dataclass(frozen=True)
class Diffused:
    """Diffused light of a grey medium under one sun of irradiance 1.

    Attributes
    ----------
    sigma_t, albedo, g
        Of the scaled medium.
    total
        phi, radiance times steradian, shape (D, H, W).
    flow
        F in x, y, z, shape (3, D, H, W).
    iterations
        Of the conjugate gradients.
    """

    sigma_t: float
    albedo: float
    g: float
    total: Array
    flow: Array
    iterations: int


@checked
def diffused_light(grid: VoxelGrid, sun: Sun, *, medium: Medium) -> Diffused:
    """Solve the diffusion of a sun's light in a cloud, by conjugate gradients.

    Formula: see `refcloud.transport.diffusion`; between voxels D is their harmonic mean

    Parameters
    ----------
    grid
        The cloud map.
    sun
        Its direction counts; the irradiance is taken as 1.
    medium
        What the cloud is made of; its first channel is solved.

    Returns
    -------
    phi, F and how they came about. Faces of voxels are more surface than the cloud has:
    too much light leaks, and the picture is too dark.

    Source: an extension of paper M (multiple scattering, X09).
    """
    moments = legendre_moments(medium, 2)
    f = float(moments[2]) if medium.phase == "hg" else 0.0
    a, sigma = float(medium.albedo_rgb[0]), float(medium.sigma_t_rgb[0])
    scaled, albedo = sigma * (1.0 - a * f), a * (1.0 - f) / (1.0 - a * f)
    g = (float(moments[1]) - f) / (1.0 - f)
    cell, toward = cell_size(grid), sun.direction
    edges = cell[::-1]  # along z, y, x
    sigma_v = scaled * grid.density
    inside = sigma_v * float(cell.min()) > LEAST
    sigma_v = np.where(inside, sigma_v, 1.0 / float(cell.min()))
    D = 1.0 / (3.0 * sigma_v * (1.0 - albedo * g))
    columns = sun_depths(grid, toward).density
    own = scaled * grid.density * step_of(toward, cell).length
    T = cell_mean(scaled * columns, own) * inside
    # 1. What neighbours exchange through each face, and what leaves.
    volume = float(cell.prod())
    lost = sigma_v * (1.0 - albedo) * volume
    source = sigma_v * albedo * T * volume
    q = 3.0 * D * sigma_v * albedo * g * T  # along the sunlight
    faces = [
        _face(axis, edges[axis], volume, D, inside, -float(toward[2 - axis]) * q)
        for axis in range(3)
    ]
    for axis, face in enumerate(faces):
        near, far = _sides(axis)
        lost[near] += face.leaving[0]
        lost[far] += face.leaving[1]
        lost += face.ends
        source[near] -= face.carried
        source[far] += face.carried
    # 2. Solve; a voxel's flow is the mean of what passes its two faces.
    phi, count = _conjugate_gradients([f.passing for f in faces], lost, source, inside)
    flow = np.zeros((3, *phi.shape))
    for axis, face in enumerate(faces):
        near, far = _sides(axis)
        area = volume / edges[axis]
        through = face.carried + face.passing * (phi[near] - phi[far])
        through += face.leaving[0] * phi[near] - face.leaving[1] * phi[far]
        flow[2 - axis][near] += 0.5 * through / area * inside[near]
        flow[2 - axis][far] += 0.5 * through / area * inside[far]
    return Diffused(scaled, albedo, g, phi, flow, count)


@dataclass(frozen=True)
class _Face:
    """The faces across an axis: what passes per phi, and what is carried along.

    `leaving` is what goes out of the near and of the far voxel where the other one is
    empty, `ends` what goes out at the two ends of the grid.
    """

    passing: Array
    carried: Array
    leaving: tuple[Array, Array]
    ends: Array


def _face(
    axis: int, h: float, volume: float, D: Array, inside: NDArray[Any], q: Array
) -> _Face:
    near, far = _sides(axis)
    area = volume / h
    both = inside[near] & inside[far]
    # Half a voxel of diffusion, then phi / 2 goes out: two resistances in a row.
    out = area / (0.5 * h / D + 2.0) * inside
    ends = np.zeros_like(out)
    at_ends = np.moveaxis(ends, axis, 0)
    at_ends[0] += np.moveaxis(out, axis, 0)[0]
    at_ends[-1] += np.moveaxis(out, axis, 0)[-1]
    return _Face(
        both * area * 2.0 / (h / D[near] + h / D[far]),
        both * area * 0.5 * (q[near] + q[far]),
        (out[near] * ~inside[far], out[far] * ~inside[near]),
        ends,
    )


@checked
def diffuse_source(light: Diffused, direction: Vector) -> Array:
    """Give the source of diffused light in a direction, at each voxel.

    Formula: J = a' (phi + 3 g' F . w) / (4 pi), at least 0

    Parameters
    ----------
    light
        Of `diffused_light`.
    direction
        In which the light travels, shape (3,), any length but 0.

    Returns
    -------
    Shape (D, H, W), radiance per optical depth for irradiance 1.

    Source: an extension of paper M (multiple scattering, X09).
    """
    w = unit_vector(direction)
    flow = w[0] * light.flow[0] + w[1] * light.flow[1] + w[2] * light.flow[2]
    J = light.albedo * (light.total + 3.0 * light.g * flow) / (4.0 * math.pi)
    return np.maximum(J, 0.0)


def _sides(axis: int) -> tuple[tuple[slice, ...], tuple[slice, ...]]:
    """Index the voxels on both sides of the faces across an axis."""
    near, far = [slice(None)] * 3, [slice(None)] * 3
    near[axis], far[axis] = slice(None, -1), slice(1, None)
    return tuple(near), tuple(far)


def _conjugate_gradients(
    between: list[Array], lost: Array, source: Array, inside: NDArray[Any]
) -> tuple[Array, int]:
    """Solve the balance of every voxel; the matrix is symmetric and positive."""
    diagonal = lost.copy()
    for axis, passing in enumerate(between):
        near, far = _sides(axis)
        diagonal[near] += passing
        diagonal[far] += passing

    def balance(x: Array) -> Array:
        out = diagonal * x
        for axis, passing in enumerate(between):
            near, far = _sides(axis)
            out[near] -= passing * x[far]
            out[far] -= passing * x[near]
        return out

    scale = np.where(inside & (diagonal > 0.0), diagonal, 1.0)
    x, r = np.zeros_like(source), source * inside
    z = r / scale
    p, rz = z.copy(), float((r * z).sum())
    enough = RESIDUAL**2 * rz
    count = 0
    while rz > enough and count < MOST:
        Ap = balance(p)
        step = rz / float((p * Ap).sum())
        x += step * p
        r -= step * Ap
        z = r / scale
        rz, old = float((r * z).sum()), rz
        p = z + (rz / old) * p
        count += 1
    return x, count
