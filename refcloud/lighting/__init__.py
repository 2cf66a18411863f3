"""Light toward each ball or voxel, and from there toward the eye."""

from refcloud.lighting.colours import Haze, ball_colours
from refcloud.lighting.erosion import detail_grid, eroded, lit_share
from refcloud.lighting.eyeward import eyeward
from refcloud.lighting.lightfield import LightField, field_value, light_field
from refcloud.lighting.lit import LitMetaballs
from refcloud.lighting.literal import eyeward_literal
from refcloud.lighting.look import MAN, Look, named
from refcloud.lighting.octave_march import octave_march
from refcloud.lighting.octaves import (
    SINGLE,
    Octaves,
    octave_lobe,
    octave_source,
    sky_source,
)
from refcloud.lighting.order import depth_order
from refcloud.lighting.shining import march_shining
from refcloud.lighting.solved import lit_by_solution, solved_light
from refcloud.lighting.solved_march import block_means, solved_march
from refcloud.lighting.sunward import sunward

__all__ = [
    "MAN",
    "SINGLE",
    "Haze",
    "LightField",
    "LitMetaballs",
    "Look",
    "Octaves",
    "ball_colours",
    "block_means",
    "depth_order",
    "detail_grid",
    "eroded",
    "eyeward",
    "eyeward_literal",
    "field_value",
    "light_field",
    "lit_by_solution",
    "lit_share",
    "march_shining",
    "named",
    "octave_lobe",
    "octave_march",
    "octave_source",
    "sky_source",
    "solved_light",
    "solved_march",
    "sunward",
]
