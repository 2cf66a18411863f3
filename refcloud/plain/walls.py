"""Lines and the box around a cloud, one pixel at a time.

Each function is the twin of the one of the same name in `refcloud.raster`. Pixels are
asked one by one whether they belong to a line, in whole numbers.
"""

from __future__ import annotations

from collections.abc import Sequence

from refcloud.plain.box import WALLS, box_lines, box_triangles
from refcloud.plain.camera import Camera, Point, axes, between, cross, dot
from refcloud.plain.framebuffer import Rules, State
from refcloud.plain.raster import Buffer, blend
from refcloud.plain.triangles import Mesh, draw_triangles
from refcloud.plain.window import (
    SUBPIXEL,
    Place,
    in_window,
    inside,
    meeting,
    to_camera,
    to_subpixels,
)

Pixel = tuple[int, int]  # row, column

MIX = "SRC_ALPHA", "ONE_MINUS_SRC_ALPHA", "FUNC_ADD"
EVERY = True, True, True, True
OVER = State(Rules(MIX, MIX, (0, 0, 0, 0)), EVERY, None, None, False)
UNIT, HAIR = 1 << 200, 1 << 100  # a sub-pixel; the hair is 2^-100 of it, squared 2^-200


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
    corners = [corner for triangle in mine for corner in triangle]
    faces = [(3 * k, 3 * k + 1, 3 * k + 2) for k in range(len(mine))]
    mesh = Mesh(corners, faces, [()] * len(corners))
    depths: list[list[float]] = []  # neither tested nor written
    draw_triangles(buffer, depths, camera, mesh, lambda *_: wall_color, OVER, near)
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
