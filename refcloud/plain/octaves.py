"""Octaves of scattering, and a cloud that shines, one place and one ray at a time.

Each function is the twin of the one of the same name in `refcloud.lighting`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from refcloud.plain.camera import Camera, Point, along, rays
from refcloud.plain.cloudmap import Grid, cell_size, clamped_trilinear
from refcloud.plain.march import ray_box
from refcloud.plain.noise import uniform
from refcloud.plain.optics import henyey_greenstein


class Octaves(NamedTuple):
    """The light model, fields as `refcloud.lighting.Octaves`."""

    orders: int
    extinction: float
    contribution: float
    narrowing: float
    backward: float
    backward_share: float
    sky_light: Sequence[float]
    ground_light: Sequence[float]
    sky_extinction: float


def octave_lobe(cos_theta: float, n: int, g: float, octaves: Octaves) -> float:
    """Give the phase function of an octave in one direction."""
    narrow = g * octaves.narrowing**n
    ahead = henyey_greenstein(cos_theta, narrow)
    behind = henyey_greenstein(cos_theta, -octaves.backward * narrow)
    share = octaves.backward_share
    return (1.0 - share) * ahead + share * behind


def octave_source(
    cos_theta: float, tau: float, g: float, albedo: float, octaves: Octaves
) -> float:
    """Give the radiance per unit of irradiance and optical depth at one place."""
    total = 0.0
    for n in range(octaves.orders):
        weight = albedo ** (n + 1) * octaves.contribution**n
        reaches = math.exp(-(octaves.extinction**n) * tau)
        total += weight * octave_lobe(cos_theta, n, g, octaves) * reaches
    return total


def sky_source(above: float, below: float, octaves: Octaves) -> list[float]:
    """Give what sky and ground light up at one place."""
    up = math.exp(-octaves.sky_extinction * above)
    down = math.exp(-octaves.sky_extinction * below)
    return [
        up * sky + down * ground
        for sky, ground in zip(octaves.sky_light, octaves.ground_light, strict=True)
    ]


def march_shining(
    density: Grid,
    colors: Sequence[Grid],
    lower: Point,
    upper: Point,
    camera: Camera,
    column: int,
    row: int,
    *,
    sigma_t: float,
    step: float,
    least: float,
    seed: int,
) -> list[float]:
    """March the ray of one pixel; give RGB and T. Colors are three grids."""
    origin, direction = rays(camera, column, row)
    t0, t1 = ray_box(origin, direction, lower, upper)
    size = cell_size(density, lower, upper)
    start = t0 + uniform(row, column, seed=seed) * step
    T, light = 1.0, [0.0, 0.0, 0.0]
    for k in range(math.ceil((t1 - start) / step) if t0 < t1 else 0):
        if T <= least:
            break
        place = along(origin, (start + k * step, direction))
        at = [(p - a) / h - 0.5 for p, a, h in zip(place, lower, size, strict=True)]
        sigma = sigma_t * clamped_trilinear(density, at)
        share = -math.expm1(-sigma * step)
        for channel in range(3):
            color = clamped_trilinear(colors[channel], at)
            light[channel] += T * share * color
        T *= 1.0 - share
    return [*light, T]
