"""Named scenes: the composed cumulus, and the figures of the documents."""

from refcloud.scene import SCENES, Model, Motion, Scene, View
from refcloud.scenes import (
    cumulus,
    demand,
    demand_hero,
    demand_plane,
    man,
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
    "multiple",
    "shader",
    "shader_light",
    "shader_objects",
    "shader_particles",
    "simple",
]
