"""Marching rays through a cloud: paper D's renderer, exact or as close as asked for."""

from refcloud.march.box import ray_box
from refcloud.march.chords import ball_columns
from refcloud.march.integrate import integrate
from refcloud.march.light import segment_share, sources
from refcloud.march.mixing import Mixing
from refcloud.march.steps import march_by_steps, sun_depth_by_steps

__all__ = [
    "Mixing",
    "ball_columns",
    "integrate",
    "march_by_steps",
    "ray_box",
    "segment_share",
    "sources",
    "sun_depth_by_steps",
]
