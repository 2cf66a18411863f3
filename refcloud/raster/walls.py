"""Plain triangles, and the box that document D draws around its cloud.

A triangle fills the pixels whose centres lie in it. A centre on an edge belongs to the
triangle whose left or upper edge it is, so that triangles that share an edge fill every
pixel of both once: at 50 % a pixel filled twice would show.

Of a box, the walls that look away from the eye and the lines between two such walls lie
behind everything inside; the other walls and lines lie before it. So the cloud goes
between two calls of `draw_box`.
"""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np

from refcloud.camera import Camera, OrthographicCamera, axes
from refcloud.checking import checked
from refcloud.cloudmap.box import LINES, WALLS, box_lines, box_triangles
from refcloud.conventions import Array, Range, Shape, Vector
from refcloud.raster.blending import Factor
from refcloud.raster.framebuffer import Framebuffer, Rgba, Size
from refcloud.raster.lines import HALF, Indices, Thickness, draw_lines
from refcloud.raster.window import (
    NEAR,
    SUBPIXEL,
    WORLD,
    Near,
    Places,
    blend_pixels,
    cut_polygon,
    planes_of,
    refuse_other_size,
    snapped,
    to_camera,
    to_subpixels,
)

ORANGE = np.array([1.0, 0.32, 0.02, 1.0])  # linear light of a plain orange
LIGHT_BLUE = np.array([0.42, 0.70, 0.95, 0.5])
for _color in (ORANGE, LIGHT_BLUE):
    _color.flags.writeable = False


@checked
def triangle_pixels(
    corners: Annotated[Array, Shape(3, 2), Range(-(2.0**22), 2.0**22, "pixels")],
    *,
    width: Size,
    height: Size,
) -> tuple[Indices, Indices]:
    """Find the pixels whose centres lie in a triangle.

    Formula: (b - a) x (f - a), (c - b) x (f - b) and (a - c) x (f - c) all have the
    sign of the triangle; 0 counts on a left or an upper edge

    Parameters
    ----------
    corners
        a, b, c in pixels from the left and the top edge, shape (3, 2), in any order;
        rounded to 1/256.
    width, height
        Size of the window.

    Returns
    -------
    Row and column of each pixel in the window, row by row.

    Source: OpenGL 4.6, section 14.6 (polygons); document D (F08).

    Examples
    --------
    >>> rows, columns = triangle_pixels([[0, 0], [3, 0], [0, 3]], width=2, height=2)
    >>> list(zip(rows.tolist(), columns.tolist()))
    [(0, 0), (0, 1), (1, 0)]
    """
    return pixels_inside(to_subpixels(corners), width, height)


def pixels_inside(corners: Places, width: int, height: int) -> tuple[Indices, Indices]:
    """Find the pixels of a triangle between sub-pixels, as `triangle_pixels`.

    Parameters
    ----------
    corners
        x and y in sub-pixels, shape (3, 2).
    width, height
        Size of the window.

    Returns
    -------
    As `triangle_pixels`.
    """
    a, b, c = corners
    area = int((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    # The pixels whose centres the triangle's bounds hold.
    low = np.maximum(-((HALF - corners.min(axis=0)) // SUBPIXEL), 0)
    high = np.minimum((corners.max(axis=0) - HALF) // SUBPIXEL + 1, [width, height])
    if area == 0 or (high <= low).any():
        return np.zeros(0, np.intp), np.zeros(0, np.intp)
    if area < 0:
        b, c = c, b
    x = np.arange(low[0], high[0]) * SUBPIXEL + HALF
    y = np.arange(low[1], high[1])[:, None] * SUBPIXEL + HALF
    inside = np.ones((y.size, x.size), bool)
    for start, end in ((a, b), (b, c), (c, a)):
        run, rise = end - start
        # Clockwise on the screen: upper edges run right, left ones run up.
        counts = rise < 0 or (rise == 0 and run > 0)
        inside &= run * (y - start[1]) - rise * (x - start[0]) >= (0 if counts else 1)
    rows, columns = np.nonzero(inside)
    return rows + low[1], columns + low[0]


@checked
def draw_triangles(
    buffer: Framebuffer,
    camera: Camera | OrthographicCamera,
    triangles: Annotated[Array, Shape("N", 3, 3), WORLD],
    *,
    color: Rgba,
    near: Near = NEAR,
    src_factor: Factor = "SRC_ALPHA",
    dst_factor: Factor = "ONE_MINUS_SRC_ALPHA",
) -> None:
    """Draw triangles of one colour, one after the other, as GL_TRIANGLES.

    Formula: c = f_src color + f_dst c at the pixels of `triangle_pixels`

    Parameters
    ----------
    buffer
        The framebuffer, of the camera's size, written in place.
    camera
        The eye.
    triangles
        Corners of each, shape (N, 3, 3), scene units; both sides are drawn.
    color
        RGBA, shape (4,), not multiplied by its alpha.
    near
        Depth before which triangles are cut off, scene units.
    src_factor, dst_factor
        Blend factors under OpenGL's names.

    Returns
    -------
    Nothing.

    Raises
    ------
    ValueError
        The framebuffer has another size than the camera's picture.

    Source: document D, Prior to Ray Tracing (F08).

    Examples
    --------
    >>> from refcloud.raster import framebuffer
    >>> buffer = framebuffer(2, 2)
    >>> view = OrthographicCamera([0, 0, 1], [0, 0, 0], width=2, height=2)
    >>> half = [[[-1, 1, 0], [2, 1, 0], [-1, -2, 0]]]
    >>> draw_triangles(buffer, view, half, color=[1, 1, 1, 0.5])
    >>> buffer.pixels[..., 0]
    array([[0.5, 0.5],
           [0.5, 0. ]])
    """
    refuse_other_size(buffer, camera)
    planes = planes_of(camera, near)
    for corners in to_camera(camera, triangles):
        polygon = cut_polygon(list(corners), planes)
        if len(polygon) < 3:
            continue
        # A fan: its inner edges are shared, so no pixel is filled twice.
        place = snapped(camera, np.stack(polygon), near)
        for k in range(1, len(place) - 1):
            found = pixels_inside(place[[0, k, k + 1]], camera.width, camera.height)
            blend_pixels(buffer, *found, color, src_factor, dst_factor)


@checked
def faces_away(
    camera: Camera | OrthographicCamera,
    triangles: Annotated[Array, Shape("N", 3, 3), WORLD],
) -> np.ndarray:
    """Tell which triangles turn their backs on the eye.

    Formula: ((b - a) x (c - a)) . (eye - a) <= 0, or . back <= 0 for parallel rays

    Parameters
    ----------
    camera
        The eye.
    triangles
        Shape (N, 3, 3), counterclockwise as seen from outside.

    Returns
    -------
    Shape (N,), booleans.

    Source: OpenGL 4.6, section 14.6.1 (facing); document D (F08).

    Examples
    --------
    >>> eye = Camera([0, 0, 9], [0, 0, 0])
    >>> bool(faces_away(eye, [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]])[0])
    False
    """
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    outward = np.cross(b - a, c - a)
    pinhole = isinstance(camera, Camera)
    toward = camera.eye - a if pinhole else np.broadcast_to(axes(camera)[2], a.shape)
    return np.einsum("ij,ij->i", outward, toward) <= 0.0


@checked
def draw_box(
    buffer: Framebuffer,
    camera: Camera | OrthographicCamera,
    first: Vector,
    second: Vector,
    part: Literal["behind", "before"],
    *,
    line_color: Rgba = ORANGE,
    wall_color: Rgba = LIGHT_BLUE,
    thickness: Thickness = 1,
    near: Near = NEAR,
) -> None:
    """Draw the walls and lines of a box that lie behind what is inside, or before it.

    Formula: SRC_ALPHA, ONE_MINUS_SRC_ALPHA; first walls, then lines

    Parameters
    ----------
    buffer
        The framebuffer, of the camera's size, written in place.
    camera
        The eye, outside or inside the box.
    first, second
        Any two opposite corners of the box, shape (3,), scene units.
    part
        "behind": walls that look away from the eye, lines between two of them, before
        the cloud is drawn; "before": all others, after it.
    line_color, wall_color
        RGBA, shape (4,); an alpha of 0 leaves them out.
    thickness
        Of the lines, pixels.
    near
        Depth before which the box is cut off, scene units.

    Returns
    -------
    Nothing.

    Raises
    ------
    ValueError
        The box is flat, or the framebuffer has another size than the camera's picture.

    Source: document D, Prior to Ray Tracing (F07, F08, F09).
    """
    refuse_other_size(buffer, camera)
    triangles = box_triangles(first, second)
    behind = faces_away(camera, triangles)
    # A line lies behind if both of its walls do: those that hold both of its ends.
    wall_behind = behind[::2]
    holds = (LINES[:, None, :, None] == WALLS[None, :, None, :]).any(3).all(2)
    line_behind = (~holds | wall_behind).all(axis=1)
    if part == "before":
        behind, line_behind = ~behind, ~line_behind
    if wall_color[3] > 0.0:
        draw_triangles(buffer, camera, triangles[behind], color=wall_color, near=near)
    if line_color[3] > 0.0:
        lines = box_lines(first, second)[line_behind]
        draw_lines(
            buffer, camera, lines, color=line_color, thickness=thickness, near=near
        )
