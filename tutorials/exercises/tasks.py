"""The pictures that students' own code is compared with, each by the library.

    python tutorials/exercises/tasks.py        writes them all into this folder

`tutorials/teachers.md` says what each of them shows, to the last constant.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

from refcloud import cloudmap, metaballs, noise, raster
from refcloud.image import srgb_encode, write_png
from refcloud.optics import scattered_split

HERE = Path(__file__).parent


def codes(values: np.ndarray) -> np.ndarray:
    """Write values in [0, 1] as codes: floor(255 v + 1/2), grey where there is one."""
    shown = np.floor(255.0 * np.clip(values, 0.0, 1.0) + 0.5).astype(np.uint8)
    return shown if shown.ndim == 3 else np.repeat(shown[..., None], 3, axis=-1)


def hashed() -> np.ndarray:
    """Task 1: equation 2 of a square of lattice points."""
    x, y = np.meshgrid(np.arange(64), np.arange(64))
    return codes((noise.man2003(x, y, np.zeros_like(x)) + 1.0) / 2.0)


def _places() -> np.ndarray:
    """Give the points of tasks 2 and 3: twelve pixels to a cell."""
    along = (np.arange(96) + 0.5) / 12.0
    return np.stack([*np.meshgrid(along, along), np.full((96, 96), 0.25)], axis=-1)


def value() -> np.ndarray:
    """Task 2: value noise by cosines, without smoothing."""
    found = noise.value(_places(), seed=None, interpolant="cosine", smooth=False)
    return codes((found + 1.0) / 2.0)


def octaves() -> np.ndarray:
    """Task 3: equation 1 of four octaves, smoothed by equation 3."""
    return codes(noise.octave_sum(_places(), seed=None))


def ellipsoid() -> np.ndarray:
    """Task 4: the density of equations 8 to 10 in a plane."""
    x = -32.0 + 64.0 * (np.arange(96) + 0.5) / 96.0
    y = 64.0 / 3.0 - 128.0 / 3.0 * (np.arange(64) + 0.5) / 64.0
    points = np.stack([*np.meshgrid(x, y), np.zeros((64, 96))], axis=-1)
    Q = cloudmap.evaluate_quadric(cloudmap.quadric([0, 0, 0], [30, 17, 22]), points)
    density = cloudmap.modulate(Q, noise.octave_sum(points / 16.0, seed=None))
    return codes(density / 0.6)


BALLS = metaballs.Metaballs(
    [[-0.7, 0.1, 0.0], [0.5, -0.2, 0.3], [0.6, 0.5, -0.2]],
    [0.9, 0.8, 0.5],
    [1.0, 0.8, 0.6],
)


def field() -> np.ndarray:
    """Task 5: the density of three metaballs in a plane."""
    x = -1.8 + 3.6 * (np.arange(96) + 0.5) / 96.0
    y = 1.2 - 2.4 * (np.arange(64) + 0.5) / 64.0
    points = np.stack([*np.meshgrid(x, y), np.zeros((64, 96))], axis=-1)
    return codes(metaballs.field(BALLS, points))


SPLATS = (  # x, y, radius in pixels, colour, optical depth
    (34.0, 36.0, 24.0, (0.95, 0.6, 0.35), 3.0),
    (50.0, 28.0, 22.0, (0.9, 0.9, 0.9), 2.0),
    (66.0, 38.0, 18.0, (0.35, 0.6, 0.9), 4.0),
)


def blended() -> np.ndarray:
    """Task 6: three splats, one over the other."""
    buffer = raster.framebuffer(96, 64, color=[0.2, 0.35, 0.6, 1.0])
    for x, y, radius, colour, tau in SPLATS:
        opaque = -math.expm1(-tau)
        emission = [opaque * c for c in colour]
        raster.splat(buffer, x, y, radius, emission=emission, tau=tau)
    return codes(srgb_encode(buffer.pixels[..., :3]))


SHADED = (  # x, y and radius in pixels, from near the sun to far from it
    (32.0, 20.0, 12.0),
    (24.0, 30.0, 14.0),
    (40.0, 32.0, 14.0),
    (30.0, 40.0, 16.0),
    (42.0, 44.0, 10.0),
)
DEPTH, FORWARD = 1.5, 0.7


def readback() -> np.ndarray:
    """Task 7: the sun's framebuffer after pass 1, five balls."""
    buffer = raster.framebuffer(64, 64, color=np.ones(4))
    for x, y, radius in SHADED:
        mean, ball = (
            raster.read_mean(buffer, x, y, radius),
            raster.patch(x, y, radius, 64, 64),
        )
        assert mean is not None
        assert ball is not None
        tau = DEPTH * raster.footprint(ball.q)
        grey = mean[0] * scattered_split(tau, FORWARD)
        source = np.stack([grey, grey, grey, -np.expm1(-tau)], axis=-1)
        pair = "ONE", "ONE_MINUS_SRC_ALPHA"
        raster.blend(buffer, ball.rows, ball.columns, source, *pair)
    return codes(buffer.pixels[..., 0])


SIGMA_T, REACH, STEPS, SUN_STEPS = 4.0, 1.2, 64, 32


def marched() -> np.ndarray:
    """Task 8: one metaball, marched, the sun at the right."""
    place = REACH * (2.0 * (np.arange(64) + 0.5) / 64.0 - 1.0)
    x, y = np.meshgrid(place, -place)
    dt, ds = 2.0 * REACH / STEPS, 2.0 * REACH / SUN_STEPS
    light, through = np.zeros((64, 64)), np.ones((64, 64))
    for step in range(STEPS):
        z = REACH - (step + 0.5) * dt
        toward = x[..., None] + (np.arange(SUN_STEPS) + 0.5) * ds
        off = toward**2 + (y**2 + z**2)[..., None]
        sun = np.exp(-SIGMA_T * ds * metaballs.profile(off).sum(axis=-1))
        tau = SIGMA_T * dt * metaballs.profile(x**2 + y**2 + z**2)
        light += through * sun * -np.expm1(-tau)
        through *= np.exp(-tau)
    return codes(light)


TASKS: dict[str, Callable[[], np.ndarray]] = {
    "1-hash": hashed,
    "2-value": value,
    "3-octaves": octaves,
    "4-ellipsoid": ellipsoid,
    "5-field": field,
    "6-blend": blended,
    "7-readback": readback,
    "8-march": marched,
}

if __name__ == "__main__":
    for name, draw in TASKS.items():
        print(write_png(HERE / f"{name}.png", draw()))
