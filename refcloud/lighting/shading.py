"""One ball of pass 2: its footprint, its opacity and its colour at each pixel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.cloudmap.sample import clamped_trilinear
from refcloud.conventions import Array
from refcloud.lighting.erosion import eroded_of, lit_share_of
from refcloud.lighting.lightfield import LightField, field_value_of
from refcloud.lighting.look import Look
from refcloud.lighting.single_detail import SingleDetail
from refcloud.metaballs.kernels import Kernel
from refcloud.raster.blending import blend_patch
from refcloud.raster.footprint import Patch, footprint_of, opacity_of, patch_of

# A pixel shows the place half way from the ball's middle plane to its front surface.
FRONT = 0.5
CHUNK = 1 << 16  # pixels of one ball at a time: a near ball fills the picture


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
    field
        The balls' colours as a field, 3 (S + 1) values; None for flat colours.
    toward
        Steps toward the suns over which the noise's rise is taken, scene units, shape
        (S, 3).
    single
        The noise in single precision, where places are looked at in that.
    """

    frame: Array
    look: Look
    kernel: Kernel
    detail: VoxelGrid | None
    field: LightField | None
    toward: Array
    single: SingleDetail | None = None


@dataclass(frozen=True)
class Ball:
    """One ball as the camera sees it.

    Attributes
    ----------
    x, y, radius
        In the picture, pixels.
    tau
        Optical depth on its axis.
    center, R
        In the world, shape (3,) and scene units.
    colours
        RGB by sun and ambient, shape (S + 1, 3).
    clear
        Share of its light that passes the air.
    haze
        What the air adds, RGB, shape (3,).
    """

    x: float
    y: float
    radius: float
    tau: float
    center: Array
    R: float
    colours: Array
    clear: float
    haze: Array


def draw_over(pixels: Array, shading: Shading, ball: Ball) -> None:
    """Blend one ball over what lies behind it: eq 28, for balls drawn far to near.

    Parameters
    ----------
    pixels
        The framebuffer, RGBA, shape (H, W, 4), written in place.
    shading
        What all balls share.
    ball
        The ball.
    """
    height, width = pixels.shape[:2]
    patch = patch_of(ball.x, ball.y, ball.radius, width, height)
    if patch is None:
        return
    right, up = _offsets(patch, ball)
    behind = pixels[patch.rows, patch.columns]
    step = max(1, CHUNK // len(right))
    for top in range(0, len(up), step):
        some = slice(top, top + step)
        source = ball_source(patch.q[some], right, up[some, None], shading, ball)
        blend_patch(behind[some], source)


def ball_source(
    q: Array, right: Array, up: Array, shading: Shading, ball: Ball
) -> Array:
    """Give what a ball adds to pixels, colour times opacity and opacity, unchecked.

    Parameters
    ----------
    q
        Squared distance from the ball's centre in the picture, in radii squared.
    right, up
        That distance's parts in radii; they broadcast to the shape of q, (...,).
    shading
        What all balls share.
    ball
        The ball.

    Returns
    -------
    RGBA, shape (..., 4).
    """
    look, detail = shading.look, shading.detail
    weight = footprint_of(q, shading.kernel, look.footprint)
    points = noise = None
    if detail is not None or shading.field is not None:
        points = _places(q, right, up, shading, ball)

    # 1. Cut the footprint back by the noise at that place in the world.
    if detail is not None and points is not None:
        noise = noise_at(detail, points, np.zeros(3))
        weight = eroded_of(weight, noise, look.erosion)

    # 2. The light there, by sun: of the ball itself, or of the field; shaded by noise
    #    that rises toward the sun.
    light = ball.colours
    if shading.field is not None and points is not None:
        nodes = [
            (p - low) / shading.field.spacing
            for p, low in zip(points, shading.field.lower, strict=True)
        ]
        own = ball.colours.ravel()
        light = field_value_of(shading.field, nodes[0], nodes[1], nodes[2], own)
        light = light.reshape(*weight.shape, -1, 3)
    color = light[..., -1, :]
    for s, step in enumerate(shading.toward):
        sunlit = light[..., s, :]
        if noise is not None and detail is not None and points is not None:
            if look.relief > 0.0:
                ahead = noise_at(detail, points, step)
                sunlit = sunlit * lit_share_of(noise, ahead, look.relief)[..., None]
        color = color + sunlit
    color = color * ball.clear + ball.haze

    # 3. Opacity, and the colour it adds; the rest shines through.
    source = np.empty((*weight.shape, 4))
    opacity = opacity_of(weight, ball.tau, look.transmittance)
    source[..., 3] = opacity
    np.multiply(color, opacity[..., None], out=source[..., :3])
    return source


def _offsets(patch: Patch, ball: Ball) -> tuple[Array, Array]:
    """Give the columns' and rows' distances from the ball's centre, in radii."""
    rows, columns = patch.rows, patch.columns
    right = np.arange(columns.start, columns.stop) + (0.5 - ball.x)
    up = (ball.y - 0.5) - np.arange(rows.start, rows.stop)
    return right / ball.radius, up / ball.radius


def _places(
    q: Array, right: Array, up: Array, shading: Shading, ball: Ball
) -> list[Array]:
    """Give x, y and z of the places in the world that the ball's pixels show."""
    back = np.maximum(1.0 - q, 0.0)
    np.sqrt(back, out=back)
    back *= FRONT
    per_right, per_up, per_back = shading.frame * ball.R
    places = []
    for a in range(3):
        place = per_back[a] * back
        place += per_up[a] * up
        place += ball.center[a] + per_right[a] * right
        places.append(place)
    return places


def noise_at(detail: VoxelGrid, points: list[Array], step: Array) -> Array:
    """Sample the detail noise at points moved by a step, unchecked.

    Parameters
    ----------
    detail
        The table.
    points
        x, y and z of the places, scene units, each of one shape.
    step
        Added to every place, shape (3,).

    Returns
    -------
    The shape of the places.
    """
    size = cell_size(detail)
    offset = (step - detail.lower) / size - 0.5
    x, y, z = (p / s + o for p, s, o in zip(points, size, offset, strict=True))
    return clamped_trilinear(detail.density, x, y, z)
