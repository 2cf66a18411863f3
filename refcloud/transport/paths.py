"""Truth to test against: light found by random paths, slowly, without any bias.

A path starts at the eye. Delta tracking (Woodcock 1965) walks it through the cloud as
if that were everywhere as dense as at its densest: at each stop the density decides
whether something is there. What is there scatters sunlight to the eye, dimmed by ratio
tracking (Novak 2014), and sends the path on, in a direction that the phase function
draws.
Every random number is a hash of (path, stop, purpose).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.cloudmap.sample import clamped_trilinear
from refcloud.conventions import Array, Colour, Range, Seed, Shape
from refcloud.noise import uniform
from refcloud.optics import Medium, Sun, phase
from refcloud.refusal import complaint
from refcloud.transport.cases import matters_of

Numbers = NDArray[Any]

AT_ONCE = 1 << 17  # paths in memory: some 30 MB
# What a random number is for: the words that tell it from its neighbours.
STEP, REAL, ALBEDO, COSINE, AZIMUTH, SUN_STEP = range(6)
NO_END = 1 << 30


@dataclass(frozen=True)
class PathEstimate:
    """Light along rays, estimated.

    Attributes
    ----------
    radiance
        Shape (N, 3).
    error
        Its standard error, shape (N, 3).
    """

    radiance: Array
    error: Array


@dataclass(frozen=True)
class _Walkers:
    """Paths that have not ended: row of the result, number, place, way, events."""

    row: Numbers
    path: Numbers
    p: Array
    w: Array
    scattered: Numbers

    def of(self, which: Numbers) -> _Walkers:
        """Keep some of them."""
        return _Walkers(
            self.row[which],
            self.path[which],
            self.p[which],
            self.w[which],
            self.scattered[which],
        )


@checked
def trace_paths(
    grid: VoxelGrid,
    origins: Annotated[Array, Shape("N", 3)],
    directions: Annotated[Array, Shape("N", 3)],
    *,
    suns: Sun | tuple[Sun, ...],
    medium: Medium,
    sky: Colour | None = None,
    ground: Colour | None = None,
    paths: Annotated[int, Range(2, 1 << 24)] = 64,
    orders: Annotated[int, Range(1, NO_END)] = NO_END,
    seed: Seed = 0,
) -> PathEstimate:
    """Estimate the light that a cloud scatters along rays, by random paths.

    Formula: the mean over paths of sum_k p(cos_theta_k) T(sun) E over their scattering
    events k, and of the radiance outside where one leaves after the first

    Parameters
    ----------
    grid
        The cloud map.
    origins, directions
        Of the rays, shape (N, 3), scene units; unit directions.
    suns
        The lights.
    medium
        What the cloud is made of.
    sky, ground
        Radiance from above and from below, RGB; None for none.
    paths
        For each ray. The error shrinks with their square root.
    orders
        Scattering events that count; 1 is single scattering.
    seed
        Chooses the paths.

    Returns
    -------
    The estimate with its standard error. Light that reaches the eye unscattered is not
    in it.

    Source: an extension of paper M (multiple scattering, X09); determinism (W12).
    """
    suns = (suns,) if isinstance(suns, Sun) else suns
    if len(origins) * paths > NO_END:
        expected = f"at most {NO_END} paths in all"
        raise ValueError(complaint("paths", expected, f"{len(origins) * paths}"))
    colours = [sun.irradiance for sun in suns]
    colours += [np.zeros(3) if c is None else c for c in (sky, ground)]
    light = np.array(colours)  # (S + 2, 3)
    sums, squares = np.zeros((2, len(origins), 3))
    for sigma_t, albedo, channels in matters_of(medium):
        grey = Medium(sigma_t, albedo, medium.g, medium.phase)
        for first in range(0, len(origins) * paths, AT_ONCE):
            number = np.arange(first, min(first + AT_ONCE, len(origins) * paths))
            ray = number // paths
            shares = _walk(
                grid, origins[ray], directions[ray], number, suns, grey, orders, seed
            )
            values = shares @ light[:, channels]
            for c, channel in enumerate(channels):
                count = len(origins)
                sums[:, channel] += np.bincount(ray, values[:, c], count)
                squares[:, channel] += np.bincount(ray, values[:, c] ** 2, count)
    mean = sums / paths
    variance = np.maximum(squares / paths - np.square(mean), 0.0)
    return PathEstimate(mean, np.sqrt(variance / (paths - 1)))


def _walk(
    grid: VoxelGrid,
    origins: Array,
    directions: Array,
    number: Numbers,
    suns: tuple[Sun, ...],
    medium: Medium,
    orders: int,
    seed: int,
) -> Array:
    """Walk paths to their ends; give the share of each light, shape (P, S + 2)."""
    shares = np.zeros((len(number), len(suns) + 2))
    densest = float(grid.density.max()) * float(medium.sigma_t_rgb[0])
    if not densest > 0.0:
        return shares
    sigma_t, albedo = float(medium.sigma_t_rgb[0]), float(medium.albedo_rgb[0])
    p, meets = _entered(grid, origins, directions)
    none = np.zeros(len(number), np.intp)
    walk = _Walkers(np.arange(len(number)), number, p, directions, none).of(meets)
    stop = 0
    while len(walk.row):
        # 1. Walk on to the next stop; those that leave the box see what is outside.
        step = -np.log1p(-uniform(walk.path, stop, STEP, seed=seed)) / densest
        walk = replace(walk, p=walk.p + step[:, None] * walk.w)
        inside = _inside(grid, walk.p)
        left = walk.of(~inside & (walk.scattered > 0))
        shares[left.row, np.where(left.w[:, 1] > 0.0, -2, -1)] += 1.0
        walk = walk.of(inside)
        # 2. Is anything there? Is it absorbed?
        rho = sigma_t * _density(grid, walk.p)
        real = uniform(walk.path, stop, REAL, seed=seed) * densest < rho
        lost = real & (uniform(walk.path, stop, ALBEDO, seed=seed) >= albedo)
        hit = walk.of(real & ~lost)
        # 3. Sunlight that is scattered to where the path came from.
        for s, sun in enumerate(suns):
            cosine = np.clip(hit.w @ sun.direction, -1.0, 1.0)
            words = hit.path, stop, s
            T = _sun_share(grid, hit.p, sun, sigma_t, words, seed)
            shares[hit.row, s] += phase(medium, cosine) * T
        # 4. A new direction; paths that were scattered often enough end.
        ways, counts = walk.w.copy(), walk.scattered + (real & ~lost)
        ways[real & ~lost] = _turned(hit.w, medium, hit.path, stop, seed)
        walk = replace(walk, w=ways, scattered=counts).of(~lost & (counts < orders))
        stop += 1
    return shares


def _sun_share(
    grid: VoxelGrid,
    p: Array,
    sun: Sun,
    sigma_t: float,
    words: tuple[Numbers, int, int],
    seed: int,
) -> Array:
    """Estimate the transmittance to a sun: the product of 1 - rho / densest."""
    path, stop, which = words
    densest = float(grid.density.max()) * sigma_t
    found = np.ones(len(p))
    going = np.arange(len(p))
    turn = 0
    while len(going):
        u = uniform(path[going], stop, SUN_STEP, which, turn, seed=seed)
        p = p - (np.log1p(-u) / densest)[:, None] * sun.direction
        inside = _inside(grid, p)
        p, going = p[inside], going[inside]
        rho = sigma_t * _density(grid, p)
        found[going] *= np.maximum(1.0 - rho / densest, 0.0)
        dark = found[going] > 0.0
        p, going = p[dark], going[dark]
        turn += 1
    return found


def _turned(w: Array, medium: Medium, path: Numbers, stop: int, seed: int) -> Array:
    """Draw new directions from the phase function."""
    u = uniform(path, stop, COSINE, seed=seed)
    around = 2.0 * np.pi * uniform(path, stop, AZIMUTH, seed=seed)
    if medium.phase == "hg" and medium.g != 0.0:
        g = medium.g
        ratio = (1.0 - g * g) / (1.0 - g + 2.0 * g * u)
        cosine = (1.0 + g * g - ratio * ratio) / (2.0 * g)
    elif medium.phase == "rayleigh":
        # The distribution (4 + 3 c + c^3) / 8 = u, solved by Cardano.
        q = 4.0 * u - 2.0
        root = np.cbrt(q + np.sqrt(q * q + 1.0))
        cosine = root - 1.0 / root
    else:
        cosine = 2.0 * u - 1.0
    cosine = np.clip(cosine, -1.0, 1.0)
    sine = np.sqrt(1.0 - np.square(cosine))
    # Two axes across w, without a division that could fail (Duff 2017).
    x, y, z = w.T
    sign = np.where(z >= 0.0, 1.0, -1.0)
    a = -1.0 / (sign + z)
    b = x * y * a
    right = np.stack([1.0 + sign * x * x * a, sign * b, -sign * x], axis=1)
    up = np.stack([b, sign + y * y * a, -y], axis=1)
    turned = (
        (sine * np.cos(around))[:, None] * right
        + (sine * np.sin(around))[:, None] * up
        + cosine[:, None] * w
    )
    return turned / np.sqrt(np.square(turned).sum(axis=1, keepdims=True))


def _entered(grid: VoxelGrid, p: Array, w: Array) -> tuple[Array, Numbers]:
    """Move origins outside of the box to its face, and tell which rays meet it."""
    near, far = np.zeros(len(p)), np.full(len(p), np.inf)
    for axis in range(3):
        moving = w[:, axis] != 0.0
        speed = np.where(moving, w[:, axis], 1.0)
        with np.errstate(over="ignore"):  # hardly moving: that face is nowhere near
            ends = [
                np.where(moving, (face[axis] - p[:, axis]) / speed, sign)
                for face, sign in ((grid.lower, -np.inf), (grid.upper, np.inf))
            ]
        beside = ~moving & (
            (p[:, axis] < grid.lower[axis]) | (p[:, axis] > grid.upper[axis])
        )
        near = np.maximum(near, np.where(beside, np.inf, np.minimum(*ends)))
        far = np.minimum(far, np.maximum(*ends))
    meets = near < far
    return p + np.where(meets, near, 0.0)[:, None] * w, meets


def _inside(grid: VoxelGrid, p: Array) -> Numbers:
    return np.all((p >= grid.lower) & (p <= grid.upper), axis=1)


def _density(grid: VoxelGrid, p: Array) -> Array:
    x, y, z = ((p - grid.lower) / cell_size(grid) - 0.5).T
    return clamped_trilinear(grid.density, x, y, z)
