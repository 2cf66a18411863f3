"""The box that document D draws around its cloud: walls and lines.

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
from refcloud.conventions import Array, Shape, Vector
from refcloud.raster.factors import Blending
from refcloud.raster.framebuffer import Framebuffer, Rgba
from refcloud.raster.lines import Thickness, draw_lines
from refcloud.raster.meshes import WORLD, separate
from refcloud.raster.store import State
from refcloud.raster.triangles import draw_triangles
from refcloud.raster.window import NEAR, Near, refuse_other_size

ORANGE = np.array([1.0, 0.32, 0.02, 1.0])  # linear light of a plain orange
LIGHT_BLUE = np.array([0.42, 0.70, 0.95, 0.5])
THROUGH = State(blending=Blending("SRC_ALPHA", "ONE_MINUS_SRC_ALPHA"))
for _color in (ORANGE, LIGHT_BLUE):
    _color.flags.writeable = False


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
        walls = separate(triangles[behind])
        draw_triangles(buffer, camera, walls, wall_color, state=THROUGH, near=near)
    if line_color[3] > 0.0:
        lines = box_lines(first, second)[line_behind]
        draw_lines(
            buffer, camera, lines, color=line_color, thickness=thickness, near=near
        )
