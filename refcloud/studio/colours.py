"""Values, ranks and small buffers as codes that a page can show."""

from __future__ import annotations

from typing import Any

import numpy as np

from refcloud.conventions import Array
from refcloud.studio.counts import discs

# False colours from little to much, dark to light, so that greys alone order them too.
RAMP = np.array(
    [[0, 0, 20], [60, 15, 110], [170, 40, 110], [240, 110, 40], [255, 235, 140]], float
)
SIDE = 640  # pixels of the light's views: its buffer is enlarged


def heat(values: Array) -> Any:
    """Give false colours of values in [0, 1], codes of shape (..., 3)."""
    at = np.clip(values, 0.0, 1.0) * (len(RAMP) - 1)
    low = np.minimum(at.astype(int), len(RAMP) - 2)
    part = (at - low)[..., None]
    return (RAMP[low] * (1.0 - part) + RAMP[low + 1] * part + 0.5).astype(np.uint8)


def ranked(
    x: Array, y: Array, radius: Array, order: Any, width: int, height: int
) -> Any:
    """Paint discs from far to near, coloured by their place in the order."""
    codes = np.full((height, width, 3), 235, np.uint8)
    behind = order[::-1]
    colours = heat(np.linspace(1.0, 0.1, max(len(behind), 1)))
    for k, index in enumerate(behind.tolist()):
        some = slice(index, index + 1)
        for window, inside in discs(x[some], y[some], radius[some], width, height):
            codes[window][inside] = colours[k]
    return codes


def greys(values: Array) -> Any:
    """Give codes of values in [0, 1]."""
    return (values * 255.0 + 0.5).astype(np.uint8)


def enlarged(codes: Any, side: int = SIDE) -> Any:
    """Repeat pixels until the longer side is about so long, so that each is seen."""
    times = max(side // max(codes.shape[:2]), 1)
    large = codes.repeat(times, axis=0).repeat(times, axis=1)
    if side == SIDE and large.shape[0] != SIDE and large.shape[0] == large.shape[1]:
        index = np.arange(SIDE) * codes.shape[0] // SIDE
        return codes[index][:, index]
    return large
