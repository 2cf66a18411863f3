"""From the world into the window, one place at a time.

Each function is the twin of the one of the same name in `refcloud.raster.window`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from refcloud.plain.camera import Camera, Point, along, axes, between, dot

Place = tuple[int, int]  # x, y in sub-pixels

SUBPIXEL, GUARD = 256, 8192.0


def to_subpixels(x: float, y: float) -> Place:
    """Round a place to whole sub-pixels."""
    return math.floor(x * SUBPIXEL + 0.5), math.floor(y * SUBPIXEL + 0.5)


def scale_of(camera: Camera) -> float:
    """Give pixels per scene unit: at depth 1, or anywhere if orthographic."""
    if camera.fov_y is None:
        return camera.height / camera.height_of_view
    return camera.height / (2.0 * math.tan(camera.fov_y / 2.0))


def to_camera(camera: Camera, point: Point) -> Point:
    """Give right, up and depth."""
    offset = between(camera.eye, point)
    right, up, back = axes(camera)
    return dot(offset, right), dot(offset, up), -dot(offset, back)


def inside(
    camera: Camera,
    place: Sequence[float],
    plane: int,
    near: float,
    far: float | None = None,
) -> float:
    """Say how far inside a cutting plane a place of the camera's frame lies."""
    right, up, depth = place[:3]
    if plane == 0:
        return depth - near
    if plane == 5:
        return math.inf if far is None else far - depth
    across, size = (right, camera.width) if plane < 3 else (up, camera.height)
    aside = (0.5 * size + GUARD) * (1.0 if camera.fov_y is None else depth)
    scaled = scale_of(camera) * across
    return aside + scaled if plane % 2 else aside - scaled


def meeting(a: Point, b: Point, inside_a: float, inside_b: float) -> Point:
    """Give the place between two points where a plane lies."""
    return along(a, (inside_a / (inside_a - inside_b), between(a, b)))


def in_window(camera: Camera, place: Sequence[float], near: float) -> Place:
    """Put a place of the camera's frame into the window."""
    scale = scale_of(camera) / (1.0 if camera.fov_y is None else max(place[2], near))
    x = camera.width / 2.0 + scale * place[0]
    return to_subpixels(x, camera.height / 2.0 - scale * place[1])
