"""Skies, one pixel at a time.

Each function is the twin of the one of the same name in `refcloud.sky`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from refcloud.plain.camera import Camera, Point, dot, rays
from refcloud.plain.optics import henyey_greenstein

Colour = Sequence[float]  # red, green, blue


class Sky(NamedTuple):
    """A clear sky, fields as `refcloud.sky.Sky`."""

    zenith: Colour
    horizon: Colour
    haze: Colour
    bend: float
    haze_height: float
    glow: float
    glow_g: float


def mix(a: Colour, b: Colour, t: float) -> list[float]:
    """Go from one colour to another."""
    return [p * (1.0 - t) + q * t for p, q in zip(a, b, strict=True)]


def clear_sky(
    camera: Camera,
    sky: Sky,
    suns: Sequence[tuple[Point, Colour]],
    column: int,
    row: int,
) -> list[float]:
    """Paint one pixel; a sun is its direction and its irradiance."""
    _, direction = rays(camera, column, row)
    y = max(direction[1], 0.0)
    color = mix(sky.horizon, sky.zenith, y**sky.bend)
    color = mix(color, sky.haze, math.exp(-y / sky.haze_height))
    for toward, irradiance in suns:
        if max(irradiance) > 0.0:
            cos_theta = max(min(dot(direction, toward), 1.0), -1.0)
            lobe = henyey_greenstein(cos_theta, sky.glow_g)
            for channel in range(3):
                color[channel] += sky.glow * lobe * irradiance[channel]
    return color


def sky_gradient(top: Colour, bottom: Colour, row: int, height: int) -> list[float]:
    """Paint one pixel of a gradient from the top row to the bottom row."""
    return mix(top, bottom, (row + 0.5) / height)


def scale(value: float, a: float, b: float, c: float, d: float) -> float:
    """Map [a, b] to [c, d], the printed shader's helper."""
    return (value - a) / (b - a) * (d - c) + c


def printed_gradient(row: int, height: int) -> list[float]:
    """Paint one pixel of the sky as printed: (.39, .30, .65) less a grey (E34)."""
    y = 1.0 - 2.0 * (row + 0.5) / height
    grey = scale(y, -1.0, 1.0, 0.4, 0.6)
    return [max(channel - grey, 0.0) for channel in (0.39, 0.30, 0.65)]
