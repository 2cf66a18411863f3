"""Linear light to 8-bit codes: exposure, tone curve, sRGB, dither, rounding.

A picture holds light as numbers that add; a file holds codes spaced as the eye sees
them. Clamping happens here and nowhere before.
"""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.conventions import Array, Range, Shape

Codes = NDArray[np.uint8]
Tone = Literal["shoulder", "none"]
Exposure = Annotated[float, Range(0.0, 1e6, "1", open_lower=True)]
Unit = Annotated[Array, Shape("..."), Range(0.0, 1.0)]

WHITE = 255  # the largest code
# Where the straight piece and the power of sRGB meet. The standard's own rounded
# 0.0031308 leaves a step of -3e-8 there, so that the curve would not be monotone.
SRGB_JOIN = 0.0031306684425005883
SRGB_SLOPE = 12.92
SRGB_OFFSET = 0.055
SRGB_POWER = 2.4
KNEE = 0.7  # the tone curve leaves the straight line here
SHOULDER = 1.0 - KNEE  # what is left for all that is brighter
BRIGHTEST = 1e300  # light is cut here before exposure, so that no product overflows


def _bayer(doublings: int) -> Array:
    """Give the ordered thresholds: each once, neighbours far apart in value."""
    ranks = np.zeros((1, 1))
    for _ in range(doublings):
        ranks = np.block([[4 * ranks, 4 * ranks + 2], [4 * ranks + 3, 4 * ranks + 1]])
    return (ranks + 0.5) / ranks.size


THRESHOLDS = _bayer(3)  # 8 x 8: steps of 1/64 of a code are finer than the eye sees


@checked
def srgb_encode(linear: Unit) -> Array:
    """Turn linear light into sRGB values.

    Formula: 12.92 x below the join, else 1.055 x^(1/2.4) - 0.055

    Parameters
    ----------
    linear
        Light, 1 is displayed white, any shape, in [0, 1].

    Returns
    -------
    Encoded values in [0, 1], same shape.

    Source: IEC 61966-2-1.

    Examples
    --------
    >>> srgb_encode([0.0, 0.5, 1.0]).round(3)
    array([0.   , 0.735, 1.   ])
    """
    return _encode(linear)


def _encode(linear: Array) -> Array:
    # 1 - 1.055 (1 - p) is 1.055 p - 0.055, and exactly 1 at white.
    power = 1.0 - (1.0 + SRGB_OFFSET) * (1.0 - linear ** (1.0 / SRGB_POWER))
    return np.where(linear < SRGB_JOIN, SRGB_SLOPE * linear, power)


@checked
def srgb_decode(encoded: Unit) -> Array:
    """Turn sRGB values into linear light.

    Formula: x / 12.92 below the join, else ((x + 0.055) / 1.055)^2.4

    Parameters
    ----------
    encoded
        Encoded values, any shape, in [0, 1]; a code divided by 255.

    Returns
    -------
    Linear light in [0, 1], same shape.

    Source: IEC 61966-2-1.

    Examples
    --------
    >>> srgb_decode([0.0, 0.5, 1.0]).round(3)
    array([0.   , 0.214, 1.   ])
    """
    power = ((encoded + SRGB_OFFSET) / (1.0 + SRGB_OFFSET)) ** SRGB_POWER
    return np.where(encoded < SRGB_SLOPE * SRGB_JOIN, encoded / SRGB_SLOPE, power)


@checked
def tone_shoulder(linear: Annotated[Array, Shape("..."), Range(0.0)]) -> Array:
    """Bend what is brighter than the knee below white, so that tops keep their form.

    Formula: x up to 0.7, then 0.7 + 0.3 (1 - exp(-(x - 0.7) / 0.3))

    Parameters
    ----------
    linear
        Light, 1 is displayed white, any shape, at least 0.

    Returns
    -------
    Light in [0, 1], same shape; value and slope are continuous at the knee.

    Source: evidence of the project's look (shoulder above 0.7).

    Examples
    --------
    >>> tone_shoulder([0.5, 1.0, 9.0]).round(3)
    array([0.5 , 0.89, 1.  ])
    """
    return _shoulder(linear)


def _shoulder(linear: Array) -> Array:
    above = np.maximum(linear - KNEE, 0.0)
    return np.where(
        linear > KNEE, KNEE - SHOULDER * np.expm1(-above / SHOULDER), linear
    )


@checked
def quantize(
    encoded: Annotated[Array, Shape("H", "W", 3), Range(0.0, 1.0)],
    *,
    dither: bool = True,
) -> Codes:
    """Round encoded values to codes, plainly or with an ordered dither.

    Formula: floor(255 x + 1/2), or floor(255 x + t) with t from the 8 x 8 Bayer square

    Parameters
    ----------
    encoded
        sRGB values, shape (H, W, 3), in [0, 1].
    dither
        Whether the threshold changes from pixel to pixel, which hides bands in a sky.

    Returns
    -------
    Codes 0 to 255, shape (H, W, 3), uint8.

    Source: Bayer's ordered dither.

    Examples
    --------
    >>> quantize([[[0.0, 0.5, 1.0]]], dither=False)
    array([[[  0, 128, 255]]], dtype=uint8)
    """
    return _quantize(encoded, dither)


def _quantize(encoded: Array, dither: bool) -> Codes:
    height, width = encoded.shape[:2]
    threshold: float | Array = 0.5
    if dither:
        size = len(THRESHOLDS)
        rows, columns = np.arange(height) % size, np.arange(width) % size
        threshold = THRESHOLDS[rows[:, None], columns][..., None]
    return np.floor(encoded * WHITE + threshold).astype(np.uint8)


@checked
def to_codes(
    linear: Annotated[Array, Shape("H", "W", 3)],
    *,
    exposure: Exposure = 1.0,
    tone: Tone = "shoulder",
    dither: bool = True,
) -> Codes:
    """Turn linear light into the codes of a file.

    Formula: quantize(srgb_encode(tone(exposure x)))

    Parameters
    ----------
    linear
        Light, 1 is displayed white, shape (H, W, 3); below 0 counts as 0.
    exposure
        Factor on the light.
    tone
        Curve before the cut at white: "shoulder", or "none" for a plain cut.
    dither
        Whether an ordered dither hides bands.

    Returns
    -------
    Codes 0 to 255, shape (H, W, 3), uint8.

    Source: IEC 61966-2-1; E34 (colours below 0).

    Examples
    --------
    >>> to_codes([[[-1.0, 0.5, 9.0]]], tone="none", dither=False)
    array([[[  0, 188, 255]]], dtype=uint8)
    """
    bright = np.clip(linear, 0.0, BRIGHTEST) * exposure
    bent = _shoulder(bright) if tone == "shoulder" else bright
    return _quantize(_encode(np.minimum(bent, 1.0)), dither)
