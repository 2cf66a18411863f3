"""Every way to light a cloud beside the truth: pictures, differences, errors, costs."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from refcloud.camera import AnyCamera, rays
from refcloud.checking import checked
from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.cloudmap.sample import clamped_trilinear
from refcloud.conventions import Array
from refcloud.image import Picture
from refcloud.lighting.octaves import Octaves, octave_source
from refcloud.march import integrate
from refcloud.march.cells import lattice
from refcloud.march.glow import Samples, by_steps
from refcloud.optics import Medium, Sun, coupling_man2003, phase
from refcloud.transport import (
    Diffused,
    beer_powder,
    diffuse_source,
    diffused_light,
    forward_depth,
    scattered_light,
    sun_depths,
)
from refcloud.transport.plans import GradeName

# Wrenninge's A = B = C = 1/2 in eight octaves; no backward lobe and no sky.
WRENNINGE = Octaves(
    8,
    extinction=0.5,
    contribution=0.5,
    narrowing=0.5,
    backward_share=0.0,
    sky_light=np.zeros(3),
    ground_light=np.zeros(3),
)
STEP = 0.5  # of a voxel's edge, between samples of a ray
TOLERANCE = 0.01  # of the marches under the solved light
SPREAD = 0.15  # of the brightest: a difference as large is fully red or blue

Way = Callable[[VoxelGrid, Array, Array, Sun, Medium], Array]


@dataclass(frozen=True)
class Compared:
    """One way beside the truth.

    Attributes
    ----------
    name
        Of the way.
    radiance
        Shape (H, W), the first channel.
    error
        Relative RMSE against the truth.
    share
        Sum of the picture over that of the truth.
    seconds
        CPU time, the march of the picture with it.
    """

    name: str
    radiance: Array
    error: float
    share: float
    seconds: float


def single(
    grid: VoxelGrid, origins: Array, directions: Array, sun: Sun, medium: Medium
) -> Array:
    """Light that is scattered once."""
    lit = integrate(
        grid, origins, directions, suns=sun, medium=medium, tolerance=TOLERANCE
    )
    return lit[0][:, 0]


def powder(
    grid: VoxelGrid, origins: Array, directions: Array, sun: Sun, medium: Medium
) -> Array:
    """Single scattering with Beer-powder in place of Beer's law."""

    def source(tau: Array, cosine: Array) -> Array:
        return medium.albedo_rgb[0] * phase(medium, cosine) * beer_powder(tau)

    return _sunlit(grid, origins, directions, sun, medium, source)


def forward(
    grid: VoxelGrid, origins: Array, directions: Array, sun: Sun, medium: Medium
) -> Array:
    """Sunlight by the paper's recurrence (eq 27), from voxel to voxel."""
    sigma = float(medium.sigma_t_rgb[0])
    edge = float(np.cbrt(cell_size(grid).prod()))
    seeming = forward_depth(sigma * edge * grid.density, kappa=coupling_man2003())
    passed = replace(grid, density=seeming / max(sigma * edge, 1e-300))

    def source(tau: Array, cosine: Array) -> Array:
        return medium.albedo_rgb[0] * phase(medium, cosine) * np.exp(-tau)

    return _sunlit(grid, origins, directions, sun, medium, source, passed)


def octaves(
    grid: VoxelGrid, origins: Array, directions: Array, sun: Sun, medium: Medium
) -> Array:
    """Eight octaves of single scattering."""
    g, albedo = medium.g if medium.phase == "hg" else 0.0, float(medium.albedo_rgb[0])

    def source(tau: Array, cosine: Array) -> Array:
        return octave_source(cosine, tau, g=g, albedo=albedo, octaves=WRENNINGE)

    return _sunlit(grid, origins, directions, sun, medium, source)


def diffusion(
    grid: VoxelGrid, origins: Array, directions: Array, sun: Sun, medium: Medium
) -> Array:
    """Diffusion with the delta-Eddington scaling, over single scattering."""
    light: Diffused = diffused_light(grid, sun, medium=medium)
    middle = directions.mean(axis=0)  # phi + 3 g F . w hardly turns over a picture
    field = diffuse_source(light, -middle)
    samples = _samples(grid, origins, directions)
    cells = ((samples.points - grid.lower) / cell_size(grid) - 0.5).T
    J = clamped_trilinear(field, *cells)
    seen = np.exp(-light.sigma_t * samples.column)
    seen *= -np.expm1(-light.sigma_t * samples.mass)
    diffuse = np.bincount(samples.ray, seen * J, len(origins)) * sun.irradiance[0]
    peeled = float(medium.sigma_t_rgb[0]) * float(medium.albedo_rgb[0]) / light.sigma_t
    once = single(
        grid,
        origins,
        directions,
        replace(sun, irradiance=sun.irradiance * peeled),
        Medium(light.sigma_t, 1.0, medium.g, medium.phase),
    )
    return once + diffuse


def solved(plan: GradeName) -> Way:
    """Light that was solved by a plan."""

    def way(
        grid: VoxelGrid, origins: Array, directions: Array, sun: Sun, medium: Medium
    ) -> Array:
        light = scattered_light(grid, sun, medium=medium, plan=plan)
        L, _ = integrate(
            grid,
            origins,
            directions,
            suns=sun,
            medium=medium,
            scattering=light,
            tolerance=TOLERANCE,
        )
        return L[:, 0]

    return way


WAYS: dict[str, Way] = {
    "single scattering": single,
    "forward recurrence (man2003)": forward,
    "Beer-powder": powder,
    "octaves (Wrenninge 2013)": octaves,
    "P1 diffusion": diffusion,
    "26 and 50 directions, quick": solved("quick"),
    "26 and 50 directions, standard": solved("standard"),
    "50 and 128 directions, reference": solved("reference"),
}


@checked
def compare_ways(
    grid: VoxelGrid,
    camera: AnyCamera,
    *,
    sun: Sun,
    medium: Medium,
    truth: Array | None = None,
) -> list[Compared]:
    """Draw a cloud in every way, and measure each against the truth.

    Formula: error = |L - L_true| / |L_true|, lengths over all pixels

    Parameters
    ----------
    grid
        The cloud map.
    camera
        The eye.
    sun, medium
        The light, and what the cloud is made of; first channels are compared.
    truth
        Shape (H, W); None takes the plan "finest", which stands last in the list.

    Returns
    -------
    One entry for each way.

    Source: an extension of paper M (multiple scattering, X09).
    """
    origins, directions = (v.reshape(-1, 3) for v in rays(camera))
    shape = (camera.height, camera.width)
    drawn, ways = [], dict(WAYS)
    if truth is None:
        ways["128 directions, finest"] = solved("finest")
    for name, way in ways.items():
        start = time.process_time()
        L = way(grid, origins, directions, sun, medium)
        drawn.append((name, L.reshape(shape), time.process_time() - start))
    true = drawn[-1][1] if truth is None else truth
    size = max(float(np.sqrt(np.square(true).sum())), 1e-300)
    return [
        Compared(
            name,
            L,
            float(np.sqrt(np.square(L - true).sum())) / size,
            float(L.sum()) / max(float(true.sum()), 1e-300),
            seconds,
        )
        for name, L, seconds in drawn
    ]


def figure_of_ways(compared: list[Compared], true: Array) -> Picture:
    """Lay pictures out in a row, and what each is off below: red too bright, blue dark.

    Parameters
    ----------
    compared
        Of `compare_ways`.
    true
        Shape (H, W).

    Returns
    -------
    The figure, (2 H, n W).
    """
    brightest = max(float(true.max()), 1e-300)
    top = [np.repeat((c.radiance / brightest)[..., None], 3, axis=2) for c in compared]
    below = []
    for c in compared:
        off = np.clip((c.radiance - true) / (SPREAD * brightest), -1.0, 1.0)
        red, blue = np.maximum(-off, 0.0), np.maximum(off, 0.0)
        below.append(np.stack([1.0 - red, 1.0 - red - blue, 1.0 - blue], axis=2))
    rows = [np.concatenate(row, axis=1) for row in (top, below)]
    return Picture(np.concatenate(rows, axis=0))


def _samples(grid: VoxelGrid, origins: Array, directions: Array) -> Samples:
    apart = STEP * float(cell_size(grid).min())
    return by_steps(lattice(grid), origins, directions, apart)


def _sunlit(
    grid: VoxelGrid,
    origins: Array,
    directions: Array,
    sun: Sun,
    medium: Medium,
    source: Callable[[Array, Array], Array],
    passed: VoxelGrid | None = None,
) -> Array:
    """March with a source that knows the depth to the sun and the cosine alone."""
    sigma = float(medium.sigma_t_rgb[0])
    columns = sun_depths(grid if passed is None else passed, sun.direction).density
    samples = _samples(grid, origins, directions)
    cells = ((samples.points - grid.lower) / cell_size(grid) - 0.5).T
    tau = sigma * clamped_trilinear(np.asarray(columns), *cells)
    cosine = np.clip(directions[samples.ray] @ sun.direction, -1.0, 1.0)
    seen = np.exp(-sigma * samples.column) * -np.expm1(-sigma * samples.mass)
    light = np.bincount(samples.ray, seen * source(tau, cosine), len(origins))
    return light * sun.irradiance[0]
