"""Named scenes: the composed cumulus, and the figures of the documents."""

from refcloud.scene import SCENES, Model, Motion, Scene, View
from refcloud.scenes import (
    cumulus,
    demand,
    demand_hero,
    demand_plane,
    man,
    man_net,
    man_passes,
    man_plots,
    multiple,
    shader,
    shader_light,
    shader_objects,
    shader_particles,
    simple,
)

__all__ = [
    "SCENES",
    "Model",
    "Motion",
    "Scene",
    "View",
    "cumulus",
    "demand",
    "demand_hero",
    "demand_plane",
    "man",
    "man_net",
    "man_passes",
    "man_plots",
    "multiple",
    "shader",
    "shader_light",
    "shader_objects",
    "shader_particles",
    "simple",
]
