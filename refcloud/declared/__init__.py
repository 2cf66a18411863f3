"""Declared scenes: read from TOML, written to it, and drawn."""

from refcloud.declared.declaration import Cloud, Declaration, Placement, Scale
from refcloud.declared.drawn import scene_from
from refcloud.declared.kinds import (
    KINDS,
    Changed,
    Kind,
    declared_kind,
    enter_kind,
    told,
)
from refcloud.declared.reading import load_scene
from refcloud.declared.writing import save_scene

__all__ = [
    "KINDS",
    "Changed",
    "Cloud",
    "Declaration",
    "Kind",
    "Placement",
    "Scale",
    "declared_kind",
    "enter_kind",
    "load_scene",
    "save_scene",
    "scene_from",
    "told",
]
