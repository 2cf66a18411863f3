"""One ball of pass 2: its footprint, its opacity and its colour at each pixel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.cloudmap.sample import clamped_trilinear
from refcloud.conventions import Array
from refcloud.lighting.erosion import eroded_of
from refcloud.lighting.look import Look
from refcloud.raster.blending import blend_patch
from refcloud.raster.footprint import footprint_of, opacity_of, patch_of

# The colour of a pixel is that of the ball half way to its front surface.
FRONT = 0.5


@dataclass(frozen=True)
class Shading:
    """What all balls of one picture share.

    Attributes
    ----------
    frame
        The camera's right, up and back, shape (3, 3).
    look
        The rules.
    kernel
        The balls' density.
    detail
        Noise that erodes footprints; None for none.
    """

    frame: Array
    look: Look
    kernel: str
    detail: VoxelGrid | None


def draw_ball(
    pixels: Array,
    shading: Shading,
    place: tuple[float, float, float],
    tau: float,
    center: Array,
    R: float,
    color: Array,
    change: Array,
) -> None:
    """Blend one ball into the framebuffer, unchecked.

    Parameters
    ----------
    pixels
        The framebuffer, RGBA, shape (H, W, 4), written in place.
    shading
        What all balls share.
    place
        x, y and radius, pixels.
    tau
        Optical depth on the ball's axis.
    center, R
        In the world, shape (3,) and scene units.
    color
        RGB at the centre, shape (3,).
    change
        Of the color, per radius along right, up and back, shape (3, 3).
    """
    x, y, radius = place
    height, width = pixels.shape[:2]
    patch = patch_of(x, y, radius, width, height)
    if patch is None:
        return
    look = shading.look
    weight = footprint_of(patch.q, shading.kernel, look.footprint)

    # 1. Offsets from the centre in radii: to the right, upward, toward the eye.
    rows, columns = patch.rows, patch.columns
    right = (np.arange(columns.start, columns.stop) + (0.5 - x)) / radius
    up = (y - 0.5 - np.arange(rows.start, rows.stop))[:, None] / radius
    varies = bool(change.any())
    front = None
    if varies or shading.detail is not None:
        front = np.maximum(1.0 - patch.q, 0.0)
        np.sqrt(front, out=front)
        front *= FRONT

    # 2. Cut the footprint back by the noise at that place in the world.
    if shading.detail is not None and front is not None:
        noise = _noise_at(shading, shading.detail, center, R, right, up, front)
        weight = eroded_of(weight, noise, look.erosion)

    # 3. Opacity, and the colour it adds; the rest shines through.
    source = np.empty((*weight.shape, 4))
    opacity = opacity_of(weight, tau, look.transmittance)
    source[..., 3] = opacity
    for channel in range(3):
        if varies and front is not None:
            by_right, by_up, by_back = change[:, channel]
            shade = front * by_back
            shade += color[channel] + by_right * right
            shade += by_up * up
            np.multiply(shade, opacity, out=source[..., channel])
        else:
            np.multiply(opacity, color[channel], out=source[..., channel])
    blend_patch(pixels[rows, columns], source)


def _noise_at(
    shading: Shading,
    detail: VoxelGrid,
    center: Array,
    R: float,
    right: Array,
    up: Array,
    front: Array,
) -> Array:
    """Sample the detail noise at the pixels' places on the ball."""
    size = cell_size(detail)
    start = (center - detail.lower) / size - 0.5
    per_right, per_up, per_back = shading.frame * (R / size)
    x, y, z = (
        (start[a] + per_right[a] * right) + per_up[a] * up + per_back[a] * front
        for a in range(3)
    )
    return clamped_trilinear(detail.density, x, y, z)
