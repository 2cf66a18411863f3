"""The march as document D describes it: equal steps, and a march to the sun at each.

This is the definition that a student can trace. It takes every sample, empty or not;
`refcloud.march.integrate` computes what its sums tend to.
"""

from __future__ import annotations

from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.cloudmap import VoxelGrid, trilinear
from refcloud.conventions import Array, Range, Shape, Vector, unit_vector
from refcloud.march.box import ray_box
from refcloud.march.light import Segment, share_of, sources
from refcloud.march.mixing import PHYSICAL, Mixing
from refcloud.march.rays import as_rays, shaped
from refcloud.optics import Medium, Sun

SampleRate = Annotated[int, Range(1, 1 << 20, "samples")]
CHUNK = 1 << 16  # rays at a time: a few MB for each temporary


@checked
def sun_depth_by_steps(
    grid: VoxelGrid,
    points: Annotated[Array, Shape("N", 3)],
    *,
    direction: Vector,
    sample_rate: SampleRate = 16,
) -> Array:
    """March from each point to the sun and add up the density on the way.

    Formula: sum of rho(point + t direction) dt, t in the middles of equal steps

    Parameters
    ----------
    grid
        The cloud map.
    points
        Shape (N, 3), scene units.
    direction
        Toward the sun, shape (3,), any length but 0.
    sample_rate
        Steps between the point and the box's face.

    Returns
    -------
    The column of density, shape (N,); times sigma_t it is the optical depth.

    Source: document D (R05).

    Examples
    --------
    >>> grid = VoxelGrid(np.ones((2, 2, 2)), [0, 0, 0], [2, 2, 2])
    >>> sun_depth_by_steps(grid, [[1.0, 0.5, 1.0]], direction=[0.0, 1.0, 0.0])
    array([1.5])
    """
    toward = unit_vector(direction)
    _, end = ray_box(points, toward, lower=grid.lower, upper=grid.upper)
    dt = end / sample_rate
    column = np.zeros(len(points))
    for step in range(sample_rate):
        t = (step + 0.5) * dt
        column += trilinear(grid, points + t[:, None] * toward) * dt
    return column


@checked
def march_by_steps(
    grid: VoxelGrid,
    origins: Annotated[Array, Shape("...", 3)],
    directions: Annotated[Array, Shape("...", 3)],
    *,
    suns: Sun | tuple[Sun, ...],
    medium: Medium,
    sample_rate: SampleRate = 64,
    sun_sample_rate: SampleRate = 16,
    segment: Segment = "beer",
    mixing: Mixing = PHYSICAL,
) -> tuple[Array, Array]:
    """March rays through a cloud map in equal steps.

    Formula: L += T T_sun albedo p(cos_theta) E share(sigma_t rho dt),
    T *= exp(-sigma_t rho dt), from the eye on, rho in the middle of each step

    Parameters
    ----------
    grid
        The cloud map.
    origins, directions
        Of the rays, shape (..., 3) each, scene units; directions of any length but 0.
    suns
        The lights.
    medium
        What the cloud is made of.
    sample_rate
        Steps along each ray between the box's faces.
    sun_sample_rate
        Steps toward the sun at each of them.
    segment
        "beer", 1 - exp(-tau) of a step, or "euler", the paper's sum of tau.
    mixing
        Factors without a counterpart in physics, off by default.

    Returns
    -------
    Radiance of shape (..., 3), and transmittance of shape (...,), or (..., 3) where
    sigma_t is RGB.

    Source: document D (R02, R03, R05); E38.

    Examples
    --------
    >>> grid = VoxelGrid(np.ones((2, 2, 2)), [0, 0, 0], [2, 2, 2])
    >>> how = dict(suns=(), medium=Medium(0.5))
    >>> march_by_steps(grid, [1.0, 1, 9], [[0.0, 0, -1]], **how)[1].round(4)
    array([0.3679])
    """
    suns = (suns,) if isinstance(suns, Sun) else suns
    flat = as_rays(origins, directions)
    radiance = np.empty((len(flat.origins), 3))
    through = np.empty((len(flat.origins), np.size(medium.sigma_t)))
    for start in range(0, len(radiance), CHUNK):
        part = slice(start, start + CHUNK)
        radiance[part], through[part] = _marched(
            grid,
            flat.origins[part],
            flat.directions[part],
            suns,
            medium,
            (sample_rate, sun_sample_rate),
            segment,
            mixing,
        )
    return shaped(radiance, through, flat, medium)


def _marched(
    grid: VoxelGrid,
    origins: Array,
    directions: Array,
    suns: tuple[Sun, ...],
    medium: Medium,
    rates: tuple[int, int],
    segment: Segment,
    mixing: Mixing,
) -> tuple[Array, Array]:
    sigma_t = np.atleast_1d(medium.sigma_t)  # (1,), or (3,) of a coloured medium
    through_cloud = mixing.light_absorption_through_cloud
    L = np.zeros((len(origins), 3))
    T = np.ones((len(origins), len(sigma_t)))

    # 1. Rays that miss the box see nothing of the cloud.
    t0, t1 = ray_box(origins, directions, lower=grid.lower, upper=grid.upper)
    hit = np.flatnonzero(t1 > t0)
    o, d = origins[hit], directions[hit]
    dt = (t1[hit] - t0[hit]) / rates[0]
    lit = sources(suns, medium, directions=d)  # (S, n, 3)

    # 2. From the eye on: add what a step scatters toward the eye, then dim the rest.
    for step in range(rates[0]):
        points = o + (t0[hit] + (step + 0.5) * dt)[:, None] * d
        tau = (trilinear(grid, points) * dt)[:, None] * sigma_t  # (n, 1 or 3)
        seen = T[hit] * _share(tau, segment, through_cloud)
        for sun, source in zip(suns, lit, strict=True):
            column = sun_depth_by_steps(
                grid, points, direction=sun.direction, sample_rate=rates[1]
            )
            L[hit] += source * seen * reaching(column[:, None] * sigma_t, mixing)
        T[hit] *= np.exp(-through_cloud * tau)
    return L, T


def reaching(tau: NDArray[Any], mixing: Mixing) -> NDArray[Any]:
    """Give the share of a sun's light that an optical depth lets through, unchecked.

    Parameters
    ----------
    tau
        Optical depth toward the sun, any shape.
    mixing
        Its factor on tau, and its threshold of darkness.

    Returns
    -------
    The same shape, in [0, 1].
    """
    dark = mixing.darkness_threshold
    beer = np.exp(-mixing.light_absorption_toward_sun * tau)
    return dark + (1.0 - dark) * beer


def _share(tau: Array, segment: Segment, through_cloud: float) -> Array:
    """Integrate exp(-k tau) over a step, k the factor on the way to the eye."""
    if segment == "euler" or through_cloud == 0.0:
        return tau
    return share_of(through_cloud * tau, segment) / through_cloud
