"""One march for every caller: what was found, left out and noted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from refcloud.camera import AnyCamera
from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.conventions import Array, Observer, Skipped
from refcloud.extremes import refuse_bright, refuse_far, refuse_small
from refcloud.march.balls import exact_balls
from refcloud.march.cells import lattice
from refcloud.march.certified import to_tolerance
from refcloud.march.light import sources
from refcloud.march.mixing import Mixing
from refcloud.march.task import Task, completed
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun
from refcloud.refusal import complaint
from refcloud.transport import LightVolume
from refcloud.transport.cut_out import thickest_voxel

# Optical depth of one voxel above which the answer of `tolerance=0` itself is off by
# more than a ten-thousandth of white: shadows are sharper than the Gauss points.
STEEPEST = 3.0
COARSEST = 0.05  # optical depth in the last digit of a coordinate
BOUNDED = 1e300  # optical depths: their sums stay numbers


@dataclass(frozen=True)
class Marched:
    """What a march found.

    Attributes
    ----------
    radiance
        Shape (N, 3); with what lies behind, where there is such.
    transmittance
        Shape (N, 1), or (N, 3) where sigma_t is RGB.
    skipped, notes
        What was left out, and what is to be told.
    """

    radiance: Array
    transmittance: Array
    skipped: tuple[Skipped, ...] = ()
    notes: tuple[str, ...] = ()


def marched(
    cloud: VoxelGrid | Metaballs,
    origins: Array,
    directions: Array,
    *,
    suns: tuple[Sun, ...],
    medium: Medium,
    ambient: Array | None,
    mixing: Mixing,
    tolerance: float,
    background: Array | None = None,
    observe: Observer | None = None,
    camera: AnyCamera | None = None,
    volumes: tuple[LightVolume, ...] = (),
    shape: tuple[int, ...] = (),
) -> Marched:
    """March rays, unchecked: the inner form of `integrate`.

    Parameters
    ----------
    cloud
        The cloud.
    origins, directions
        Shape (N, 3) each, scene units; unit vectors.
    suns, medium, ambient, mixing, tolerance, observe
        As `integrate`.
    background
        What lies behind each ray, shape (N, 3); None for nothing.
    camera
        Whose rays they are, row by row; None for any rays.
    volumes
        As `integrate`.
    shape
        Leading axes of the rays: which of them are neighbours.

    Returns
    -------
    What was found.
    """
    refuse_far("origins", origins)
    for sun in suns:
        refuse_bright("suns", sun.irradiance)
    for name, light in (("background", background), ("ambient", ambient)):
        if light is not None:
            refuse_bright(name, light)
    if isinstance(cloud, Metaballs):
        if volumes:
            expected = "none beside metaballs, whose light has a closed form"
            raise ValueError(complaint("volumes", expected, "some", "leave them out"))
        return _balls_marched(
            cloud, origins, directions, suns, medium, ambient, mixing, background
        )
    refuse_unbounded(cloud, medium)
    refuse_far("cloud", [cloud.lower, cloud.upper])
    refuse_small("cloud", cell_size(cloud))
    _refuse_coarse(cloud, medium, origins)
    suns, dark = without_dark(suns, medium)
    task = Task(
        cloud,
        lattice(cloud),
        origins,
        directions,
        suns,
        sources(suns, medium, directions=directions),
        medium,
        mixing,
        np.zeros(3) if ambient is None else ambient,
        background,
        camera,
        volumes,
        shape,
    )
    if tolerance > 0.0:
        radiance, column, rows, notes = to_tolerance(task, tolerance, observe)
    else:
        (radiance, column), rows, notes = task.exact(), (), ()
    seen, through = completed(
        radiance, column, medium, mixing, task.ambient, background
    )
    return Marched(seen, through, dark + rows, notes + steep_note(cloud, medium))


def _balls_marched(
    balls: Metaballs,
    origins: Array,
    directions: Array,
    suns: tuple[Sun, ...],
    medium: Medium,
    ambient: Array | None,
    mixing: Mixing,
    background: Array | None,
) -> Marched:
    """March metaballs: exact at any tolerance."""
    with np.errstate(over="ignore"):
        whole = float((balls.densities * balls.radii).sum(initial=0.0))
        depth = float(np.max(medium.sigma_t) * np.float64(whole))
    if not depth < BOUNDED:
        _refuse_depth()
    refuse_far("cloud", balls.centers)
    refuse_far("cloud", balls.radii)
    refuse_small("cloud", balls.radii)
    lit = sources(suns, medium, directions=directions)
    found = exact_balls(balls, origins, directions, suns, lit, medium, mixing)
    light = np.zeros(3) if ambient is None else ambient
    return Marched(*completed(*found, medium, mixing, light, background))


def without_dark(
    suns: tuple[Sun, ...], medium: Medium
) -> tuple[tuple[Sun, ...], tuple[Skipped, ...]]:
    """Leave out suns that add nothing in any channel, and report them.

    Parameters
    ----------
    suns, medium
        The lights, and the albedo that they count with.
    """
    lit = tuple(sun for sun in suns if (sun.irradiance * medium.albedo_rgb).any())
    dark = len(suns) - len(lit)
    if not dark:
        return suns, ()
    return lit, (Skipped("light", "suns without light", dark, len(suns)),)


def refuse_unbounded(grid: VoxelGrid, medium: Medium) -> None:
    """Refuse optical depths that are no longer numbers."""
    densest = float(grid.density.max())
    with np.errstate(over="ignore"):
        across = np.sqrt(np.square(grid.upper - grid.lower).sum())
        largest = float(np.max(medium.sigma_t)) * densest * across
    if not largest < BOUNDED:
        _refuse_depth()


def _refuse_coarse(grid: VoxelGrid, medium: Medium, origins: Array) -> None:
    """Refuse clouds whose optical depth changes within the rounding of a coordinate.

    The light is then off by a tenth of that change, as was measured on an even cube at
    offsets of 0 to 1e9 and optical depths of 1e4 to 1e15.
    """
    farthest = max(
        float(np.abs(part).max(initial=0.0))
        for part in (grid.lower, grid.upper, origins)
    )
    extinction = float(np.max(medium.sigma_t)) * float(grid.density.max())
    if not extinction * float(np.spacing(farthest)) <= COARSEST:
        expected = f"at most {COARSEST:g} of optical depth in a coordinate's last digit"
        advice = "lower sigma_t, or move cloud and eye nearer to the origin"
        got = f"{extinction:.4g} a scene unit at coordinates of {farthest:.4g}"
        raise ValueError(complaint("sigma_t", expected, got, advice))


def _refuse_depth() -> NoReturn:
    expected = f"an optical depth below {BOUNDED:g} across the cloud"
    raise ValueError(complaint("sigma_t", expected, "more", "lower sigma_t"))


def steep_note(grid: VoxelGrid, medium: Medium) -> tuple[str, ...]:
    """Note a cloud map whose voxels are too coarse for its optical depth."""
    tau = thickest_voxel(grid, medium)
    if tau <= STEEPEST:
        return ()
    return (
        f"optical depth {tau:.3g} in one voxel: above {STEEPEST:g} edges of shadows are"
        " finer than the voxels; lower sigma_t or use smaller voxels",
    )
