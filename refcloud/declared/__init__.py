"""Declared scenes: read from TOML, written to it, and drawn."""

from refcloud.declared.declaration import Cloud, Declaration, Placement, Scale
from refcloud.declared.drawn import scene_from
from refcloud.declared.kinds import (
    KINDS,
    Changed,
    Kind,
    declared_kind,
    enter_kind,
    nothing_own,
    sun_alone,
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
    "nothing_own",
    "save_scene",
    "scene_from",
    "sun_alone",
    "told",
]
