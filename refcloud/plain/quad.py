"""The quad that a cloud is drawn on, one point at a time.

Each function is the twin of the one of the same name in `refcloud.raster`.
"""

from __future__ import annotations

import math

from refcloud.plain.camera import Camera, Point, along, axes, between


def quad_corners(camera: Camera, distance: float) -> list[Point]:
    """List lower left, lower right, upper left and upper right."""
    right, up, back = axes(camera)
    half = camera.height_of_view / 2.0
    if camera.fov_y is not None:
        half = distance * math.tan(camera.fov_y / 2.0)
    wide = half * camera.width / camera.height
    corners = []
    for y in (-half, half):
        for x in (-wide, wide):
            corners.append(along(camera.eye, (-distance, back), (x, right), (y, up)))
    return corners


def quad_points(camera: Camera, distance: float, column: int, row: int) -> Point:
    """Interpolate the corners to one pixel: first along x, then along y."""
    lower_left, lower_right, upper_left, upper_right = quad_corners(camera, distance)
    s = (column + 0.5) / camera.width
    t = 1.0 - (row + 0.5) / camera.height
    below = along(lower_left, (s, between(lower_left, lower_right)))
    above = along(upper_left, (s, between(upper_left, upper_right)))
    return along(below, (t, between(below, above)))
