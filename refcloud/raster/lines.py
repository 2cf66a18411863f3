"""Lines of the world: cut, placed, tested and blended, all at once."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.camera import Camera, OrthographicCamera
from refcloud.checking import checked
from refcloud.conventions import Array, Shape
from refcloud.raster.clipping import cut_lines
from refcloud.raster.diamonds import Thickness, pixels_between
from refcloud.raster.factors import Blending, Factor
from refcloud.raster.framebuffer import CHANNELS, Framebuffer, Rgba
from refcloud.raster.meshes import WORLD
from refcloud.raster.runs import View
from refcloud.raster.spans import batches
from refcloud.raster.store import DepthFunc, State, flattened, unflattened, write
from refcloud.raster.visible import layers
from refcloud.raster.window import (
    NEAR,
    SUBPIXEL,
    Far,
    Near,
    planes_of,
    refuse_depths,
    refuse_other_size,
    snapped,
    to_camera,
)

AT_ONCE = 1 << 17  # pixels, about, that are found together


@checked
def draw_lines(
    buffer: Framebuffer,
    camera: Camera | OrthographicCamera,
    lines: Annotated[Array, Shape("N", 2, 3), WORLD],
    *,
    color: Rgba,
    thickness: Thickness = 1,
    near: Near = NEAR,
    far: Far | None = None,
    depth_func: DepthFunc | None = None,
    depth_mask: bool = True,
    src_factor: Factor = "SRC_ALPHA",
    dst_factor: Factor = "ONE_MINUS_SRC_ALPHA",
) -> None:
    """Draw lines of the world, one after the other, as GL_LINES.

    Formula: c = f_src color + f_dst c at the pixels of `line_pixels`, where the depth
    z_a + t (z_b - z_a) passes, t = (x - x_a) / (x_b - x_a) of a line along x

    Parameters
    ----------
    buffer
        The framebuffer, of the camera's size, written in place.
    camera
        The eye.
    lines
        Start and end of each, shape (N, 2, 3), scene units.
    color
        RGBA, shape (4,), not multiplied by its alpha.
    thickness
        Pixels across; 1 is OpenGL's default.
    near, far
        Depths between which lines are cut off, scene units; without far nothing is too
        far. Depth in the buffer is 0 at near and 1 at far, or at infinity.
    depth_func
        Which depths pass against the buffer's (glDepthFunc); None neither tests nor
        writes depths.
    depth_mask
        Whether depths may be written (glDepthMask).
    src_factor, dst_factor
        Blend factors under OpenGL's names.

    Returns
    -------
    Nothing.

    Raises
    ------
    ValueError
        The framebuffer has another size than the camera's picture, far is not beyond
        near, or parallel rays meet a depth test without far.

    Source: OpenGL 4.6, section 14.5; document D, Prior to Ray Tracing (F07).

    Examples
    --------
    >>> from refcloud.raster import framebuffer
    >>> buffer = framebuffer(4, 3)
    >>> view = OrthographicCamera([0, 0, 1], [0, 0, 0], width=4, height=3)
    >>> draw_lines(buffer, view, [[[-9, 0, 0], [9, 0, 0]]], color=[1, 0.5, 0, 1])
    >>> buffer.pixels[..., 0].sum(axis=1)
    array([0., 4., 0.])
    """
    refuse_other_size(buffer, camera)
    refuse_depths(camera, near, far, depth_func)
    blending = Blending(src_factor, dst_factor)
    states = (
        State(blending, depth_func=depth_func, depth_mask=depth_mask),
        State(blending),
    )
    height, width = buffer.pixels.shape[:2]
    store, scratch = flattened(buffer), np.empty(height * width, np.int64)

    # 1. Into the camera's frame, cut, and into the window, on whole sub-pixels.
    cut = cut_lines(to_camera(camera, lines), planes_of(camera, near, far))
    ends = snapped(camera, cut, near)

    # 2. Depths at the ends: those in the buffer are linear on the screen.
    pinhole = isinstance(camera, Camera)
    away = np.clip(cut[..., 2], near, far)
    at_ends = View(pinhole, near, far).depth(1.0 / away if pinhole else away)

    # 3. The pixels of some lines at a time, in turn where lines share one.
    longest = np.abs(ends[:, 1] - ends[:, 0]).max(axis=1, initial=0) // SUBPIXEL + 2
    reach = np.minimum(longest, max(height, width)) * thickness
    for some in batches(reach, AT_ONCE):
        found = pixels_between(ends[some], width, height, thickness)
        start, end = at_ends[some][found.line].T
        depth = np.clip(start + found.share * (end - start), 0.0, 1.0)
        pixel = found.row * width + found.column
        for layer, left in layers(store, states, pixel, lambda d=depth: d, scratch):
            source = np.broadcast_to(color, (len(pixel[layer]), CHANNELS))
            write(store, (pixel[layer],), source, depth[layer], left)
    unflattened(store, buffer)
