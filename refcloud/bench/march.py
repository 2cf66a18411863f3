"""The march benchmark: time against error for each way to light and see a cloud map.

The scene is a cloud of a sixth of its box, [-1, 1]^3, at 128^3 voxels, with an optical
depth of an eighth per voxel, under an oblique sun, seen at 512 x 384. The reference is
the quadrature of `refcloud.march.integrate` on every eighth pixel of every eighth row.
What would take minutes is timed on those pixels alone: times are of a whole frame, in
proportion to rays. (Small lists of rays stay in a cache: that is in favour of them.)
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from refcloud.bench.march_gl import Shader
from refcloud.bench.subject import Subject, Unit
from refcloud.bench.timing import Contender
from refcloud.camera import Camera, rays
from refcloud.cloudmap import VoxelGrid, cell_centres, trilinear
from refcloud.conventions import Array
from refcloud.march import integrate, march_by_steps, ray_box, sun_depth_by_steps
from refcloud.march.slices import march_slices
from refcloud.noise import fbm_grid
from refcloud.optics import Medium, Sun
from refcloud.transport import LightVolume, column_density, sun_depths

WIDTH, HEIGHT = 512, 384
EVERY = 8  # pixels along rows and along columns between those that are compared
SIGMA_T = 8.0  # an eighth per voxel of 128 in two units
SUN = Sun(np.array([-0.5, 0.7, 0.4]))
BACKLIGHT = Sun(np.array([-0.4, -0.1, -1.0]))
EYE = np.array([1.5, 1.0, 3.2])
FOV_Y = math.radians(30.0)
FRAME = WIDTH * HEIGHT
FINE = 64  # voxels a side


@dataclass(frozen=True)
class Scene:
    """A cloud, a camera, a sun, and what is exactly seen of it on some pixels."""

    grid: VoxelGrid
    camera: Camera
    sun: Sun
    medium: Medium
    origins: Array  # (N, 3), of the pixels that are compared
    directions: Array
    exact: Array  # (N,), one channel

    def compared(self, picture: Array) -> Array:
        """Take the compared pixels and one channel of a whole frame (H, W, 3)."""
        return picture[COMPARED][..., 0].reshape(-1)


COMPARED = (slice(EVERY // 2, None, EVERY), slice(EVERY // 2, None, EVERY))


def cloud(size: int) -> VoxelGrid:
    """Make the cloud."""
    x = (np.arange(size) + 0.5) / size * 2.0 - 1.0
    noise, _ = fbm_grid(2.0 * x, 2.0 * x, 2.0 * x, seed=3, octaves=3)
    square = x[:, None, None] ** 2 + x[:, None] ** 2 + x**2
    density = np.clip((0.46 - square + 1.3 * noise) * 1.7, 0.0, 1.0)
    return VoxelGrid(density, -np.ones(3), np.ones(3))


@functools.cache
def scene(size: int, sigma_t: float, behind: bool) -> Scene:
    """Set a scene up, and integrate it exactly where it is compared."""
    grid, sun = cloud(size), BACKLIGHT if behind else SUN
    medium = Medium(sigma_t, phase="isotropic")
    camera = Camera(EYE, np.zeros(3), fov_y=FOV_Y, width=WIDTH, height=HEIGHT)
    origins, directions = (a[COMPARED].reshape(-1, 3) for a in rays(camera))
    exact, _ = integrate(grid, origins, directions, suns=sun, medium=medium)
    return Scene(grid, camera, sun, medium, origins, directions, exact[:, 0])


def relative_error(found: Array, exact: Array) -> float:
    """Give the root mean square error over the root mean square."""
    return float(np.linalg.norm(found - exact) / np.linalg.norm(exact))


def steps_with_volume(of: Scene, volume: LightVolume, steps: int) -> Array:
    """March compared rays in equal steps, with the sun's light read from a volume."""
    lit = VoxelGrid(np.exp(-SIGMA_T * volume.density), volume.lower, volume.upper)
    o, d = of.origins, of.directions
    t0, t1 = ray_box(o, d, lower=of.grid.lower, upper=of.grid.upper)
    dt = np.maximum(t1 - t0, 0.0) / steps
    L, T = np.zeros(len(o)), np.ones(len(o))
    for step in range(steps):
        points = o + (np.where(dt > 0.0, t0, 0.0) + (step + 0.5) * dt)[:, None] * d
        alpha = -np.expm1(-SIGMA_T * trilinear(of.grid, points) * dt)
        L += T * alpha * trilinear(lit, points)
        T *= 1.0 - alpha
    return L


def sliced(
    of: Scene,
    side: int | None,
    scale: Any,
    kept: list[LightVolume] | None = None,
    unbiased: bool = False,
) -> Array:
    """March the whole frame by slices, with a light volume that is kept or made."""
    toward = of.sun.direction
    depths = kept or [sun_depths(of.grid, toward, scale=scale, dtype="float32")]
    how: dict[str, Any] = {"suns": (of.sun,), "medium": of.medium, "side": side}
    picture = march_slices(of.grid, of.camera, depths=depths, unbiased=unbiased, **how)
    assert picture is not None
    return of.compared(picture[0])


def pictures(size: int) -> list[Contender]:
    """List the ways to make a frame; ratios are to the naive march of 64 x 16."""
    of = scene(size, SIGMA_T, False)
    few = len(of.origins)
    found: list[Contender] = []

    def enter(name: str, samples: int, work: Callable[[], Array], **more: Any) -> None:
        task = "frame"
        exact = functools.partial(np.asarray, of.exact)
        found.append(
            Contender(task, name, samples, work, exact, distance=relative_error, **more)
        )

    def naive(segment: Any) -> Array:
        return march_by_steps(
            of.grid,
            *(of.origins, of.directions),
            suns=of.sun,
            medium=of.medium,
            sample_rate=64,
            sun_sample_rate=16,
            segment=segment,
        )[0][:, 0]

    enter("naive 64 x 16", few, lambda: naive("beer"), rival=True)
    enter("naive 64 x 16, Euler", few, lambda: naive("euler"))
    kept = sun_depths(of.grid, of.sun.direction)
    for steps in (64, 128):
        name = f"naive {steps}, light volume kept"
        enter(name, few, functools.partial(steps_with_volume, of, kept, steps))
    singly = [sun_depths(of.grid, of.sun.direction, dtype="float32")]
    for side in (96, 128, None, 256):
        label = f"side {side}" if side else "1.25 per voxel"
        enter(f"slices, {label}", FRAME, functools.partial(sliced, of, side, 1))
        more = functools.partial(sliced, of, side, 1, singly)
        enter(f"slices, {label}, light volume kept", FRAME, more)
    enter("slices, side 256, light at 2x", FRAME, functools.partial(sliced, of, 256, 2))
    # In a coarser grid no setting may hold the tolerance: all rays would be exact.
    for tolerance in (0.02, 0.01, 1.0 / 255.0) if size >= FINE else ():

        def gathered(tolerance: float = tolerance) -> Array:
            origins, directions = rays(of.camera)
            how: dict[str, Any] = {"suns": of.sun, "medium": of.medium}
            return of.compared(
                integrate(of.grid, origins, directions, tolerance=tolerance, **how)[0]
            )

        enter(f"any rays, tolerance {tolerance:.2g}, checked", FRAME, gathered)
    if shader := Shader.here(of.grid, kept, SIGMA_T):
        toward = of.sun.direction
        for steps, sunward in ((64, 16), (64, 0), (128, 0)):
            work = functools.partial(shader.frame, of.camera, toward, steps, sunward)
            kind = f"x {sunward}" if sunward else "steps, light volume kept"
            name = f"{shader.name}, {steps} {kind}"
            enter(name, FRAME, lambda work=work: of.compared(work()), peer=True)
    return found


def behind(size: int) -> list[Contender]:
    """List ways to see a coarse cloud with the sun behind it: a quarter per voxel."""
    of = scene(size // 2, SIGMA_T, True)
    found = []
    for scale, side, unbiased in (
        (1, None, False),
        (1, 160, False),
        (1, 144, True),
        (2, 128, False),
        (2, 192, False),
        (2, 192, True),
    ):
        label = f"side {side}" if side else "1.25 per voxel"
        kind = ", unbiased" if unbiased else ""
        found.append(
            Contender(
                "frame, sun behind",
                f"slices, {label}, light at {scale}x{kind}",
                FRAME,
                functools.partial(sliced, of, side, scale, None, unbiased),
                lambda: of.exact,
                distance=relative_error,
            )
        )
    return found


def light(size: int) -> list[Contender]:
    """List ways to the optical depths of all occupied voxels; ratios to 32 steps."""
    grid, toward = cloud(size), SUN.direction
    cells = np.argwhere(grid.density > 0.0)
    x, y, z = cell_centres(grid)
    all_ = np.stack([x[cells[:, 2]], y[cells[:, 1]], z[cells[:, 0]]], axis=1)
    few = slice(None, None, 29)  # a prime: no plane of voxels is left out
    points, where = all_[few], tuple(cells[few].T)
    exact = column_density(grid, points, toward)
    found = []
    for steps in (16, 32, 64):
        work = functools.partial(
            sun_depth_by_steps, grid, points, direction=toward, sample_rate=steps
        )
        name = f"march of {steps} steps from each voxel"
        found.append(
            Contender(
                "light volume",
                name,
                round(FRAME * len(points) / len(all_)),
                work,
                lambda: exact,
                rival=steps == 32,
                distance=relative_error,
            )
        )
    for scale, dtype in ((1, "float64"), (1, "float32"), (2, "float32")):

        def whole(scale: Any = scale, dtype: Any = dtype) -> Array:
            depths = sun_depths(grid, toward, scale=scale, dtype=dtype).density
            if scale == 1:
                return depths[where]
            k, j, i = (2 * axis for axis in where)
            return depths[k + 1, j + 1, i + 1]

        reference = exact
        if scale == 2:
            shift = 0.25 * (grid.upper - grid.lower) / size
            reference = column_density(grid, points + shift, toward)
        found.append(
            Contender(
                "light volume",
                f"sheared accumulator, {scale}x, {dtype}",
                FRAME,
                whole,
                functools.partial(np.asarray, reference),
                distance=relative_error,
            )
        )
    return found


MARCH = Subject(
    name="march",
    title="a marched frame: steps, quadrature, light volumes, slices, tolerances",
    about="CPU time of a 512 x 384 frame of a 128^3 cloud (light volume: of all its"
    " voxels), medians; error: relative RMSE against the exact quadrature",
    lists=((pictures, 128, 32), (behind, 128, 32), (light, 128, 32)),
    peers=("moderngl",),
    # Nanoseconds a ray, as milliseconds a frame; a light volume counts as one.
    unit=Unit("ms", 1e6 / FRAME),
    digits=2,
    reference="the quadrature of tolerance 0, 1e-9 from its plain twin",
)
