"""refcloud: a teaching reference for clouds, from noise to picture, in numpy."""

from refcloud import interrupts as interrupts  # before all others, see there
from refcloud import scenes
from refcloud.animation import Moves, animate
from refcloud.camera import Camera, OrthographicCamera
from refcloud.cloudmap import VoxelGrid, generate, load_voxels, save_voxels
from refcloud.conventions import Skipped
from refcloud.image import (
    Picture,
    compare_codes,
    difference_picture,
    load_picture,
)
from refcloud.lighting import Haze, LitMetaballs, Look, eyeward, sunward
from refcloud.metaballs import (
    Levels,
    Metaballs,
    approximate,
    choose_level,
    direct_metaballs,
    errors_of_fit,
    levels_of_detail,
    load_levels,
    load_metaballs,
    placed,
    save_levels,
    save_metaballs,
    voxel_balls,
)
from refcloud.optics import Medium, Sun
from refcloud.render import render
from refcloud.sky import Sky, clear_sky, sky_gradient

__version__ = "0.1.0"

__all__ = [
    "Camera",
    "Haze",
    "Levels",
    "LitMetaballs",
    "Look",
    "Medium",
    "Metaballs",
    "Moves",
    "OrthographicCamera",
    "Picture",
    "Skipped",
    "Sky",
    "Sun",
    "VoxelGrid",
    "animate",
    "approximate",
    "choose_level",
    "clear_sky",
    "compare_codes",
    "difference_picture",
    "direct_metaballs",
    "errors_of_fit",
    "eyeward",
    "generate",
    "levels_of_detail",
    "load_levels",
    "load_metaballs",
    "load_picture",
    "load_voxels",
    "placed",
    "render",
    "save_levels",
    "save_metaballs",
    "save_voxels",
    "scenes",
    "sky_gradient",
    "sunward",
    "voxel_balls",
]
