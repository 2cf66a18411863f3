"""The two passes of light: toward each ball, and from there toward the eye."""

from refcloud.lighting.colours import Haze, ball_colours
from refcloud.lighting.erosion import detail_grid, eroded
from refcloud.lighting.eyeward import eyeward
from refcloud.lighting.look import MAN, Look, named
from refcloud.lighting.order import depth_order
from refcloud.lighting.smoothing import Blend, colour_blend
from refcloud.lighting.sunward import LitMetaballs, sunward

__all__ = [
    "MAN",
    "Blend",
    "Haze",
    "LitMetaballs",
    "Look",
    "ball_colours",
    "colour_blend",
    "depth_order",
    "detail_grid",
    "eroded",
    "eyeward",
    "named",
    "sunward",
]
