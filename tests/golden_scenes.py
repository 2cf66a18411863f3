"""The scenes that have a golden picture, each as a function that draws it small."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from refcloud.image import Picture
from refcloud.raster import framebuffer, splat


def blend_fan() -> Picture:
    """Draw a fan of overlapping splats over a gradient, both laws, both footprints."""
    width, height = 128, 96
    buffer = framebuffer(width, height)
    down, across = np.linspace(0, 1, height), np.linspace(0, 1, width)
    buffer.pixels[..., 0] = 0.1 + 0.3 * across
    buffer.pixels[..., 1] = 0.2 + 0.2 * down[:, None]
    buffer.pixels[..., 2] = 0.6 - 0.3 * down[:, None]
    for step in range(9):
        angle = math.pi * step / 8
        colour = 0.5 + 0.5 * np.cos(angle + np.array([0.0, 2.0, 4.0]))
        splat(
            buffer,
            width / 2 - 44 * math.cos(angle),
            height - 8 - 60 * math.sin(angle),
            10 + 2.5 * step,
            emission=colour,
            tau=0.25 * 2 ** (step / 2),
            name=("chord", "profile")[step % 2],
            law=("beer", "linear")[step // 2 % 2],
        )
    return Picture(buffer.pixels[..., :3])


GOLDEN: dict[str, Callable[[], Picture]] = {
    "blend-fan": blend_fan,
}
