"""A cloud map lit by suns and sky in octaves of scattering, as a camera sees it."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np

from refcloud.camera import Camera, OrthographicCamera, axes
from refcloud.checking import checked, complaint
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Array, Observer, Seed, Skipped, Tolerance
from refcloud.lighting.octaves import Octaves, octave_source, sky_source
from refcloud.lighting.shining import (
    DType,
    Shining,
    Step,
    bordered,
    marched,
    shining_of,
)
from refcloud.optics import Medium, Sun
from refcloud.transport import sun_depths

CHUNK = 1 << 17  # samples at a time: memory stays bounded
UP = np.array([0.0, 1.0, 0.0])
# float32 was off by 1.1e-5 at the most in the scene `demand`: a tenth of 2e-4.
SINGLE_PRECISION, FRONT_SHARE = 2e-4, 0.9


@checked
def octave_march(
    grid: VoxelGrid,
    camera: Camera | OrthographicCamera,
    *,
    suns: tuple[Sun, ...],
    medium: Medium,
    octaves: Octaves,
    step: Step,
    tolerance: Tolerance = 0.0,
    seed: Seed = 0,
    observe: Observer | None = None,
) -> tuple[Array, Array, tuple[Skipped, ...]]:
    """March a camera's rays through a cloud lit in octaves of scattering.

    Formula: `march_shining` with the color sum over suns of irradiance times
    `octave_source`, plus `sky_source`

    Parameters
    ----------
    grid
        The cloud map.
    camera
        The eye.
    suns
        The lights.
    medium
        Extinction as one number, albedo, and the first octave's g; its phase function
        is "hg" or "isotropic".
    octaves
        The light model.
    step
        Between samples of a ray, scene units; an edge of a voxel resolves the map.
    tolerance
        Largest error of a channel, before a background of at most 1, that savings may
        make: rays end behind an opaque front, and from 2e-4 on the arithmetic is
        float32. 0 leaves out nothing that could show.
    seed
        Chooses the starts of the rays.
    observe
        Called with (name, value) for each intermediate.

    Returns
    -------
    Radiance of shape (H, W, 3), transmittance of shape (H, W), and rows of what was
    skipped.

    Raises
    ------
    ValueError
        The medium has another phase function, or extinction by channel; a ray would
        have more than 65,536 steps, or the grid has more than 2^26 cells.

    Source: document D (R05), in octaves; an extension after Wrenninge, Kulla and
    Lundqvist, "Oz: The Great and Volumetric", 2013.

    Examples
    --------
    >>> grid = VoxelGrid(np.zeros((2, 2, 2)), [-1, -1, -1], [1, 1, 1])
    >>> eye = Camera([0, 0, 9], [0, 0, 0], width=2, height=2)
    >>> how = dict(medium=Medium(1.0, phase="hg"), octaves=Octaves(), step=1)
    >>> octave_march(grid, eye, suns=(), **how)[1].tolist()
    [[1.0, 1.0], [1.0, 1.0]]
    """
    sigma_t = _one_extinction(medium)
    dtype: DType = "float32" if tolerance >= SINGLE_PRECISION else "float64"
    watch = observe or (lambda name, value: None)
    cloud = shining_of(grid, sigma_t, dtype)

    # 1. Columns toward each light, once for all samples.
    def depths(name: str, direction: Array) -> Any:
        volume = sun_depths(grid, direction, dtype=dtype)
        watch(f"{name} depths", volume)
        return volume.density

    lit = [sun for sun in suns if sun.irradiance.any()]
    toward = [depths(f"sun {s}", sun.direction) for s, sun in enumerate(lit)]
    ambient = octaves.sky_light.any() or octaves.ground_light.any()
    above, below = (
        (depths("sky", UP), depths("ground", -UP)) if ambient else (None, None)
    )

    # 2. The color of each sample that has cloud beside it, toward the eye.
    k, j, i = np.nonzero(beside(cloud))
    for first in range(0, len(k), CHUNK):
        where = (
            k[first : first + CHUNK],
            j[first : first + CHUNK],
            i[first : first + CHUNK],
        )
        colors = np.zeros((len(where[0]), 3))
        seen = seen_along(grid, camera, where)
        for sun, column in zip(lit, toward, strict=True):
            cosines = np.clip(seen @ sun.direction, -1.0, 1.0)
            tau = sigma_t * column[where].astype(np.float64)
            colors += sun.irradiance * _by_channel(cosines, tau, medium, octaves)
        if above is not None and below is not None:
            columns = (sigma_t * c[where].astype(np.float64) for c in (above, below))
            colors += medium.albedo_rgb * sky_source(*columns, octaves=octaves)
        cloud.table[1:-1, 1:-1, 1:-1, :3][where] = colors
    bordered(cloud.table[..., :3])
    watch("shining", cloud)

    # 3. March. Behind a front that lets `least` through, the cloud adds at most its
    #    brightest, and the background what the front does not hide: one or the other.
    brightest = max(float(cloud.table[..., :3].max()), 1.0)
    least = FRONT_SHARE * tolerance / brightest
    L, T, rows = marched(cloud, camera, step=step, least=least, seed=seed)
    if dtype == "float32":
        what, count = "samples in double precision", len(k)
        bound = (1.0 - FRONT_SHARE) * tolerance
        rows += (Skipped("march", what, count, count, bound, how="measured"),)
    return L, T, rows


def _one_extinction(medium: Medium) -> float:
    """Give the extinction; refuse what the octaves do not model."""
    if np.ndim(medium.sigma_t):
        expected = "one number: octaves of scattering have one optical depth"
        raise ValueError(complaint("sigma_t", expected, "RGB"))
    if medium.phase == "rayleigh":
        expected = "'hg' or 'isotropic': octaves have lobes"
        raise ValueError(complaint("phase", expected, "'rayleigh'"))
    return float(np.asarray(medium.sigma_t))


def _by_channel(cosines: Array, tau: Array, medium: Medium, octaves: Octaves) -> Array:
    """Give `octave_source` by channel, shape (N, 3); once for each albedo there is."""
    albedos = medium.albedo_rgb.tolist()
    g = medium.g if medium.phase == "hg" else 0.0
    found = {
        albedo: octave_source(cosines, tau, g=g, albedo=albedo, octaves=octaves)
        for albedo in set(albedos)
    }
    return np.stack([found[albedo] for albedo in albedos], axis=-1)


def beside(cloud: Shining) -> np.ndarray:
    """Find the samples that a place with extinction around it reads, (D, H, W)."""
    beside = np.zeros(tuple(n - 1 for n in cloud.occupied.shape), bool)
    for corner in itertools.product((0, 1), repeat=3):
        part = tuple(slice(c, c + n) for c, n in zip(corner, beside.shape, strict=True))
        beside |= cloud.occupied[part]
    return beside


def seen_along(
    grid: VoxelGrid, camera: Camera | OrthographicCamera, where: tuple
) -> Array:
    """Give the direction in which the eye sees samples, unit vectors (N, 3)."""
    if isinstance(camera, OrthographicCamera):
        return np.broadcast_to(-axes(camera)[2], (len(where[0]), 3))
    size = (grid.upper - grid.lower) / np.array(grid.density.shape[::-1])
    index = np.stack(where[::-1], axis=1)
    ways = grid.lower + (index + 0.5) * size - camera.eye
    far = np.sqrt(np.square(ways).sum(axis=1, keepdims=True))
    # Seen from within a sample every direction is as good.
    return np.divide(ways, far, out=np.zeros_like(ways), where=far > 0.0)
