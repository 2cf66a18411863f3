"""A cloud map marched in equal steps, lit by a field that was solved on a coarser one.

What was scattered more than once is smooth: it is solved where voxels are few. Sunlight
that comes for the first time draws the fine shapes, and is found on the fine map.
"""

from __future__ import annotations

import numpy as np

from refcloud.camera import Camera, OrthographicCamera
from refcloud.checking import checked
from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.cloudmap.sample import clamped_trilinear
from refcloud.conventions import Array, Observer, Seed, Skipped, Tolerance
from refcloud.frozen import sealed
from refcloud.lighting.octave_march import (
    CHUNK,
    FRONT_SHARE,
    SINGLE_PRECISION,
    beside,
    seen_along,
)
from refcloud.lighting.shining import DType, Step, bordered, marched, shining_of
from refcloud.lighting.solved import refuse_coloured
from refcloud.optics import phase
from refcloud.transport import ScatteredLight, sun_depths
from refcloud.transport.scattering import harmonics_toward, source_terms


@checked
def solved_march(
    grid: VoxelGrid,
    camera: Camera | OrthographicCamera,
    *,
    light: ScatteredLight,
    step: Step,
    tolerance: Tolerance = 0.0,
    seed: Seed = 0,
    observe: Observer | None = None,
) -> tuple[Array, Array, tuple[Skipped, ...]]:
    """March a camera's rays through a cloud whose light is solved.

    Formula: `march_shining` with the color sum over suns of E albedo sigma / sigma'
    phase T'_sun, plus J toward the eye

    Parameters
    ----------
    grid
        The cloud map.
    camera
        The eye.
    light
        Of `scattered_light`, in this cloud map or in one of its `block_means`, with
        sigma_t and albedo as numbers.
    step, tolerance, seed, observe
        As `octave_march`; the tolerance counts against 0 under the same light.

    Returns
    -------
    Radiance of shape (H, W, 3), transmittance of shape (H, W), and rows of what was
    skipped.

    Raises
    ------
    ValueError
        The medium is coloured; as `octave_march`.

    Source: an extension of document D (R05).
    """
    medium = light.medium
    refuse_coloured(medium)
    sigma = float(light.sigma_t[0])
    kept = float(medium.sigma_t_rgb[0]) / sigma if sigma > 0.0 else 1.0
    dtype: DType = "float32" if tolerance >= SINGLE_PRECISION else "float64"
    watch = observe or (lambda name, value: None)
    cloud = shining_of(grid, sigma, dtype)
    # 1. Columns toward each sun, and the solved source of each of its voxels.
    columns = []
    for s, sun in enumerate(light.suns):
        volume = sun_depths(grid, sun.direction, dtype=dtype)
        watch(f"sun {s} depths", volume)
        columns.append(np.asarray(volume.density))
    source = _toward_eye(light, camera)
    # 2. The color of each sample that has cloud beside it, toward the eye.
    size = cell_size(grid)
    solved = (light.upper - light.lower) / np.array(light.shape[::-1])
    k, j, i = np.nonzero(beside(cloud))
    for first in range(0, len(k), CHUNK):
        part = slice(first, first + CHUNK)
        where = k[part], j[part], i[part]
        seen = seen_along(grid, camera, where)
        places = grid.lower + (np.stack(where[::-1], axis=1) + 0.5) * size
        colors = clamped_trilinear(source, *((places - light.lower) / solved - 0.5).T)
        for sun, column in zip(light.suns, columns, strict=True):
            cosines = np.clip(seen @ sun.direction, -1.0, 1.0)
            T = np.exp(-sigma * column[where].astype(np.float64))
            once = kept * phase(medium, cosines) * T
            colors += once[:, None] * (sun.irradiance * medium.albedo_rgb)
        cloud.table[1:-1, 1:-1, 1:-1, :3][where] = colors
    bordered(cloud.table[..., :3])
    watch("shining", cloud)
    # 3. March.
    brightest = max(float(cloud.table[..., :3].max()), 1.0)
    least = FRONT_SHARE * tolerance / brightest
    return marched(cloud, camera, step=step, least=least, seed=seed)


@checked
def block_means(grid: VoxelGrid, *, most: int) -> VoxelGrid:
    """Average a cloud map over cubes of voxels until no axis has more than some.

    Formula: n^3 voxels make one, n the least that leaves `most` along the longest axis

    Parameters
    ----------
    grid
        The cloud map.
    most
        Voxels along the longest axis, at most; at least 1.

    Returns
    -------
    The coarser map; its box may reach farther up by parts of a voxel, empty ones.

    Source: an extension of document D (R05).

    Examples
    --------
    >>> block_means(VoxelGrid(np.ones((3, 4, 2)), [0, 0, 0], [2, 4, 3]), most=2).density
    array([[[1. ],
            [1. ]],
    <BLANKLINE>
           [[0.5],
            [0.5]]])
    """
    n = -(-max(grid.density.shape) // max(most, 1))
    padded = np.pad(grid.density, [(0, -size % n) for size in grid.density.shape])
    D, H, W = (size // n for size in padded.shape)
    density = padded.reshape(D, n, H, n, W, n).mean(axis=(1, 3, 5))
    upper = grid.lower + n * np.array([W, H, D]) * cell_size(grid)
    return VoxelGrid(sealed(density), grid.lower, upper)


def _toward_eye(light: ScatteredLight, camera: Camera | OrthographicCamera) -> Array:
    """Give the solved source of each voxel toward the eye, (D, H, W, 3)."""
    box = VoxelGrid(sealed(np.zeros(light.shape)), light.lower, light.upper)
    where = tuple(index.ravel() for index in np.indices(light.shape))
    toward = -seen_along(box, camera, where)
    found = np.zeros((len(toward), 3))
    weights = harmonics_toward(light, toward, 0)
    for c, (_, case, factor) in enumerate(light.channels):
        terms = source_terms(light)[0][:, case].reshape(weights.shape[1], -1)
        J = np.einsum("sr,rs->s", weights, terms)
        found[:, c] = factor * np.maximum(J, 0.0)
    return found.reshape(*light.shape, 3)
