"""The two passes of light: toward each ball, and from there toward the eye."""

from refcloud.lighting.colours import Haze, ball_colours
from refcloud.lighting.erosion import detail_grid, eroded, lit_share
from refcloud.lighting.eyeward import eyeward
from refcloud.lighting.lightfield import LightField, field_value, light_field
from refcloud.lighting.lit import LitMetaballs
from refcloud.lighting.literal import eyeward_literal
from refcloud.lighting.look import MAN, Look, named
from refcloud.lighting.order import depth_order
from refcloud.lighting.sunward import sunward

__all__ = [
    "MAN",
    "Haze",
    "LightField",
    "LitMetaballs",
    "Look",
    "ball_colours",
    "depth_order",
    "detail_grid",
    "eroded",
    "eyeward",
    "eyeward_literal",
    "field_value",
    "light_field",
    "lit_share",
    "named",
    "sunward",
]
