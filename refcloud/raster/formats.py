"""What a framebuffer's format keeps of a number: OpenGL's storage rules, one by one.

Whatever the format, the pixels are an array of float64; a format is the rule that
rounds to the numbers that it can hold. ``RGBA64F`` is the one name that OpenGL does not
have: float64 as it is. SRGB8_ALPHA8 holds encoded values, as glReadPixels gives them.
"""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Shape
from refcloud.image import srgb_encode

Format = Literal["RGBA64F", "RGBA32F", "RGBA16F", "RGBA8", "SRGB8_ALPHA8"]
Arithmetic = Literal["ideal", "llvmpipe"]

FIXED_POINT = ("RGBA8", "SRGB8_ALPHA8")
WHITE = 255.0  # the largest code of 8 bits
LARGEST_32 = float(np.finfo(np.float32).max)
LARGEST_16 = float(np.finfo(np.float16).max)


@checked
def stored(
    values: Annotated[Array, Shape("...", 4)],
    format: Format,
    *,
    arithmetic: Arithmetic = "ideal",
) -> Array:
    """Give what a framebuffer of a format keeps of colours that are written to it.

    Formula: RGBA32F and RGBA16F the nearest number (ties to even), RGBA8
    rint(255 clip(c, 0, 1)) / 255, SRGB8_ALPHA8 the same of srgb_encode(c), alpha linear

    Parameters
    ----------
    values
        Linear RGBA, shape (..., 4); only floating-point formats hold what lies outside
        [0, 1].
    format
        OpenGL's name, or RGBA64F, which keeps all.
    arithmetic
        "ideal" rounds as the specification would have it. "llvmpipe" does what Mesa's
        software driver does: RGBA16F is rounded toward zero, and the curve of
        SRGB8_ALPHA8 is an approximation.

    Returns
    -------
    The same shape. No float grows beyond the format's largest: none becomes infinite.

    Source: OpenGL 4.6, sections 2.3.4, 2.3.5 and 17.3.7; F02.

    Examples
    --------
    >>> stored([[0.1, 0.5, 2.0, -1.0]], "RGBA8") * 255
    array([[ 26., 128., 255.,   0.]])
    """
    if format == "RGBA64F":
        return values
    if format == "RGBA32F":
        return nearest_float32(values)
    if format == "RGBA16F":
        ideal = arithmetic == "ideal"
        return nearest_float16(values) if ideal else float16_toward_zero(values)
    if format == "SRGB8_ALPHA8":
        clamped = np.clip(values, 0.0, 1.0)
        ideal = arithmetic == "ideal"
        encode = srgb_encode if ideal else srgb_encode_llvmpipe
        clamped[..., :3] = encode(clamped[..., :3])
        return stored(clamped, "RGBA8", arithmetic=arithmetic)
    if arithmetic == "llvmpipe" and format == "RGBA8":
        return code_llvmpipe(values) / WHITE
    return nearest_code(values)


def nearest_float32(values: Array) -> Array:
    """Round to the nearest float32, ties to even, and to the largest at most."""
    rounded = np.clip(values, -LARGEST_32, LARGEST_32).astype(np.float32)
    return rounded.astype(np.float64)


def nearest_float16(values: Array) -> Array:
    """Round to the nearest float16, ties to even, and to the largest at most."""
    rounded = np.clip(values, -LARGEST_16, LARGEST_16).astype(np.float16)
    return rounded.astype(np.float64)


def float16_toward_zero(values: Array) -> Array:
    """Cut to float16: the nearest number that is not farther from 0."""
    nearest = np.clip(values, -LARGEST_16, LARGEST_16).astype(np.float16)
    beyond = np.abs(nearest) > np.abs(values)
    cut = np.where(beyond, np.nextafter(nearest, np.float16(0)), nearest)
    return cut.astype(np.float64)


def nearest_code(values: Array) -> Array:
    """Clamp to [0, 1] and round to the nearest of 256 codes, ties to even."""
    return np.rint(np.clip(values, 0.0, 1.0) * WHITE) / WHITE


def code_llvmpipe(values: Array) -> Array:
    """Clamp to [0, 1] and round to one of 0 to 255, where float32 counts as a tie."""
    x = np.clip(values, 0.0, 1.0).astype(np.float32)
    return np.rint(x * np.float32(WHITE)).astype(np.float64)


def srgb_decode_llvmpipe(encoded: Array) -> Array:
    """Turn 8-bit sRGB values into linear light by llvmpipe's polynomial, in float32.

    The error is up to 1.2e-3 of white; half a code there is 4e-3.
    """
    v = encoded.astype(np.float32)
    cubic = v * np.float32(0.3012) + np.float32(0.6935)
    cubic = (cubic * v + np.float32(0.0030)) * v + np.float32(0.0023)
    return np.where(v * np.float32(WHITE) <= 15.5, v / np.float32(12.6), cubic)


def srgb_encode_llvmpipe(linear: Array) -> Array:
    """Turn linear light in [0, 1] into sRGB values by llvmpipe's roots, in float32.

    The error is up to a quarter of a code: x^(1/2.4) is made of x^(3/8) and x^(1/2).
    """
    x = linear.astype(np.float32)
    root = np.sqrt(x)
    power = np.float32(0.675 * 1.0622) * np.sqrt(root * np.sqrt(root))
    power += np.float32(0.325 * 1.0622) * root
    low = x <= np.float32(0.0031308)
    return np.where(low, x * np.float32(12.6), power - np.float32(0.062))
