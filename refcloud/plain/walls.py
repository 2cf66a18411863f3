"""Lines and the box around a cloud, one pixel at a time.

Each function is the twin of the one of the same name in `refcloud.raster`. Pixels are
asked one by one whether they belong to a line, in whole numbers.
"""

from __future__ import annotations

from collections.abc import Sequence

from refcloud.plain.box import WALLS, box_lines, box_triangles
from refcloud.plain.camera import Camera, Point, axes, between, cross, dot
from refcloud.plain.framebuffer import Rules, State, draw_fragments
from refcloud.plain.raster import Buffer
from refcloud.plain.triangles import Mesh, depth_in_buffer, draw_triangles
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


def cut_line(
    camera: Camera, a: Point, b: Point, near: float, far: float | None
) -> list[Point]:
    """Cut a line by the near plane, four far beside the window, and the far one."""
    for plane in range(6):
        in_a, in_b = (inside(camera, place, plane, near, far) for place in (a, b))
        if in_a < 0.0 and in_b < 0.0:
            return []
        if in_a < 0.0:
            a = meeting(b, a, in_b, in_a)
        elif in_b < 0.0:
            b = meeting(a, b, in_a, in_b)
    return [a, b]


def depth_at(a: Place, b: Place, depth: Sequence[float], pixel: Pixel) -> float:
    """Give the depth of a line where it crosses a pixel's column, or row."""
    x, y = (n * SUBPIXEL + SUBPIXEL // 2 for n in pixel[::-1])
    dx, dy = b[0] - a[0], b[1] - a[1]
    share = (x - a[0]) / dx if abs(dx) >= abs(dy) else (y - a[1]) / dy
    return min(max(depth[0] + share * (depth[1] - depth[0]), 0.0), 1.0)


def draw_lines(
    buffer: Buffer,
    depths: list[list[float]],
    camera: Camera,
    lines: Sequence[Sequence[Point]],
    color: Sequence[float],
    thickness: int,
    near: float,
    far: float | None,
    state: State,
) -> None:
    """Cut, place and draw one line and one pixel after the other."""
    size = camera.width, camera.height
    for start, end in lines:
        places = to_camera(camera, start), to_camera(camera, end)
        left = cut_line(camera, *places, near, far)
        if not left:
            continue
        a, b = (in_window(camera, place, near) for place in left)
        at_ends = [depth_in_buffer(camera, place[2], near, far) for place in left]
        for pixel in line_between(a, b, *size, thickness):
            depth = depth_at(a, b, at_ends, pixel)
            fragment = *pixel, depth, color
            draw_fragments(buffer, depths, [fragment], state, "RGBA64F")


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
    draw_lines(buffer, depths, camera, lines, line_color, thickness, near, None, OVER)
