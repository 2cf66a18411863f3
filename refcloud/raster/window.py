"""From the world into the window: cut off in front of the eye, snapped to sub-pixels.

As OpenGL does it: geometry is cut where it comes nearer than the near plane and far
beside the window, before anything is divided by depth; what is left goes to whole
multiples of 1/256 pixel. From there on pixels are found in integers, so that no
rounding decides whether one is drawn.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import AnyCamera, Camera, axes
from refcloud.checking import complaint
from refcloud.conventions import Array, Range
from refcloud.raster.framebuffer import CHANNELS, Framebuffer

Places = NDArray[np.int64]  # in sub-pixels, y downward

SUBPIXEL = 256  # 8 bits, what graphics hardware has
# How far beside the window geometry is cut: no cut shows, and the products of two
# coordinates stay below 2^63 in every picture of up to 8.3 megapixels.
GUARD = 8192.0
NEAR = 1e-3
Near = Annotated[float, Range(1e-100, 1e100, "scene units")]
Far = Annotated[float, Range(1e-100, 1e100, "scene units")]


def to_camera(camera: AnyCamera, points: Array) -> Array:
    """Give points in the camera's frame.

    Parameters
    ----------
    camera
        Pinhole or orthographic.
    points
        Shape (..., 3), scene units.

    Returns
    -------
    Right, up and depth, shape (..., 3).
    """
    right, up, back = axes(camera)
    ahead = points - camera.eye
    # Without a matrix product: the same bits wherever a point stands in the list.
    return np.stack(
        [
            ahead[..., 0] * axis[0] + ahead[..., 1] * axis[1] + ahead[..., 2] * axis[2]
            for axis in (right, up, -back)
        ],
        axis=-1,
    )


def scale_of(camera: AnyCamera) -> float:
    """Give pixels per scene unit: at depth 1, or anywhere if orthographic."""
    if isinstance(camera, Camera):
        return 0.5 * camera.height / math.tan(0.5 * camera.fov_y)
    return camera.height / camera.height_of_view


def planes_of(
    camera: AnyCamera, near: float, far: float | None = None, guard: float = GUARD
) -> Array:
    """Give the planes that cut geometry, the near one first.

    Parameters
    ----------
    camera
        Pinhole or orthographic.
    near, far
        Depths of the near and the far plane, scene units; None for no far one.
    guard
        How far beside the window the other planes lie, pixels.

    Returns
    -------
    Shape (5, 4) or (6, 4): a b c d, with a right + b up + c depth + d at least 0
    inside.
    """
    scale = scale_of(camera)
    aside, above = 0.5 * camera.width + guard, 0.5 * camera.height + guard
    pinhole = isinstance(camera, Camera)

    def side(right: float, up: float, reach: float) -> list[float]:
        """Limit scale * right or up to reach, times depth for a pinhole."""
        return [right, up, reach * pinhole, reach * (not pinhole)]

    planes = np.array(
        [
            [0.0, 0.0, 1.0, -near],
            side(scale, 0.0, aside),
            side(-scale, 0.0, aside),
            side(0.0, scale, above),
            side(0.0, -scale, above),
            *([] if far is None else [[0.0, 0.0, -1.0, far]]),
        ]
    )
    # Only signs and shares matter; at most 1, they bring no overflow.
    return planes / np.abs(planes).max(axis=1, keepdims=True)


def snapped(camera: AnyCamera, place: Array, near: float) -> Places:
    """Put a place of the camera's frame into the window, on whole sub-pixels.

    Parameters
    ----------
    camera
        Pinhole or orthographic.
    place
        Right, up and depth, shape (..., 3), within the planes.
    near
        Depth of the near plane, scene units.

    Returns
    -------
    x and y from the left and the top edge, shape (..., 2), sub-pixels.
    """
    scale = np.full(place.shape[:-1], scale_of(camera))
    if isinstance(camera, Camera):
        # Rounding may have left a cut end a last bit before the near plane.
        scale = scale / np.maximum(place[..., 2], near)
    middle = 0.5 * np.array([camera.width, camera.height])
    aside = np.stack([scale * place[..., 0], -scale * place[..., 1]], axis=-1)
    # Of a line that ends at 1e20 no digit of the cut end is left: hold it in the room.
    room = middle + (GUARD + 1.0)
    return to_subpixels(middle + np.clip(aside, -room, room))


def to_subpixels(pixels: Array) -> Places:
    """Round pixels to whole sub-pixels.

    Parameters
    ----------
    pixels
        Any shape.

    Returns
    -------
    The same shape; a half goes up.
    """
    return np.floor(pixels * SUBPIXEL + 0.5).astype(np.int64)


def refuse_depths(
    camera: AnyCamera, near: float, far: float | None, depth_func: str | None
) -> None:
    """Refuse a far plane before the near one, or a depth test that has no scale."""
    if far is not None and far <= near:
        got = f"{far:g}, near {near:g}"
        raise ValueError(complaint("far", "a depth beyond near", got))
    parallel = not isinstance(camera, Camera)
    if parallel and far is None and depth_func is not None:
        expected = "a depth for the depth test of parallel rays"
        raise ValueError(complaint("far", expected, "None"))


def refuse_other_size(buffer: Framebuffer, camera: AnyCamera) -> None:
    """Refuse a framebuffer that is not as large as the camera's picture."""
    size = camera.height, camera.width
    if buffer.pixels.shape[:2] != size:
        got = f"shape {buffer.pixels.shape}"
        expected = f"shape {(*size, CHANNELS)}, the size of the camera's picture"
        raise ValueError(complaint("buffer", expected, got))
