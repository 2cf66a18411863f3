"""The framebuffer, literally: clear, draw, blend, splat, lines, walls, read back."""

from refcloud.raster.blending import blend
from refcloud.raster.factors import Blending
from refcloud.raster.footprint import Patch, footprint, patch, transmittance
from refcloud.raster.formats import stored
from refcloud.raster.fragments import clear, draw_fragments
from refcloud.raster.framebuffer import Framebuffer, framebuffer
from refcloud.raster.layers import seen_through_layers
from refcloud.raster.lines import draw_lines, line_pixels
from refcloud.raster.lookup import sample
from refcloud.raster.meshes import Mesh, dome_mesh, plane_mesh, sphere_mesh
from refcloud.raster.mipmaps import mip_levels
from refcloud.raster.quad import quad_corners, quad_points
from refcloud.raster.reading import read_average, read_pixels
from refcloud.raster.spans import triangle_pixels
from refcloud.raster.splat import read_mean, splat
from refcloud.raster.store import State
from refcloud.raster.texture import Texture
from refcloud.raster.triangles import Textured, draw_triangles
from refcloud.raster.varying import Fragments
from refcloud.raster.walls import draw_box, faces_away

__all__ = [
    "Blending",
    "Fragments",
    "Framebuffer",
    "Mesh",
    "Patch",
    "State",
    "Texture",
    "Textured",
    "blend",
    "clear",
    "dome_mesh",
    "draw_box",
    "draw_fragments",
    "draw_lines",
    "draw_triangles",
    "faces_away",
    "footprint",
    "framebuffer",
    "line_pixels",
    "mip_levels",
    "patch",
    "plane_mesh",
    "quad_corners",
    "quad_points",
    "read_average",
    "read_mean",
    "read_pixels",
    "sample",
    "seen_through_layers",
    "sphere_mesh",
    "splat",
    "stored",
    "transmittance",
    "triangle_pixels",
]
