"""Skies as gradients: the printed one, a mended one, and one that looks like a sky."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from refcloud.camera import AnyCamera, Side, rays, refuse_large
from refcloud.checking import check_fields, checked
from refcloud.conventions import Array, Colour, Positive, Range
from refcloud.optics import Sun
from refcloud.optics.phase import henyey_greenstein


@dataclass(frozen=True)
class Sky:
    """A clear sky.

    Attributes
    ----------
    zenith, horizon
        Radiance straight up and low over the horizon, RGB.
    haze
        Radiance at the horizon and below it, RGB.
    bend
        Power of the sine of elevation that leads from horizon to zenith.
    haze_height
        Sine of elevation over which the haze falls to 1/e.
    glow
        Share of each sun's light that the air scatters; 0 is off.
    glow_g
        How narrow it is: mean cosine of its Henyey-Greenstein lobe.
    """

    zenith: Colour = field(default_factory=lambda: np.array([0.018, 0.085, 0.32]))
    horizon: Colour = field(default_factory=lambda: np.array([0.22, 0.41, 0.72]))
    haze: Colour = field(default_factory=lambda: np.array([0.58, 0.70, 0.83]))
    bend: Annotated[float, Positive] = 0.62
    haze_height: Annotated[float, Positive] = 0.075
    glow: Annotated[float, Range(0.0)] = 0.0
    glow_g: Annotated[float, Range(0.0, 1.0, open_upper=True)] = 0.9

    def __post_init__(self) -> None:
        check_fields(self)


@checked
def clear_sky(
    camera: AnyCamera, sky: Sky | None = None, *, suns: tuple[Sun, ...] = ()
) -> Array:
    """Paint a clear sky as the camera sees it.

    Formula: t = y^bend, mix(horizon, zenith, t), then mixed to haze by
    exp(-y / haze_height), with y the sine of elevation, at least 0; each sun adds
    glow HG(angle to it, glow_g) times its irradiance

    Parameters
    ----------
    camera
        Whose rays are painted.
    sky
        The colours; None for the default ones.
    suns
        Those that glow.

    Returns
    -------
    Linear RGB, shape (H, W, 3).

    Source: document D (F13), extended.

    Examples
    --------
    >>> from refcloud.camera import Camera
    >>> clear_sky(Camera([0, 0, 0], [0, 0, -1], width=2, height=2)).shape
    (2, 2, 3)
    """
    sky = sky or Sky()
    _, directions = rays(camera)
    y = np.maximum(directions[..., 1], 0.0)
    t = (y**sky.bend)[..., None]
    color = sky.horizon * (1.0 - t) + sky.zenith * t
    low = np.exp(-y / sky.haze_height)[..., None]
    color = color * (1.0 - low) + sky.haze * low
    for sun in suns if sky.glow > 0.0 else ():
        if not sun.irradiance.any():
            continue
        toward = np.clip(directions @ sun.direction, -1.0, 1.0)
        lobe = henyey_greenstein(toward, sky.glow_g)
        color += sky.glow * lobe[..., None] * sun.irradiance
    return color


@checked
def sky_gradient(top: Colour, bottom: Colour, *, width: Side, height: Side) -> Array:
    """Paint a gradient from the top row to the bottom row.

    Formula: top + (bottom - top) (j + 1/2) / H in row j

    Parameters
    ----------
    top, bottom
        Linear RGB, shape (3,).
    width, height
        Size of the picture, pixels.

    Returns
    -------
    Linear RGB, shape (H, W, 3).

    Raises
    ------
    ValueError
        The picture is over 8.3 megapixels.

    Source: document D (F13), mended; E34.

    Examples
    --------
    >>> sky_gradient([1, 1, 1], [0, 0, 0], width=1, height=2)[:, 0, 0]
    array([0.75, 0.25])
    """
    refuse_large(width, height)
    t = ((np.arange(height) + 0.5) / height)[:, None, None]
    return np.broadcast_to(top + (bottom - top) * t, (height, width, 3)).copy()


@checked
def printed_gradient(*, width: Side, height: Side) -> Array:
    """Paint the gradient sky of document D as printed, clamped: near black.

    Formula: max((0.39, 0.30, 0.65) - scale(y, -1, 1, 0.4, 0.6), 0), y from -1 at the
    bottom to 1 at the top

    Parameters
    ----------
    width, height
        Size of the picture, pixels.

    Returns
    -------
    Linear RGB, shape (H, W, 3): red and green are 0 everywhere.

    Raises
    ------
    ValueError
        The picture is over 8.3 megapixels.

    Source: document D (F13); E34.

    Examples
    --------
    >>> printed_gradient(width=1, height=1)[0, 0].round(2)
    array([0.  , 0.  , 0.15])
    """
    refuse_large(width, height)
    y = 1.0 - 2.0 * (np.arange(height) + 0.5) / height
    blue = 0.4 + (y + 1.0) / 2.0 * (0.6 - 0.4)
    color = np.maximum(np.array([0.39, 0.30, 0.65]) - blue[:, None], 0.0)
    return np.repeat(color[:, None, :], width, axis=1)
