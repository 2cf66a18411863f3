"""The framebuffer on OpenGL, through moderngl, under the names of refcloud.raster."""

from refcloud.gl.fragments import clear, draw_fragments
from refcloud.gl.opengl import context, renderer
from refcloud.gl.target import (
    Target,
    framebuffer,
    read_average,
    read_depth,
    read_pixels,
    write_pixels,
)

__all__ = [
    "Target",
    "clear",
    "context",
    "draw_fragments",
    "framebuffer",
    "read_average",
    "read_depth",
    "read_pixels",
    "renderer",
    "write_pixels",
]
