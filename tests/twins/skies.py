"""Skies of document S beside their plain twins, and the strategies of their tests."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import refcloud.sky as array
from refcloud.plain import camera as plain_camera
from refcloud.plain import skies as plain
from twins import Draw, twin
from twins.camera import as_plain, coordinates, drawn_camera, places
from twins.sky import colours

WITHOUT = {
    "refcloud.sky.meshes.surface_mesh": "corners by functions that have rows",
}

ROUNDED = "the same few operations: some last bits"
STEEP = "a camera's last bits, 3e-14, over distances of up to a few hundred; times 10"
GRAZE = 1e-2  # of the radius or of a direction: nearer a ray grazes, and decides apart

forms = st.sampled_from(["exponential", "printed"])
densities = st.floats(0.0, 3.0)
small = st.floats(0.0, 50.0)
noises = st.floats(-1.0, 1.0)
unit_places = st.floats(-3.0, 3.0)


def few(elements, *shape: int):
    return arrays(np.float64, shape, elements=elements)


def fields(instance, kind):
    """Give a frozen dataclass as its plain named tuple."""
    values = (getattr(instance, name) for name in kind._fields)
    return kind(*(tuple(v.tolist()) if hasattr(v, "tolist") else v for v in values))


PLAIN = {array.Plane: plain.Plane, array.Sphere: plain.Sphere, array.Dome: plain.Dome}


def drawn_surface(draw: Draw, *kinds):
    """Draw a surface, of one of the kinds if some are named."""
    kind = draw(st.sampled_from(kinds or tuple(PLAIN)))
    if kind is array.Plane:
        return array.Plane(
            draw(st.floats(-5.0, 5.0)), draw(st.floats(0.1, 9.0)), draw(small) + 1.0
        )
    size = {"center": draw(places), "radius": draw(st.floats(0.5, 30.0))}
    if kind is array.Dome:
        return array.Dome(**size, tiles=draw(st.floats(0.5, 5.0)))
    return array.Sphere(**size)


def as_named(surface):
    return fields(surface, PLAIN[type(surface)])


def drawn_points(draw: Draw, surface) -> np.ndarray:
    """Draw points on a sphere or on the upper half of one, the poles among them."""
    way = st.tuples(*(st.sampled_from([0.0, 1.0, -1.0]) | noises for _ in range(3)))
    way = way.filter(lambda v: math.hypot(*v) > 0.1)
    ways = np.array(draw(st.lists(way, min_size=1, max_size=3)))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    if isinstance(surface, array.Dome):
        ways[:, 1] = np.abs(ways[:, 1])
    return surface.center + surface.radius * ways


@twin(array.fog_factor, plain.fog_factor, tolerance=2e-15, why=ROUNDED)
def fog_factor(draw: Draw):
    distance, density, form = draw(few(small, 3)), draw(densities), draw(forms)
    actual = array.fog_factor(distance, density=density, form=form)
    return actual, [plain.fog_factor(d, density, form) for d in distance.tolist()]


@twin(array.fogged, plain.fogged, tolerance=4e-15, why=ROUNDED)
def fogged(draw: Draw):
    light, distance = draw(few(st.floats(0.0, 2.0), 2, 3)), draw(few(small, 2))
    how = {"density": draw(densities), "color": draw(colours), "form": draw(forms)}
    pairs = zip(light.tolist(), distance.tolist(), strict=True)
    return array.fogged(light, distance, **how), [
        plain.fogged(own, far, **how) for own, far in pairs
    ]


@twin(
    array.plane_coordinates, plain.plane_coordinates, tolerance=2e-16, why="a division"
)
def plane_coordinates(draw: Draw):
    surface = drawn_surface(draw, array.Plane)
    points = draw(few(coordinates, 2, 3))
    expected = [plain.plane_coordinates(p, as_named(surface)) for p in points.tolist()]
    return array.plane_coordinates(points, surface), expected


@twin(array.sphere_coordinates, plain.sphere_coordinates, tolerance=4e-15, why=ROUNDED)
def sphere_coordinates(draw: Draw):
    surface = drawn_surface(draw, array.Sphere)
    points = drawn_points(draw, surface)
    # Where a picture's two sides meet, a last bit decides on 0 or 1; near a pole, on
    # any azimuth.
    x, _, z = (points - surface.center).T / surface.radius
    assume(((np.hypot(x, z) > 1e-3) & ((np.abs(x) > 1e-3) | (z < 0.0))).all())
    expected = [
        plain.sphere_coordinates(tuple(p), as_named(surface)) for p in points.tolist()
    ]
    return array.sphere_coordinates(points, surface), expected


@twin(array.sphere_points, plain.sphere_points, tolerance=4e-15, why=ROUNDED)
def sphere_points(draw: Draw):
    surface, uv = drawn_surface(draw, array.Sphere), draw(few(unit_places, 3, 2))
    expected = [plain.sphere_points(tuple(p), as_named(surface)) for p in uv.tolist()]
    return array.sphere_points(uv, surface), expected


@twin(array.dome_coordinates, plain.dome_coordinates, tolerance=8e-15, why=ROUNDED)
def dome_coordinates(draw: Draw):
    surface = drawn_surface(draw, array.Dome)
    points = drawn_points(draw, surface)
    expected = [
        plain.dome_coordinates(tuple(p), as_named(surface)) for p in points.tolist()
    ]
    return array.dome_coordinates(points, surface), expected


@twin(array.dome_points, plain.dome_points, tolerance=8e-15, why=ROUNDED)
def dome_points(draw: Draw):
    surface = drawn_surface(draw, array.Dome)
    uv = surface.tiles * draw(few(st.floats(0.0, 1.0), 3, 2))
    expected = [plain.dome_points(tuple(p), as_named(surface)) for p in uv.tolist()]
    return array.dome_points(uv, surface), expected


def grazes(camera: plain_camera.Camera, surface, column: int, row: int) -> bool:
    """Tell whether a ray meets a surface so flatly that a last bit may decide."""
    origin, way = plain_camera.rays(camera, column, row)
    if isinstance(surface, plain.Plane):
        t = (surface.height - origin[1]) / way[1] if way[1] else math.inf
        x, _, z = plain_camera.along(origin, (min(abs(t), 1e9), way))
        rim = abs(max(abs(x), abs(z)) - surface.reach)
        return abs(way[1]) < GRAZE or abs(t) < GRAZE or rim < GRAZE
    offset = plain_camera.between(surface.center, origin)
    b = plain_camera.dot(offset, way)
    across = plain_camera.along(offset, (-b, way))
    half = surface.radius**2 - plain_camera.dot(across, across)
    if abs(half) < GRAZE * surface.radius**2:
        return True
    if half < 0.0:
        return False
    ends = [-b - math.sqrt(half), -b + math.sqrt(half)]
    heights = [offset[1] + t * way[1] for t in ends]
    return min(abs(n) for n in (*ends, *heights)) < GRAZE * surface.radius


@twin(array.places, plain.places, tolerance=2e-10, why=STEEP)
def all_places(draw: Draw):
    camera, surface = drawn_camera(draw), drawn_surface(draw)
    eye, named = as_plain(camera), as_named(surface)
    pixels = [(i, j) for j in range(camera.height) for i in range(camera.width)]
    assume(not any(grazes(eye, named, *pixel) for pixel in pixels))
    found = array.places(camera, surface)
    actual = np.full((*found.seen.shape, 5), np.nan)
    uv = found.coordinates
    if isinstance(surface, array.Sphere):  # its two sides meet at u = 0 and 1
        uv = np.stack([np.cos(2.0 * np.pi * uv[:, 0]), uv[:, 1]], axis=1)
        assume((np.abs(found.coordinates[:, 1] - 0.5) < 0.499).all())
    actual[found.seen] = np.column_stack([found.points, uv[:, 0], found.distance])
    expected = np.full_like(actual, np.nan)
    for i, j in pixels:
        one = plain.places(eye, named, i, j)
        if one is not None:
            point, (u, _), far = one
            if isinstance(surface, array.Sphere):
                u = math.cos(2.0 * math.pi * u)
            expected[j, i] = [*point, u, far]
    return actual, expected


@twin(array.looked_up, plain.looked_up, tolerance=2e-14, why=ROUNDED)
def looked_up(draw: Draw):
    texture, uv = draw(few(noises, 3, 2)), draw(few(unit_places, 4, 2))
    expected = [plain.looked_up(texture.tolist(), tuple(p)) for p in uv.tolist()]
    return array.looked_up(texture, uv), expected


@twin(array.shaded, plain.shaded, tolerance=4e-15, why=ROUNDED)
def shaded(draw: Draw):
    camera, surface = drawn_camera(draw), drawn_surface(draw)
    found = array.places(camera, surface)
    behind = np.linspace(0.0, 1.0, found.seen.size * 3).reshape(*found.seen.shape, 3)
    count = len(found.distance)
    light = np.linspace(0.2, 0.9, count * 3).reshape(count, 3)
    opacity = np.linspace(0.0, 1.0, count)
    color = draw(st.none() | colours)
    density, form = draw(densities), draw(forms)
    fog = array.Fog(density, color, form)
    actual = array.shaded(behind, found, lambda p: (light, opacity), fog=fog)
    expected = behind.tolist()
    rest = (found.distance.tolist(), [density] * count, [color] * count, [form] * count)
    for (j, i), *one in zip(
        np.argwhere(found.seen).tolist(),
        light.tolist(),
        opacity.tolist(),
        *rest,
        strict=True,
    ):
        expected[j][i] = plain.shaded(expected[j][i], *one)
    return actual, expected


def drawn_cover(draw: Draw) -> array.Cover:
    return array.Cover(
        *(
            draw(st.floats(low, high))
            for low, high in ((-1, 1), (0, 9), (0, 2), (-3, 3))
        ),
        least_light=draw(st.floats(0.0, 0.5)),
        reading=draw(st.sampled_from(["opacity", "printed"])),
    )


@twin(array.cloud_cover, plain.cloud_cover, tolerance=4e-15, why=ROUNDED)
def cloud_cover(draw: Draw):
    noise, cover = draw(few(noises, 4)), drawn_cover(draw)
    named = fields(cover, plain.Cover)
    expected = [plain.cloud_cover(n, named) for n in noise.tolist()]
    return np.stack(array.cloud_cover(noise, cover), axis=1), expected


def drawn_layer(draw: Draw) -> array.FlatBase:
    return array.FlatBase(
        draw(noises),
        draw(st.floats(0.0, 5.0)),
        draw(st.floats(0.1, 2.0)),
        draw(st.floats(0.0, 20.0)),
        draw(st.integers(1, 8)),
    )


@twin(array.base_density, plain.base_density, tolerance=4e-15, why=ROUNDED)
def base_density(draw: Draw):
    noise, height, layer = draw(few(noises, 3)), draw(few(small, 3)), drawn_layer(draw)
    named = fields(layer, plain.FlatBase)
    pairs = zip(noise.tolist(), height.tolist(), strict=True)
    expected = [plain.base_density(n, h, named) for n, h in pairs]
    return array.base_density(noise, height, layer), expected


@twin(
    array.light_from_above,
    plain.light_from_above,
    tolerance=2e-12,
    why="last bits of a step, times its share of a depth of at most 40 / 0.05",
)
def light_from_above(draw: Draw):
    at, layer = draw(few(unit_places, 2, 2)), drawn_layer(draw)
    x, z = draw(noises), draw(noises)
    sun = plain_camera.unit((x, draw(st.floats(0.1, 1.0)), z))

    def pattern(place):
        return math.sin(place[0]) * math.cos(2.0 * place[1])

    named = fields(layer, plain.FlatBase)
    actual = array.light_from_above(
        at, lambda p: np.sin(p[:, 0]) * np.cos(2.0 * p[:, 1]), layer, sun=sun
    )
    expected = [
        plain.light_from_above(tuple(p), pattern, named, sun) for p in at.tolist()
    ]
    return actual, expected
