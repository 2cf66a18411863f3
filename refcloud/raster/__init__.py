"""The framebuffer, literally: clear, blend, splat, lines and walls, read back."""

from refcloud.raster.blending import blend
from refcloud.raster.footprint import Patch, footprint, patch, transmittance
from refcloud.raster.framebuffer import Framebuffer, clear, framebuffer, read_pixels
from refcloud.raster.lines import draw_lines, line_pixels
from refcloud.raster.quad import quad_corners, quad_points
from refcloud.raster.splat import read_mean, splat
from refcloud.raster.walls import (
    draw_box,
    draw_triangles,
    faces_away,
    triangle_pixels,
)

__all__ = [
    "Framebuffer",
    "Patch",
    "blend",
    "clear",
    "draw_box",
    "draw_lines",
    "draw_triangles",
    "faces_away",
    "footprint",
    "framebuffer",
    "line_pixels",
    "patch",
    "quad_corners",
    "quad_points",
    "read_mean",
    "read_pixels",
    "splat",
    "transmittance",
    "triangle_pixels",
]
