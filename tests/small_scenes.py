"""Scenes small enough for laws: hashed balls in front of one eye."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from twins.lighting import scattered_balls

from refcloud.camera import Camera
from refcloud.lighting import LitMetaballs, Look, eyeward, named, sunward
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun

EYE = Camera([0.5, 1.0, 7.0], [0, 0, 0], width=12, height=9)
BACKDROP = np.linspace(0.1, 0.9, 12 * 9 * 3).reshape(9, 12, 3)
MEDIUM = Medium(1.5, 0.9)
SMALL = {"buffer": 16, "sky_buffer": 8}
EXTENDED = dataclasses.replace(named("cumulus"), **SMALL)
# The paper's rules, with depths of the balls' own where a law needs thin ones.
PAPER = dataclasses.replace(named("man"), **SMALL)
DARK = {"sky_light": np.zeros(3), "ground_light": np.zeros(3)}
LOOKS = {"cumulus": EXTENDED, "man": PAPER}
SUNS = Sun([1, 2, 3], [9, 8, 7]), Sun([-1, 0.5, -0.2], [2, 3, 6])
BALLS = scattered_balls(5, 6)


def drawn(
    balls: Metaballs,
    suns: tuple[Sun, ...],
    *,
    medium: Medium = MEDIUM,
    look: Look = EXTENDED,
    camera: Any = EYE,
    **how: Any,
) -> np.ndarray:
    """Run both passes; RGBA."""
    lit: LitMetaballs = sunward(balls, suns, medium=medium, look=look)
    return eyeward(lit, camera, **how)[0]
