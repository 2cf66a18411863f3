"""The framebuffer, literally: clear, draw, blend, splat, lines, walls, read back."""

from refcloud.raster.blending import blend
from refcloud.raster.factors import Blending
from refcloud.raster.footprint import Patch, footprint, patch, transmittance
from refcloud.raster.formats import stored
from refcloud.raster.fragments import State, clear, draw_fragments
from refcloud.raster.framebuffer import Framebuffer, framebuffer
from refcloud.raster.layers import seen_through_layers
from refcloud.raster.lines import draw_lines, line_pixels
from refcloud.raster.quad import quad_corners, quad_points
from refcloud.raster.reading import read_average, read_pixels
from refcloud.raster.splat import read_mean, splat
from refcloud.raster.walls import (
    draw_box,
    draw_triangles,
    faces_away,
    triangle_pixels,
)

__all__ = [
    "Blending",
    "Framebuffer",
    "Patch",
    "State",
    "blend",
    "clear",
    "draw_box",
    "draw_fragments",
    "draw_lines",
    "draw_triangles",
    "faces_away",
    "footprint",
    "framebuffer",
    "line_pixels",
    "patch",
    "quad_corners",
    "quad_points",
    "read_average",
    "read_mean",
    "read_pixels",
    "seen_through_layers",
    "splat",
    "stored",
    "transmittance",
    "triangle_pixels",
]
