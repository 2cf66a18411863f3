"""The framebuffer and its splats, literally: clear, draw, blend, splat, read back."""

from refcloud.raster.blending import blend
from refcloud.raster.factors import Blending
from refcloud.raster.footprint import Patch, footprint, patch, transmittance
from refcloud.raster.formats import stored
from refcloud.raster.fragments import State, clear, draw_fragments
from refcloud.raster.framebuffer import Framebuffer, framebuffer
from refcloud.raster.layers import seen_through_layers
from refcloud.raster.reading import read_average, read_pixels
from refcloud.raster.splat import read_mean, splat

__all__ = [
    "Blending",
    "Framebuffer",
    "Patch",
    "State",
    "blend",
    "clear",
    "draw_fragments",
    "footprint",
    "framebuffer",
    "patch",
    "read_average",
    "read_mean",
    "read_pixels",
    "seen_through_layers",
    "splat",
    "stored",
    "transmittance",
]
