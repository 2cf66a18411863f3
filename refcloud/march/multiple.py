"""Every order of scattering along rays: once exactly, the rest as it was solved."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from refcloud.camera import AnyCamera
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Array, Observer, Skipped
from refcloud.march.glowing import glow_within
from refcloud.march.marched import Marched, marched
from refcloud.march.mixing import PHYSICAL, Mixing
from refcloud.metaballs import Metaballs, sampled_map
from refcloud.optics import Medium, Sun
from refcloud.refusal import complaint
from refcloud.transport import PLANS, LightVolume, ScatteredLight, scattered_light
from refcloud.transport.cut_out import thickest_voxel
from refcloud.transport.plans import plan_for
from refcloud.transport.scattering import report_of

Scattering = Literal["single", "multiple"] | ScatteredLight | tuple[ScatteredLight, ...]
# Shares of a tolerance. Solutions gain most: each is several times as long as the next.
SOLVED, ALONG_RAYS = 0.5, 0.5
FINEST = 128  # directions of the plan "finest"


def marched_multiple(
    cloud: VoxelGrid | Metaballs,
    origins: Array,
    directions: Array,
    *,
    scattering: Scattering,
    suns: tuple[Sun, ...],
    medium: Medium,
    ambient: Array | None,
    mixing: Mixing = PHYSICAL,
    tolerance: float,
    background: Array | None = None,
    observe: Observer | None = None,
    camera: AnyCamera | None = None,
    volumes: tuple[LightVolume, ...] = (),
    shape: tuple[int, ...] = (),
) -> Marched:
    """March rays through solved light, unchecked: the inner form of `integrate`.

    Formula: int T' (sigma albedo p E T'_sun + sigma' J) rho dt + (T' - T) ambient: the
    forward peak counts as unscattered on both ways of both parts

    Parameters
    ----------
    cloud, origins, directions
        As `marched`.
    scattering
        "multiple", or light that was solved before for this cloud.
    suns, medium, ambient, mixing, tolerance, background, observe, camera, volumes
        As `marched`; of the tolerance half goes to the solution, and a quarter each to
        the light that was scattered once and to that which was scattered more often.

    Returns
    -------
    What was found; the transmittance is the true one.
    """
    if mixing != PHYSICAL:
        expected = "none beside scattering multiple, whose light is solved without them"
        raise ValueError(complaint("mixing", expected, "one"))
    # Light among balls is solved in a map of their density.
    grid = cloud if isinstance(cloud, VoxelGrid) else sampled_map(cloud)
    light = lit_for(grid, suns, medium, ambient, scattering, tolerance)
    if observe is not None:
        observe("scattered light", light)
    # 1. Light that was scattered once, exactly, its ways dimmed by sigma' alone.
    peeled = light.sigma_t
    kept = np.divide(
        medium.sigma_t_rgb, peeled, out=np.ones(3), where=peeled > 0.0
    )  # sigma / sigma'
    grey = np.ndim(medium.sigma_t) == 0 and np.ndim(medium.albedo) == 0
    found = marched(
        cloud,
        origins,
        directions,
        suns=tuple(
            replace(sun, irradiance=sun.irradiance * medium.albedo_rgb * kept)
            for sun in suns
        ),
        medium=Medium(
            float(peeled[0]) if grey else peeled, 1.0, medium.g, medium.phase
        ),
        ambient=None,
        mixing=mixing,
        tolerance=0.5 * ALONG_RAYS * tolerance,
        observe=observe,
        camera=camera,
        volumes=volumes,
        shape=shape,
    )
    # 2. Light that was scattered more often.
    rows = (camera.height, camera.width) if camera is not None else (1, len(origins))
    glowing, told = glow_within(
        grid,
        origins,
        directions,
        light,
        0.5 * ALONG_RAYS * tolerance,
        rows=rows,
        observe=observe,
    )
    radiance = found.radiance + glowing
    # 3. What is seen through the cloud; outside light of the forward peak goes with it.
    through = found.transmittance ** (kept[:1] if grey else kept)
    if ambient is not None:
        radiance = radiance + (found.transmittance - through) * ambient
    if background is not None:
        radiance = radiance + through * background
    if np.ndim(medium.sigma_t) == 0:
        through = through[:, :1]
    told = (*found.skipped, *told)
    if tolerance > 0.0 and not isinstance(scattering, (ScatteredLight, tuple)):
        depth = thickest_voxel(grid, medium)
        if plan_for(SOLVED * tolerance, suns, medium, depth) != PLANS["finest"]:
            left = FINEST - len(light.solutions[0].level.directions.vectors)
            what, bound = "directions of the finest solution", SOLVED * tolerance
            told += (Skipped("light", what, left, FINEST, bound, how="measured"),)
    notes = (*found.notes, f"scattered light: {report_of([light])}")
    return replace(
        found, radiance=radiance, transmittance=through, skipped=told, notes=notes
    )


def lit_for(
    cloud: VoxelGrid,
    suns: tuple[Sun, ...],
    medium: Medium,
    ambient: Array | None,
    scattering: Scattering,
    tolerance: float,
) -> ScatteredLight:
    """Solve a cloud's light, or see that what was solved is of this cloud."""
    if isinstance(scattering, tuple):
        expected = "one light that was solved for all suns, beside marched rays"
        raise ValueError(complaint("scattering", expected, f"{len(scattering)} lights"))
    if isinstance(scattering, str):
        return scattered_light(
            cloud,
            suns,
            medium=medium,
            sky=ambient,
            ground=ambient,
            tolerance=SOLVED * tolerance,
        )
    light = scattering
    same = (
        (light.grid is cloud or np.array_equal(light.grid.density, cloud.density))
        and np.array_equal(light.grid.lower, cloud.lower)
        and np.array_equal(light.grid.upper, cloud.upper)
        and np.array_equal(light.medium.sigma_t_rgb, medium.sigma_t_rgb)
        and np.array_equal(light.medium.albedo_rgb, medium.albedo_rgb)
        and (light.medium.g, light.medium.phase) == (medium.g, medium.phase)
        and len(light.suns) == len(suns)
        and all(
            np.array_equal(a.direction, b.direction)
            and np.array_equal(a.irradiance, b.irradiance)
            for a, b in zip(light.suns, suns, strict=True)
        )
    )
    if not same:
        raise ValueError(
            complaint(
                "scattering",
                "light that was solved for this cloud, medium and suns",
                "that of another",
                'solve it anew, or say "multiple"',
            )
        )
    return light
