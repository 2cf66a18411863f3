"""The framebuffer and its splats, literally: clear, blend, splat, read back."""

from refcloud.raster.blending import blend
from refcloud.raster.footprint import Patch, footprint, patch, transmittance
from refcloud.raster.framebuffer import Framebuffer, clear, framebuffer, read_pixels
from refcloud.raster.splat import read_mean, splat

__all__ = [
    "Framebuffer",
    "Patch",
    "blend",
    "clear",
    "footprint",
    "framebuffer",
    "patch",
    "read_mean",
    "read_pixels",
    "splat",
    "transmittance",
]
