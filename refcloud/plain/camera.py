"""Cameras: one point into the picture, one pixel's ray out of it.

Each function is the twin of the one of the same name in `refcloud.camera`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

Point = tuple[float, float, float]  # x, y, z


class Camera(NamedTuple):
    """A camera: a pinhole with `fov_y`, or an orthographic one without."""

    eye: Point
    target: Point
    up: Point
    width: int
    height: int
    fov_y: float | None = None
    height_of_view: float = 1.0


def dot(a: Point, b: Point) -> float:
    """Multiply two vectors to a number."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Point, b: Point) -> Point:
    """Multiply two vectors to one across both."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def unit(a: Point) -> Point:
    """Scale a vector to length 1."""
    length = math.hypot(*a)
    return a[0] / length, a[1] / length, a[2] / length


def between(start: Point, end: Point) -> Point:
    """Give the vector from one point to another."""
    return end[0] - start[0], end[1] - start[1], end[2] - start[2]


def along(start: Point, *steps: tuple[float, Point]) -> Point:
    """Go from a point by multiples of vectors."""
    x, y, z = start
    for length, direction in steps:
        x += length * direction[0]
        y += length * direction[1]
        z += length * direction[2]
    return x, y, z


def axes(camera: Camera) -> tuple[Point, Point, Point]:
    """Give right, up and back."""
    back = unit(between(camera.target, camera.eye))
    right = cross(unit(camera.up), back)
    if dot(right, right) < 1e-12:  # up is along the view: a world axis serves
        across = min(range(3), key=lambda axis: abs(back[axis]))
        axis = (float(across == 0), float(across == 1), float(across == 2))
        right = cross(axis, back)
    right = unit(right)
    return right, cross(back, right), back


def project(camera: Camera, point: Point) -> tuple[float, float, float, float]:
    """Find x and y in the picture, depth, and pixels per scene unit."""
    right, up, back = axes(camera)
    offset = between(camera.eye, point)
    depth = -dot(offset, back)
    if camera.fov_y is None:
        scale = camera.height / camera.height_of_view
    elif depth > 0.0:
        scale = camera.height / (2.0 * math.tan(camera.fov_y / 2.0) * depth)
    else:
        scale = 0.0
    x = camera.width / 2.0 + scale * dot(offset, right)
    y = camera.height / 2.0 - scale * dot(offset, up)
    return x, y, depth, scale


def rays(camera: Camera, column: int, row: int) -> tuple[Point, Point]:
    """Give origin and direction of the ray through one pixel's centre."""
    right, up, back = axes(camera)
    i = column + 0.5 - camera.width / 2.0
    j = camera.height / 2.0 - (row + 0.5)
    if camera.fov_y is None:
        pixel = camera.height_of_view / camera.height
        origin = along(camera.eye, (i * pixel, right), (j * pixel, up))
        return origin, (-back[0], -back[1], -back[2])
    pixel = 2.0 * math.tan(camera.fov_y / 2.0) / camera.height
    ahead = along((0.0, 0.0, 0.0), (i * pixel, right), (j * pixel, up), (-1.0, back))
    return camera.eye, unit(ahead)


def frame(
    lower: Point, upper: Point, *, width: int, height: int, margin: float, fov_y: float
) -> Camera:
    """Stand so far off that every corner of a box shows, with room around it."""
    target = along((0.0, 0.0, 0.0), (0.5, lower), (0.5, upper))
    toward = unit((0.0, -0.28, 1.0))
    start = Camera(toward, (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), width, height, fov_y)
    right, up, back = axes(start)
    rise = math.tan(fov_y / 2.0) / margin
    distance = 0.0
    for corner in range(8):
        place = tuple((upper if corner >> a & 1 else lower)[a] for a in range(3))
        offset = between(target, (place[0], place[1], place[2]))
        needs = max(abs(dot(offset, right)) * height / width, abs(dot(offset, up)))
        distance = max(distance, dot(offset, back) + needs / rise)
    distance = max(distance, 1e-6 * max(abs(t) for t in target), 1e-150)
    eye = along(target, (distance, toward))
    return Camera(eye, target, (0.0, 1.0, 0.0), width, height, fov_y)
