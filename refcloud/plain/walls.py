"""Lines, triangles and the box around a cloud, one pixel at a time.

Each function is the twin of the one of the same name in `refcloud.raster`. Pixels are
asked one by one whether they belong to a line or a triangle, in whole numbers.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from refcloud.plain.box import WALLS, box_lines, box_triangles
from refcloud.plain.camera import Camera, Point, along, axes, between, cross, dot
from refcloud.plain.raster import Buffer, blend

Pixel = tuple[int, int]  # row, column
Place = tuple[int, int]  # x, y in sub-pixels

SUBPIXEL, GUARD = 256, 8192.0
UNIT, HAIR = 1 << 200, 1 << 100  # a sub-pixel; the hair is 2^-100 of it, squared 2^-200


def to_subpixels(x: float, y: float) -> Place:
    """Round a place to whole sub-pixels."""
    return math.floor(x * SUBPIXEL + 0.5), math.floor(y * SUBPIXEL + 0.5)


def meets_diamond(a: Place, b: Place, row: int, column: int) -> bool:
    """Tell whether the line a b, a hair before where it is, meets a pixel's diamond."""
    dx, dy = (b[0] - a[0]) * UNIT, (b[1] - a[1]) * UNIT
    # From the pixel's middle to a.
    ax = (a[0] - column * SUBPIXEL - SUBPIXEL // 2) * UNIT - HAIR
    ay = (a[1] - row * SUBPIXEL - SUBPIXEL // 2) * UNIT - 1
    # |x| + |y| is least at an end, or where x or y is 0: at p / q of the way.
    for p, q in ((0, 1), (1, 1), (-ax, dx), (-ay, dy)):
        if q < 0:
            p, q = -p, -q
        if q > 0 and 0 <= p <= q:
            far = abs(q * ax + p * dx) + abs(q * ay + p * dy)
            if far < q * UNIT * SUBPIXEL // 2:
                return True
    return False


def line_between(
    a: Place, b: Place, width: int, height: int, thickness: int = 1
) -> list[Pixel]:
    """List the pixels of a line between sub-pixels: diamonds it leaves."""
    along_x = abs(b[0] - a[0]) >= abs(b[1] - a[1])
    shift = (thickness - 1) * SUBPIXEL // 2
    x, y = (0, shift) if along_x else (shift, 0)
    a, b = (a[0] - x, a[1] - y), (b[0] - x, b[1] - y)
    found = []
    for row in range(-thickness, height):
        for column in range(-thickness, width):
            if meets_diamond(a, b, row, column) and not meets_diamond(
                b, b, row, column
            ):
                for k in range(thickness):
                    found.append((row + k, column) if along_x else (row, column + k))
    return sorted((r, c) for r, c in found if 0 <= r < height and 0 <= c < width)


def line_pixels(
    start: Sequence[float],
    end: Sequence[float],
    width: int,
    height: int,
    thickness: int = 1,
) -> list[Pixel]:
    """List the pixels of a line, row by row."""
    a, b = to_subpixels(*start), to_subpixels(*end)
    return line_between(a, b, width, height, thickness)


def holds(corners: Sequence[Place], row: int, column: int) -> bool:
    """Tell whether a triangle holds the centre of a pixel."""
    x = column * SUBPIXEL + SUBPIXEL // 2
    y = row * SUBPIXEL + SUBPIXEL // 2
    (ax, ay), (bx, by), (cx, cy) = corners
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if area == 0:
        return False
    if area < 0:
        (bx, by), (cx, cy) = (cx, cy), (bx, by)
    for px, py, qx, qy in ((ax, ay, bx, by), (bx, by, cx, cy), (cx, cy, ax, ay)):
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
    everywhere = ((row, column) for row in range(height) for column in range(width))
    return [pixel for pixel in everywhere if holds(places, *pixel)]


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


def inside(camera: Camera, place: Point, plane: int, near: float) -> float:
    """Say how far inside a cutting plane a place of the camera's frame lies."""
    right, up, depth = place
    if plane == 0:
        return depth - near
    across, size = (right, camera.width) if plane < 3 else (up, camera.height)
    far = (0.5 * size + GUARD) * (1.0 if camera.fov_y is None else depth)
    scaled = scale_of(camera) * across
    return far + scaled if plane % 2 else far - scaled


def meeting(a: Point, b: Point, inside_a: float, inside_b: float) -> Point:
    """Give the place between two points where a plane lies."""
    return along(a, (inside_a / (inside_a - inside_b), between(a, b)))


def cut_line(camera: Camera, a: Point, b: Point, near: float) -> list[Point]:
    """Cut a line by the near plane and by four far beside the window."""
    for plane in range(5):
        in_a, in_b = (inside(camera, place, plane, near) for place in (a, b))
        if in_a < 0.0 and in_b < 0.0:
            return []
        if in_a < 0.0:
            a = meeting(b, a, in_b, in_a)
        elif in_b < 0.0:
            b = meeting(a, b, in_a, in_b)
    return [a, b]


def cut_polygon(camera: Camera, corners: list[Point], near: float) -> list[Point]:
    """Cut a convex polygon by the same planes."""
    for plane in range(5):
        kept = []
        for k, here in enumerate(corners):
            before = corners[k - 1]
            in_before = inside(camera, before, plane, near)
            in_here = inside(camera, here, plane, near)
            if in_before < 0.0 <= in_here:
                kept.append(meeting(here, before, in_here, in_before))
            elif in_here < 0.0 <= in_before:
                kept.append(meeting(before, here, in_before, in_here))
            if in_here >= 0.0:
                kept.append(here)
        corners = kept
    return corners


def in_window(camera: Camera, place: Point, near: float) -> Place:
    """Put a place of the camera's frame into the window."""
    scale = scale_of(camera) / (1.0 if camera.fov_y is None else max(place[2], near))
    x = camera.width / 2.0 + scale * place[0]
    return to_subpixels(x, camera.height / 2.0 - scale * place[1])


def paint(buffer: Buffer, pixels: Sequence[Pixel], color: Sequence[float]) -> None:
    """Blend a colour over pixels."""
    for row, column in pixels:
        pixel = buffer[row][column]
        pixel[:] = blend(color, pixel, "SRC_ALPHA", "ONE_MINUS_SRC_ALPHA")


def draw_lines(
    buffer: Buffer,
    camera: Camera,
    lines: Sequence[Sequence[Point]],
    color: Sequence[float],
    thickness: int,
    near: float,
) -> None:
    """Cut, place and paint each line."""
    for start, end in lines:
        left = cut_line(camera, to_camera(camera, start), to_camera(camera, end), near)
        if left:
            a, b = (in_window(camera, place, near) for place in left)
            size = camera.width, camera.height
            paint(buffer, line_between(a, b, *size, thickness), color)


def draw_triangles(
    buffer: Buffer,
    camera: Camera,
    triangles: Sequence[Sequence[Point]],
    color: Sequence[float],
    near: float,
) -> None:
    """Cut, place and paint each triangle as a fan."""
    for corners in triangles:
        left = cut_polygon(camera, [to_camera(camera, c) for c in corners], near)
        places = [in_window(camera, place, near) for place in left]
        for k in range(1, len(places) - 1):
            fan = [places[0], places[k], places[k + 1]]
            pixels = [
                (row, column)
                for row in range(camera.height)
                for column in range(camera.width)
                if holds(fan, row, column)
            ]
            paint(buffer, pixels, color)


def faces_away(camera: Camera, corners: Sequence[Point]) -> bool:
    """Tell whether a triangle turns its back on the eye."""
    a, b, c = corners
    outward = cross(between(a, b), between(a, c))
    toward = axes(camera)[2] if camera.fov_y is None else between(a, camera.eye)
    return dot(outward, toward) <= 0.0


def draw_box(
    buffer: Buffer,
    camera: Camera,
    first: Point,
    second: Point,
    part: str,
    line_color: Sequence[float],
    wall_color: Sequence[float],
    thickness: int,
    near: float,
) -> None:
    """Draw the part of a box that lies behind what is inside, or before it."""
    triangles = box_triangles(first, second)
    away = [faces_away(camera, triangle) for triangle in triangles]
    mine = [t for t, a in zip(triangles, away, strict=True) if a == (part == "behind")]
    draw_triangles(buffer, camera, mine, wall_color, near)
    lines = []
    for a, b in box_lines(first, second):
        walls = [
            away[2 * k]
            for k in range(len(WALLS))
            if a in triangles[2 * k] + triangles[2 * k + 1]
            and b in triangles[2 * k] + triangles[2 * k + 1]
        ]
        if all(walls) == (part == "behind"):
            lines.append([a, b])
    draw_lines(buffer, camera, lines, line_color, thickness, near)
