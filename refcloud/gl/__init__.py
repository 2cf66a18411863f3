"""The framebuffer and both passes of light on OpenGL, through moderngl.

The same names as in the rooms: `framebuffer`, `clear`, `draw_fragments`, `read_pixels`
and `read_average` of refcloud.raster, `sunward` and `eyeward` of refcloud.lighting.
"""

from refcloud.gl.eyeward import eyeward
from refcloud.gl.fragments import clear, draw_fragments
from refcloud.gl.opengl import context, renderer
from refcloud.gl.sunward import sunward
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
    "eyeward",
    "framebuffer",
    "read_average",
    "read_depth",
    "read_pixels",
    "renderer",
    "sunward",
    "write_pixels",
]
