"""What the door chooses where the caller does not: sun, sky's light, medium, frame."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from refcloud.camera import AnyCamera, Camera, frame
from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.conventions import SIZES, WHOLE_SPHERE
from refcloud.lighting import Look
from refcloud.lighting.depths import through_the_middle
from refcloud.march.quadrature import grid_through_the_middle
from refcloud.metaballs import Metaballs
from refcloud.optics import ALBEDO_MAN2003, Medium, Sun
from refcloud.refusal import complaint

# Optical depth through a cloud's middle where the caller names no medium: a cumulus of
# this thickness lets almost nothing through its middle and still has soft edges.
THICKNESS = 40.0
# Marched, light that was scattered once comes from the outermost units of optical
# depth; a cloud map's voxels hold them where the middle is no thicker than this.
MARCHED_THICKNESS = 16.0
# Late-morning sun from the front left, a little warm; relief keeps back a part of it.
SUN = Sun(
    np.array([-0.62, 0.62, 0.42]),
    1.75 * WHOLE_SPHERE * np.array([1.0, 0.96, 0.89]),
)
# Solved light loses nothing to orders that are left out: so weak a sun makes the
# brightest parts of a cloud nearly white, where the other leaves a tenth of it blank.
SOLVED_SUN = Sun(SUN.direction, SUN.irradiance * (0.5 / 1.75))
# Mean radiance of a clear sky above and a grey ground below, by eye.
AMBIENT = np.array([0.15, 0.21, 0.32])


def default_sun(scattering: object) -> tuple[Sun, str]:
    """Choose a sun for light scattered once or for solved light, and say which."""
    if scattering is None or scattering == "single":
        return SUN, ""
    light = " ".join(f"{value:.3g}" for value in SOLVED_SUN.irradiance)
    return SOLVED_SUN, f"sun: irradiance {light}, for the brightest to be near white"


def default_medium(
    cloud: Metaballs | VoxelGrid,
    look: Look | None,
    *,
    density: float = 1.0,
    **changes: Any,
) -> tuple[Medium, str]:
    """Choose a medium, and say which; a look is for clouds that are splatted.

    Changes are fields of the medium, instead of the choice. The choice is for the cloud
    as it is given, before a factor on its density.
    """
    if look is not None and look.tau is not None:
        medium = replace(Medium(1.0, ALBEDO_MAN2003), **changes)
        albedo = " ".join(f"{share:g}" for share in np.atleast_1d(medium.albedo))
        note = f"medium: tau {look.tau:g} for every ball, albedo {albedo}"
        idle = ["sigma_t"] * ("sigma_t" in changes) + ["density"] * (density != 1.0)
        return medium, note + (f"; no {' or '.join(idle)} counts" if idle else "")
    thickness = MARCHED_THICKNESS if look is None else THICKNESS
    if isinstance(cloud, VoxelGrid):
        per_unit = grid_through_the_middle(cloud)
    else:
        per_unit = through_the_middle(cloud, 1.0)
    if not per_unit > thickness / 1e300:
        note = "medium: sigma_t 1, since the cloud's middle is empty"
        return replace(Medium(1.0), **changes), note
    sigma_t = thickness / per_unit
    depth = f"optical depth {density * thickness:g} in the middle"
    note = f"medium: sigma_t {sigma_t:.4g}, {depth}"
    return replace(Medium(sigma_t), **changes), note


def size_of(
    width: int | None,
    height: int | None,
    quality: str,
    camera: AnyCamera | None = None,
) -> tuple[int, int]:
    """Complete a picture's size; one side alone keeps the shape of the default.

    Raises
    ------
    ValueError
        A camera is given, and its size is another.
    """
    if camera is not None:
        own = {"width": camera.width, "height": camera.height}
        for name, value in (("width", width), ("height", height)):
            if value not in (None, own[name]):
                expected = f"none beside a camera, or its {own[name]}"
                advice = f"make the camera with another {name}"
                raise ValueError(complaint(name, expected, f"{value}", advice))
        return camera.width, camera.height
    across, down = SIZES[quality]
    if width is None and height is None:
        return across, down
    if width is None:
        return max(round((height or 1) * across / down), 1), height or 1
    return width, height or max(round(width * down / across), 1)


def framed(cloud: Metaballs | VoxelGrid, width: int, height: int) -> Camera:
    """Frame what a cloud fills; an empty one gets a unit box, or the map's own."""
    if isinstance(cloud, VoxelGrid):
        lower, upper = _filled(cloud)
        return frame(lower, upper, width=width, height=height)
    if not len(cloud.radii):
        return frame(-np.ones(3), np.ones(3), width=width, height=height)
    lower = (cloud.centers - cloud.radii[:, None]).min(axis=0)
    upper = (cloud.centers + cloud.radii[:, None]).max(axis=0)
    return frame(lower, upper, width=width, height=height)


def _filled(grid: VoxelGrid) -> tuple[np.ndarray, np.ndarray]:
    """Give the corners of the occupied voxels' box."""
    size = cell_size(grid)
    lower, upper = grid.lower.copy(), grid.upper.copy()
    occupied = grid.density > 0.0
    for axis, n in enumerate(grid.density.shape[::-1]):
        across = tuple(k for k in range(3) if k != 2 - axis)
        where = np.flatnonzero(occupied.any(axis=across))
        if len(where):
            lower[axis] += where[0] * size[axis]
            upper[axis] -= (n - 1 - where[-1]) * size[axis]
    return lower, upper
