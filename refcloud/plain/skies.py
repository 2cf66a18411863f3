"""Skies of document S: one ray, one place, one vertex at a time.

Each function is the twin of the one of the same name in `refcloud.sky`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from refcloud.plain.camera import Camera, Point, along, between, dot, rays
from refcloud.plain.sheet import wrapped_bilinear

Place = tuple[float, float]  # u, v


class Plane(NamedTuple):
    """A flat sky, fields as `refcloud.sky.Plane`."""

    height: float
    tile: float
    reach: float


class Sphere(NamedTuple):
    """A whole sphere, fields as `refcloud.sky.Sphere`."""

    center: Point
    radius: float


class Dome(NamedTuple):
    """The upper half of a sphere, fields as `refcloud.sky.Dome`."""

    center: Point
    radius: float
    tiles: float


def fog_factor(distance: float, density: float, form: str = "exponential") -> float:
    """Give the share of an object's own light that fog leaves."""
    power = density - distance if form == "printed" else density * distance
    return math.exp(-max(power, 0.0))


def fogged(
    light: Sequence[float],
    distance: float,
    density: float,
    color: Sequence[float],
    form: str = "exponential",
) -> list[float]:
    """Mix an object's light with that of the fog before it."""
    f = fog_factor(distance, density, form)
    return [f * own + (1.0 - f) * fog for own, fog in zip(light, color, strict=True)]


def plane_coordinates(point: Point, plane: Plane) -> Place:
    """Give where a point of a plane lies in its texture."""
    return point[0] / plane.tile, point[2] / plane.tile


def sphere_coordinates(point: Point, sphere: Sphere) -> Place:
    """Give where a point of a sphere lies in a picture wrapped around it."""
    x, y, z = between(sphere.center, point)
    if x == 0.0 and z == 0.0:
        return 0.5, 1.0 if y > 0.0 else 0.0
    around = math.atan2(x, -z) / (2.0 * math.pi)
    return 0.5 + around, 0.5 + math.atan2(y, math.hypot(x, z)) / math.pi


def sphere_points(coordinates: Place, sphere: Sphere) -> Point:
    """Give the point of a sphere at a place of the picture around it."""
    around, up = (
        2.0 * math.pi * (coordinates[0] - 0.5),
        math.pi * (coordinates[1] - 0.5),
    )
    way = (
        math.sin(around) * math.cos(up),
        math.sin(up),
        -math.cos(around) * math.cos(up),
    )
    return along(sphere.center, (sphere.radius, way))


def dome_coordinates(point: Point, dome: Dome) -> Place:
    """Give where a point of a half-sphere lies in the grid's texture."""
    x, y, z = between(dome.center, point)
    theta, azimuth = math.atan2(math.hypot(x, z), y), math.atan2(z, x)
    across, down = (
        theta / math.pi * math.cos(azimuth),
        theta / math.pi * math.sin(azimuth),
    )
    return dome.tiles * (0.5 + across), dome.tiles * (0.5 + down)


def dome_points(coordinates: Place, dome: Dome) -> Point:
    """Put a place of a square grid onto a half-sphere."""
    a, b = coordinates[0] / dome.tiles - 0.5, coordinates[1] / dome.tiles - 0.5
    theta = min(math.pi * max(abs(a), abs(b)), math.pi / 2.0)
    azimuth = math.atan2(b, a)
    sine = math.sin(theta)
    way = sine * math.cos(azimuth), math.cos(theta), sine * math.sin(azimuth)
    return along(dome.center, (dome.radius, way))


def distance_to(surface: Plane | Sphere | Dome, origin: Point, way: Point) -> float:
    """Give how far a ray goes until it meets a surface, infinity if it never does."""
    if isinstance(surface, Plane):
        if way[1] == 0.0:
            return math.inf
        t = (surface.height - origin[1]) / way[1]
        x, _, z = along(origin, (t, way))
        near = max(abs(x), abs(z)) <= surface.reach
        return t if t > 0.0 and near else math.inf
    offset = between(surface.center, origin)
    b = dot(offset, way)
    across = along(offset, (-b, way))
    half = surface.radius**2 - dot(across, across)
    if half < 0.0:
        return math.inf
    for t in (-b - math.sqrt(half), -b + math.sqrt(half)):
        above = offset[1] + t * way[1] >= 0.0
        if t > 0.0 and (above or isinstance(surface, Sphere)):
            return t
    return math.inf


def places(
    camera: Camera, surface: Plane | Sphere | Dome, column: int, row: int
) -> tuple[Point, Place, float] | None:
    """Find which point of a surface a pixel shows, its u and v, and how far it is."""
    origin, way = rays(camera, column, row)
    t = distance_to(surface, origin, way)
    if not math.isfinite(t):
        return None
    point = along(origin, (t, way))
    if isinstance(surface, Plane):
        return point, plane_coordinates(point, surface), t
    if isinstance(surface, Dome):
        return point, dome_coordinates(point, surface), t
    return point, sphere_coordinates(point, surface), t


def looked_up(texture: Sequence[Sequence[float]], place: Place) -> float:
    """Look a value up in a texture that repeats."""
    height, width = len(texture), len(texture[0])
    return wrapped_bilinear(texture, place[0] * width - 0.5, place[1] * height - 0.5)


def shaded(
    behind: Sequence[float],
    light: Sequence[float],
    opacity: float,
    distance: float,
    density: float,
    color: Sequence[float] | None,
    form: str,
) -> list[float]:
    """Draw one pixel of a surface over what lies behind it, with fog before it."""
    fog = behind if color is None else color
    own = fogged(light, distance, density, fog, form)
    return [opacity * a + (1.0 - opacity) * b for a, b in zip(own, behind, strict=True)]


class Cover(NamedTuple):
    """How noise becomes cloud, fields as `refcloud.sky.Cover`."""

    threshold: float
    opacity_slope: float
    light: float
    light_slope: float
    least_light: float
    reading: str


def cloud_cover(noise: float, cover: Cover) -> tuple[float, float]:
    """Turn noise into the light and the opacity of a layer of clouds."""
    above = noise - cover.threshold
    opacity = min(max(cover.opacity_slope * above, 0.0), 1.0)
    if cover.reading == "printed":
        opacity = 1.0 - opacity
    light = cover.light + cover.light_slope * max(above, 0.0)
    return max(light, cover.least_light), opacity


class FlatBase(NamedTuple):
    """A layer of clouds with a flat base, fields as `refcloud.sky.FlatBase`."""

    threshold: float
    slope: float
    thickness: float
    sigma_t: float
    steps: int


def base_density(noise: float, height: float, layer: FlatBase) -> float:
    """Give the density of a layer at a height above its flat base."""
    risen = min(layer.slope * (noise - layer.threshold), 1.0)
    return max(risen - height / layer.thickness, 0.0)


def light_from_above(
    place: Place, pattern: Callable[[Place], float], layer: FlatBase, sun: Point
) -> float:
    """March from the blue dot on the base toward the sun; give what light arrives."""
    step = layer.thickness / sun[1] / layer.steps
    tau = 0.0
    for i in range(layer.steps):
        t = (i + 0.5) * step
        there = place[0] + t * sun[0], place[1] + t * sun[2]
        tau += layer.sigma_t * step * base_density(pattern(there), t * sun[1], layer)
    return math.exp(-tau)
