"""Small scenes that move: picklable, so that any process can draw them."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np

from refcloud import Camera, Picture, Sun
from refcloud.noise import fbm_grid
from refcloud.scene import Model, Motion, Scene, View

PERIOD = 2.0  # of time: cells along the third axis of the noise
DRAWN: list[float] = []  # times of the frames that this process drew


def looped(model: Model, view: View) -> Picture:
    """Draw a slice of noise that repeats itself along time, and along x by wind."""
    DRAWN.append(view.time)
    offset = np.zeros(3) if view.offset is None else view.offset
    x = (np.arange(view.width) + 0.5) * (4.0 / view.width) - offset[0]
    y = (np.arange(view.height) + 0.5) * (3.0 / view.height)
    # Four cells across, so that x and time repeat alike after four and two.
    z = 2.0 * np.array([view.time])
    grey = fbm_grid(x, y, z, octaves=2, period=4, seed=5)[0][0]
    return Picture(np.repeat(0.5 + 0.5 * grey[..., None], 3, axis=2))


def seen(model: Model, view: View) -> Picture:
    """Show eye and suns as colours: what moved can be read off."""
    camera = view.camera or own_eye(model, view)
    light = np.zeros((view.height, view.width, 3))
    light[0] = 0.5 + 0.1 * camera.eye
    if view.suns is not None:
        light[-1] = 0.5 + 0.1 * view.suns[0].direction
    return Picture(light, notes=("seen",))


def own_eye(model: Model, view: View) -> Camera:
    return Camera([0, 1, 3], [0, 1, 0], width=view.width, height=view.height)


def no_clouds() -> Model:
    return Model({})


LOOPED = Scene(
    "looped", "", no_clouds, looped, Motion(period=PERIOD, repeats=(4.0, 0.0, math.inf))
)
SEEN = Scene("seen", "", no_clouds, seen, Motion(own_eye, (Sun([1, 0, 0]),)))
STILL = dataclasses.replace(SEEN, name="still", motion=Motion())


def small(**more: Any) -> dict[str, Any]:
    return {"frames": 4, "width": 16, "height": 12, **more}
