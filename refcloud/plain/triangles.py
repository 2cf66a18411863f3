"""Textured triangles, one triangle and one pixel at a time.

Each function is the twin of the one of the same name in `refcloud.raster`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from refcloud.plain.camera import Camera, Point
from refcloud.plain.framebuffer import State, draw_fragments
from refcloud.plain.raster import Buffer, Colour
from refcloud.plain.window import (
    SUBPIXEL,
    Place,
    in_window,
    inside,
    to_camera,
    to_subpixels,
)

Corner = tuple[float, ...]  # right, up, depth, then the attributes
Pixel = tuple[int, int]  # row, column

BOTH = "FRONT_AND_BACK"


class Mesh(NamedTuple):
    """Corners, triples of them, and what each corner carries."""

    points: Sequence[Point]
    faces: Sequence[tuple[int, int, int]]
    attributes: Sequence[Sequence[float]]


def twice_area(a: Place, b: Place, c: Place) -> int:
    """Give twice the area, above 0 for corners that run clockwise on the screen."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def holds(corners: Sequence[Place], row: int, column: int) -> bool:
    """Tell whether a triangle holds the centre of a pixel."""
    x = column * SUBPIXEL + SUBPIXEL // 2
    y = row * SUBPIXEL + SUBPIXEL // 2
    a, b, c = corners
    area = twice_area(a, b, c)
    if area == 0:
        return False
    if area < 0:
        b, c = c, b
    for (px, py), (qx, qy) in ((a, b), (b, c), (c, a)):
        side = (qx - px) * (y - py) - (qy - py) * (x - px)
        left_or_upper = qy < py or (qy == py and qx > px)
        if side < 0 or (side == 0 and not left_or_upper):
            return False
    return True


def triangle_pixels(
    corners: Sequence[Sequence[float]], width: int, height: int
) -> list[Pixel]:
    """List the pixels of a triangle, row by row."""
    places = [to_subpixels(*corner) for corner in corners]
    return pixels_of(places, width, height)


def pixels_of(places: Sequence[Place], width: int, height: int) -> list[Pixel]:
    """List the pixels of a triangle between sub-pixels."""
    everywhere = ((row, column) for row in range(height) for column in range(width))
    return [pixel for pixel in everywhere if holds(places, *pixel)]


def clip(
    camera: Camera, corners: list[Corner], near: float, far: float | None
) -> list[list[Corner]]:
    """Cut a triangle by each plane in turn; each leaves none, one or two."""
    triangles = [corners]
    for plane in range(6):
        left = []
        for cut in triangles:
            depth = [inside(camera, corner, plane, near, far) for corner in cut]
            left += cut_triangle(cut, depth)
        triangles = left
    return triangles


def cut_triangle(corners: list[Corner], inside: list[float]) -> list[list[Corner]]:
    """Cut a triangle by one plane; numbers below 0 are outside of it."""
    outside = [value < 0.0 for value in inside]
    if sum(outside) in (0, 3):
        return [] if outside[0] else [corners]
    # The corner that is alone on its side comes first.
    odd = outside.index(sum(outside) == 1)
    a, b, c = ((odd + k) % 3 for k in range(3))
    new = []
    for other in (b, c):
        start, end = (other, a) if outside[a] else (a, other)
        share = inside[start] / (inside[start] - inside[end])
        pairs = zip(corners[start], corners[end], strict=True)
        new.append(tuple(s + share * (e - s) for s, e in pairs))
    if not outside[a]:
        return [[corners[a], *new]]
    return [[new[0], corners[b], corners[c]], [new[0], corners[c], new[1]]]


def interpolated(
    camera: Camera, corners: Sequence[Corner], places: Sequence[Place], pixel: Pixel
) -> list[float]:
    """Give right, up, depth and the attributes at a pixel's centre."""
    x, y = (n * SUBPIXEL + SUBPIXEL // 2 for n in pixel[::-1])
    a, b, c = places
    weights = [
        twice_area((x, y), b, c),
        twice_area(a, (x, y), c),
        twice_area(a, b, (x, y)),
    ]
    # Of a pinhole what is linear on the screen is divided by depth.
    shares = [
        weight / twice_area(a, b, c) / (1.0 if camera.fov_y is None else corner[2])
        for weight, corner in zip(weights, corners, strict=True)
    ]
    columns = zip(*corners, strict=True)
    return [
        sum(s * x for s, x in zip(shares, column, strict=True)) / sum(shares)
        for column in columns
    ]


def depth_in_buffer(
    camera: Camera, depth: float, near: float, far: float | None
) -> float:
    """Give what the depth test compares: 0 at near, 1 at far or infinity."""
    if camera.fov_y is None:
        found = 0.0 if far is None else (depth - near) / (far - near)
    else:
        found = 1.0 - near / depth
        found *= 1.0 if far is None else far / (far - near)
    return min(max(found, 0.0), 1.0)


def draw_triangles(
    buffer: Buffer,
    depths: list[list[float]],
    camera: Camera,
    mesh: Mesh,
    shade: Callable[[list[float], float], Colour],
    state: State,
    near: float,
    far: float | None = None,
    cull: str | None = None,
) -> None:
    """Cut, place, cull, interpolate, shade and draw one triangle after the other."""
    for face in mesh.faces:
        whole: list[Corner] = [
            (*to_camera(camera, mesh.points[v]), *mesh.attributes[v]) for v in face
        ]
        for corners in clip(camera, whole, near, far):
            places = [in_window(camera, corner, near) for corner in corners]
            a, b, c = places
            if cull in ("FRONT" if twice_area(a, b, c) < 0 else "BACK", BOTH):
                continue
            for pixel in pixels_of(places, camera.width, camera.height):
                found = interpolated(camera, corners, places, pixel)
                depth = depth_in_buffer(camera, found[2], near, far)
                fragment = *pixel, depth, shade(found[3:], found[2])
                draw_fragments(buffer, depths, [fragment], state, "RGBA64F")
