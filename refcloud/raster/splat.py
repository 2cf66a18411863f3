"""A splat writes one ball into the framebuffer; a readback reads what lies behind it.

``splat_source`` and ``mean_of`` are the unchecked inner forms, for loops over thousands
of balls; `splat` and `read_mean` check and call them.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Colour
from refcloud.raster.blending import blended_as
from refcloud.raster.factors import OVER
from refcloud.raster.footprint import (
    Depth,
    Kernel,
    Law,
    Name,
    Patch,
    Place,
    Radius,
    footprint_of,
    opacity_of,
    patch_of,
)
from refcloud.raster.framebuffer import CHANNELS, Framebuffer

Area = Literal["disc", "square", "footprint", "antialiased"]
SOFT_EDGE = 0.5  # pixels to either side of the rim over which "antialiased" falls to 0
# Below this depth (1 - exp(-tau w)) / (1 - exp(-tau)) is w to the last bit of float64.
THIN = 1e-16


@checked
def splat(
    buffer: Framebuffer,
    x: Place,
    y: Place,
    radius: Radius,
    *,
    emission: Colour,
    tau: Depth,
    kernel: Kernel = "wyvill",
    name: Name = "chord",
    law: Law = "beer",
) -> None:
    """Blend one ball over the framebuffer.

    Formula: c = emission (1 - T(w)) / (1 - T(1)) + T(w) c (ONE, ONE_MINUS_SRC_ALPHA)

    Parameters
    ----------
    buffer
        The framebuffer, written in place.
    x, y
        The ball's centre in pixels, from the left and from the top edge.
    radius
        Its radius in pixels.
    emission
        Light that the ball adds at its centre, RGB, shape (3,).
    tau
        Optical depth along the ball's axis; 0 adds light and covers nothing.
    kernel
        The ball's density: "wyvill" or "gaussian".
    name
        Its footprint: "chord" or the paper's "profile".
    law
        Transmittance off the axis: "beer" or the paper's "linear".

    Returns
    -------
    Nothing.

    Source: paper M, eq 27, 28 and 29; L08, L09, E25.

    Examples
    --------
    >>> from refcloud.raster import framebuffer
    >>> buffer = framebuffer(1, 1, color=[1, 1, 1, 0])
    >>> splat(buffer, 0.5, 0.5, 1, emission=[0.5, 0, 0], tau=np.log(2))
    >>> buffer.pixels[0, 0]
    array([1. , 0.5, 0.5, 0.5])
    """
    height, width, _ = buffer.pixels.shape
    patch = patch_of(x, y, radius, width, height)
    if patch is None:
        return
    weight = footprint_of(patch.q, kernel, name)
    pixels = buffer.pixels[patch.rows, patch.columns]
    source = splat_source(weight, emission, tau, law)
    pixels[:] = blended_as(source, pixels, OVER, buffer.format, buffer.arithmetic)


def splat_source(
    weight: Array, emission: Array, tau: float, law: Law = "beer"
) -> Array:
    """Give what one ball adds to pixels, unchecked: light, and opacity.

    Parameters
    ----------
    weight
        Its footprint, shape (h, w).
    emission, tau, law
        As `splat`.

    Returns
    -------
    RGBA, shape (h, w, 4), colour multiplied by opacity.
    """
    opacity = opacity_of(weight, tau, law)
    glow = opacity / -math.expm1(-tau) if tau > THIN else weight
    source = np.empty((CHANNELS, *weight.shape))  # as the framebuffer, by channel
    np.multiply(emission[:, None, None], glow, out=source[:3])
    source[3] = opacity
    return source.transpose(1, 2, 0)


@checked
def read_mean(
    buffer: Framebuffer,
    x: Place,
    y: Place,
    radius: Radius,
    *,
    area: Area = "disc",
    kernel: Kernel = "wyvill",
    footprint: Name = "chord",
) -> Array | None:
    """Average the framebuffer over the projection of a ball.

    Formula: sum(w c) / sum(w) over the pixels that were really read

    Parameters
    ----------
    buffer
        The framebuffer.
    x, y
        The ball's centre in pixels, from the left and from the top edge.
    radius
        Its radius in pixels.
    area
        "disc": pixels whose centres lie in it; "square": those of its bounding square;
        "footprint": those of the disc, weighted as the ball is drawn; "antialiased":
        those around the disc, weighted by clip(radius - distance + 1/2, 0, 1), about
        the share of the pixel that it covers.
    kernel
        The ball's density, for the area "footprint".
    footprint
        "chord" or "profile", for the area "footprint".

    Returns
    -------
    Mean RGBA, shape (4,). An area too small to hold a pixel's centre reads the nearest
    pixel; None where the area lies wholly outside the buffer.

    Source: paper M, section 4.1, second step; F03, L07, E27.

    Examples
    --------
    >>> from refcloud.raster import framebuffer
    >>> buffer = framebuffer(4, 4, color=[1, 1, 1, 1])
    >>> read_mean(buffer, 0, 0, 3), read_mean(buffer, -9, 0, 3)
    (array([1., 1., 1., 1.]), None)
    """
    patch = patch_of(x, y, radius, buffer.pixels.shape[1], buffer.pixels.shape[0])
    weight = None
    if patch is not None and area == "footprint":
        weight = footprint_of(patch.q, kernel, footprint)
    return mean_of(buffer.pixels, x, y, radius, patch, area, weight)


def mean_of(
    pixels: Array,
    x: float,
    y: float,
    radius: float,
    patch: Patch | None,
    area: Area = "disc",
    weight: Array | None = None,
) -> Array | None:
    """Average over a ball's projection without a check: the inner form of `read_mean`.

    Parameters
    ----------
    pixels
        Those of the framebuffer, shape (H, W, 4).
    x, y, radius
        The ball, as `read_mean`.
    patch, weight
        From `patch_of` and `footprint_of`; only the area "footprint" needs a weight.
        The area "antialiased" makes its own.
    area
        As `read_mean`.

    Returns
    -------
    As `read_mean`.
    """
    wide = radius + SOFT_EDGE
    if area == "antialiased":
        # Pixels just outside the ball's square count too.
        patch = patch_of(x, y, wide, pixels.shape[1], pixels.shape[0])
    if patch is not None:
        if area == "antialiased":
            weight = np.clip(wide - np.sqrt(patch.q) * wide, 0.0, 1.0)
        elif area == "disc":
            weight = np.less_equal(patch.q, 1.0).astype(np.float64)
        elif area == "square":
            weight = np.ones_like(patch.q)
        assert weight is not None, "the area footprint comes with its weight"
        total = float(weight.sum())
        if total > 0.0:
            read = pixels[patch.rows, patch.columns]
            return np.einsum("ij,ijk->k", weight, read) / total
    return _nearest(pixels, x, y, radius, area)


def _nearest(
    pixels: Array, x: float, y: float, radius: float, area: Area
) -> Array | None:
    """Give the pixel nearest to an area that holds no pixel's centre, or None."""
    height, width, _ = pixels.shape
    inside_x, inside_y = min(max(x, 0.0), width), min(max(y, 0.0), height)
    gap_x, gap_y = abs(x - inside_x) / radius, abs(y - inside_y) / radius
    gap = max(gap_x, gap_y) if area == "square" else math.hypot(gap_x, gap_y)
    if gap >= 1.0:
        return None
    return pixels[min(int(inside_y), height - 1), min(int(inside_x), width - 1)].copy()
