"""Probes of what draws: cameras, splats, both passes, marched rays, solvers, fits."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from refcloud import lighting, march, metaballs, raster, transport
from refcloud.bench.stability.exact import exact, exact_numbers, exp, expm1
from refcloud.bench.stability.probe import Axis, Probe
from refcloud.bench.stability.verdict import Found
from refcloud.camera import Camera, project
from refcloud.cloudmap import VoxelGrid, generate
from refcloud.lighting.lightview import BORDER
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun
from refcloud.plain import camera as plain_camera
from refcloud.plain import lighting as plain_lighting
from refcloud.plain import march as plain_march
from refcloud.plain import metaballs as plain_metaballs
from refcloud.plain import optics as plain_optics
from refcloud.plain import raster as plain_raster
from refcloud.transport import Plan, Stage

TWIN = "plain twin in 60 digits"
CLOSED = "closed form in 60 digits"
QUADRATURE = "four Gauss points in a piece of optical depth 1/2 are off by 3e-10"
OFFSETS = Axis("offset", (0.0, 1.0, 1e3, 1e6, 1e9))
LOOK = lighting.Look(buffer=5, sky_buffer=5)
PASSES = (plain_camera, plain_lighting, plain_raster, plain_metaballs, plain_optics)


def layers(alpha: float, count: int) -> Found:
    """Measure layers of one opacity in a float32 framebuffer, against white."""
    seen = raster.seen_through_layers(alpha, count, format="RGBA32F")[-1]
    return Found([seen], [(1 - exact(float(np.float32(alpha)))) ** count], scale=1.0)


def entered(distance: float, slope: float) -> Found:
    """Measure where a ray enters and leaves a box of edge 1 that is far away."""
    origin, direction = [0.0, 0.25, 0.5], [1.0, slope, slope * slope]
    lower, upper = [distance, 0.0, 0.0], [distance + 1.0, 1.0, 1.0]
    t0, t1 = march.ray_box(
        np.array([origin]),
        np.array([direction]),
        lower=np.array(lower),
        upper=np.array(upper),
    )
    with exact_numbers(plain_march):
        o, d, a, b = exact([origin, direction, lower, upper])
        right = plain_march.ray_box(o, d, a, b)
    return Found([float(t0[0]), float(t1[0])], right)


def projected(distance: float, size: float) -> Found:
    """Measure where a point falls in the picture, seen from a distance."""
    eye, target, up = (0.0, 0.0, distance), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    camera = Camera(np.array(eye), np.array(target), np.array(up), 0.5, 64, 48)
    point = [0.3 * size, -0.2 * size, 0.1 * size]
    x, y, depth, scale = project(camera, np.array([point]))
    with exact_numbers(plain_camera):
        axes = exact(eye), exact(target), exact(up)
        twin = plain_camera.Camera(*axes, 64, 48, exact(0.5))
        right = plain_camera.project(twin, exact(point))
    # Beyond 1e9 pixels a point is as good as anywhere; x and y count in pixels.
    return Found([x[0], y[0], depth[0], scale[0]], right)


def splatted(tau: float, radius: float) -> Found:
    """Measure what a ball of some radius in pixels lets through at a pixel."""
    buffer = raster.framebuffer(3, 3, color=np.ones(4))
    place = (1.3, 1.6)
    black = np.zeros(3)
    raster.splat(buffer, *place, radius, emission=black, tau=tau)
    with exact_numbers(plain_raster, plain_metaballs):
        right = plain_raster.framebuffer(3, 3, exact([1.0, 1.0, 1.0, 1.0]))
        x, y, r = exact([*place, radius])
        plain_raster.splat(right, x, y, r, [0.0, 0.0, 0.0], exact(tau))
    red = buffer.pixels[..., 0].ravel()
    return Found(red, [pixel[0] for row in right for pixel in row], scale=1.0)


def carried(sigma_t: float, offset: float) -> Found:
    """Measure the light that reaches three balls in a row, pass 1 whole."""
    centers = np.array([[0.0, 0.0, 0.0], [1.0, 0.25, 0.0], [2.0, -0.25, 0.5]])
    balls = Metaballs(centers + offset, np.array([1.0, 0.75, 0.5]), np.ones(3))
    sun = Sun(np.array([1.0, 0.5, 0.25]))
    medium = Medium(sigma_t)
    lit = lighting.sunward(balls, (sun,), medium=medium, look=LOOK)
    right = carried_exactly(sigma_t)
    return Found([*lit.light.ravel(), *lit.ambient.ravel()], right, scale=1.0)


@cache
def carried_exactly(sigma_t: float) -> list[Any]:
    """Run the twin of pass 1 at the origin; a moved cloud is lit the same."""
    balls = [
        ((0.0, 0.0, 0.0), 1.0, 1.0),
        ((1.0, 0.25, 0.0), 0.75, 1.0),
        ((2.0, -0.25, 0.5), 0.5, 1.0),
    ]
    names = plain_lighting.Rules._fields
    rules = plain_lighting.Rules(
        **{
            name: exact(value.tolist()) if isinstance(value, np.ndarray) else value
            for name, value in ((name, getattr(LOOK, name)) for name in names)
        }
    )
    with exact_numbers(*PASSES):
        toward = plain_camera.unit(exact([1.0, 0.5, 0.25]))
        lit = plain_lighting.sunward(
            exact(balls),
            "wyvill",
            [(toward, exact([4.0 * np.pi] * 3))],
            plain_lighting.Medium(
                exact([sigma_t] * 3), exact([1.0] * 3), 0.0, "rayleigh"
            ),
            rules,
            exact(BORDER),
        )
    suns = [c for ball in lit.light[0] for c in ball]
    return suns + [c for ball in lit.ambient for c in ball]


def marched(tau: float, offset: float) -> Found:
    """Measure light and transmittance of an even cube, the sun behind the eye.

    Formula: T = exp(-tau), L = albedo p E (1 - exp(-2 tau)) / 2
    """
    lower = np.full(3, offset)
    grid = VoxelGrid(np.ones((2, 2, 2)), lower, lower + 1.0)
    medium = Medium(tau, phase="isotropic")
    L, T = march.integrate(
        grid,
        lower + np.array([0.5, 0.5, 2.0]),
        np.array([0.0, 0.0, -1.0]),
        suns=Sun(np.array([0.0, 0.0, 1.0])),
        medium=medium,
    )
    right = -expm1(-2 * exact(tau)) / 2
    return Found(
        [float(np.ravel(L)[0]), float(np.ravel(T)[0])], [right, exp(-exact(tau))]
    )


def shadowed(density: float, offset: float, dtype: Any) -> Found:
    """Measure the light that passes an even cube toward a sun on an axis."""
    lower = np.full(3, offset)
    grid = VoxelGrid(np.full((4, 4, 4), density), lower, lower + 1.0)
    volume = transport.sun_depths(grid, np.array([0.0, 0.0, 1.0]), dtype=dtype)
    right = [exp(-exact(density) * (7 - 2 * k) / 8) for k in range(4)]
    return Found(np.exp(-volume.density[:, 1, 2]), right, scale=1.0)


def furnace(tau: float, g: float) -> Found:
    """Measure a cloud of albedo 1 in even light of radiance 1: it cannot be seen."""
    density = np.zeros((6, 6, 6))
    density[1:5, 1:5, 1:5] = 1.0
    grid = VoxelGrid(density, np.zeros(3), np.full(3, 6.0))
    white = np.ones(3)
    light = transport.scattered_light(
        grid,
        (),
        medium=Medium(tau, g=g, phase="hg"),
        sky=white,
        ground=white,
        plan=Plan((Stage(26, 0, 500, 1e-7),), double=True),
    )
    J = transport.source_toward(light, np.array([0.3, 0.2, -0.5]))
    inside = density > 0.0
    values = J[inside].ravel()
    return Found(values, [1.0] * len(values))


@cache
def cloud() -> VoxelGrid:
    """Give a small cloud of the paper's kind."""
    return generate("ellipsoid", seed=1, voxel=4.0)


def fitted(scale: float, offset: float) -> Found:
    """Measure the error of a fit to a cloud that is moved and resized."""
    grid = cloud()
    balls = metaballs.approximate(grid, count=20, method="quick")
    right = metaballs.errors_of_fit(grid, balls)
    moved = VoxelGrid(
        grid.density, scale * grid.lower + offset, scale * grid.upper + offset
    )
    fit = metaballs.approximate(moved, count=20, method="quick")
    found = metaballs.errors_of_fit(moved, fit)
    # Rounded coordinates can lead to other balls: to be better is no error.
    return Found([max(found.density, right.density)], [right.density])


def summed(radius: float, offset: float) -> Found:
    """Measure the density of two balls at a place between them."""
    centers = [[offset, 0.0, 0.0], [offset + radius, 0.0, 0.0]]
    point = [offset + 0.375 * radius, 0.25 * radius, 0.0]
    balls = Metaballs(np.array(centers), np.full(2, radius), np.array([1.0, 0.5]))
    found = metaballs.field(balls, np.array([point]))
    with exact_numbers(plain_metaballs):
        twin = [
            (exact(c), exact(radius), d)
            for c, d in zip(centers, (1.0, 0.5), strict=True)
        ]
        return Found(found, [plain_metaballs.field(twin, exact(point))])


TAUS = (0.0, 1e-7, 1e-3, 1.0, 8.0, 100.0, 1e4, 1e6, 1e37)
PROBES = (
    Probe(
        "layers, RGBA32F",
        CLOSED,
        Axis("alpha", (0.0, 1e-9, 1 / 255, 0.1, 0.5, 0.999, 1.0, 1.1)),
        Axis("layers", (0, 1, 10, 100, 1000)),
        layers,
        "float32",
    ),
    Probe(
        "ray_box",
        TWIN,
        Axis("distance", (0.0, 1.0, 1e3, 1e6, 1e9, 1e15, 1e300)),
        Axis("slope", (0.0, 1e-300, 1e-16, 1e-9, 1e-3, 1.0)),
        entered,
    ),
    Probe(
        "project",
        TWIN,
        Axis("distance", (1e-9, 1.0, 1e3, 1e6, 1e9, 1e15, 1e300)),
        Axis("size", (0.0, 1e-300, 1e-9, 1.0, 1e3, 1e9)),
        projected,
    ),
    Probe(
        "splat",
        TWIN,
        Axis("tau", TAUS),
        Axis("radius in pixels", (0.0, 0.01, 0.3, 1.0, 100.0, 1e4, 1e8, 1e300)),
        splatted,
    ),
    Probe("sunward", TWIN, Axis("sigma_t", TAUS), OFFSETS, carried, slow=True),
    Probe(
        "march.integrate", CLOSED, Axis("tau", TAUS), OFFSETS, marched, note=QUADRATURE
    ),
    *(
        Probe(
            "sun_depths",
            CLOSED,
            Axis("density", (0.0, 1e-300, 1e-7, 1.0, 1e4, 1e30, 1e300)),
            OFFSETS,
            lambda density, offset, dtype=dtype: shadowed(density, offset, dtype),
            dtype,
        )
        for dtype in ("float64", "float32")
    ),
    Probe(
        "scattered_light",
        "white furnace: 1",
        Axis("tau of a voxel", (1e-7, 1e-3, 0.3, 3.0, 100.0, 1e3, 1e6)),
        Axis("g", (-0.95, -0.5, 0.0, 0.6, 0.95, 1 - 1e-6, 1 - 1e-12)),
        furnace,
        note="the iteration ends at a residual of 1e-7",
        slow=True,
    ),
    Probe(
        "approximate",
        "the fit at the origin",
        Axis("scale", (1e-9, 1e-3, 1.0, 1e3, 1e9)),
        OFFSETS,
        fitted,
    ),
    Probe(
        "field",
        TWIN,
        Axis("radius", (0.0, 1e-300, 1e-9, 1.0, 1e9, 1e150, 1e300)),
        OFFSETS,
        summed,
    ),
)
