"""Codes and differences, one channel of one pixel at a time."""

from __future__ import annotations

import math
from collections.abc import Sequence

SRGB_JOIN = 0.0031306684425005883  # where the two pieces of the curve meet
# The 8 x 8 ordered dither, written out: the order in which pixels of a square light up.
BAYER = (
    (0, 32, 8, 40, 2, 34, 10, 42),
    (48, 16, 56, 24, 50, 18, 58, 26),
    (12, 44, 4, 36, 14, 46, 6, 38),
    (60, 28, 52, 20, 62, 30, 54, 22),
    (3, 35, 11, 43, 1, 33, 9, 41),
    (51, 19, 59, 27, 49, 17, 57, 25),
    (15, 47, 7, 39, 13, 45, 5, 37),
    (63, 31, 55, 23, 61, 29, 53, 21),
)


def srgb_encode(linear: float) -> float:
    """Encode one value; twin of `refcloud.image.srgb_encode`."""
    if linear < SRGB_JOIN:
        return 12.92 * linear
    return min(1.055 * linear ** (1.0 / 2.4) - 0.055, 1.0)


def srgb_decode(encoded: float) -> float:
    """Decode one value; twin of `refcloud.image.srgb_decode`."""
    if encoded < 12.92 * SRGB_JOIN:
        return encoded / 12.92
    return ((encoded + 0.055) / 1.055) ** 2.4


def tone_shoulder(linear: float) -> float:
    """Bend one value; twin of `refcloud.image.tone_shoulder`."""
    if linear <= 0.7:
        return linear
    return 0.7 + 0.3 * (1.0 - math.exp(-(linear - 0.7) / 0.3))


def quantize(encoded: float, row: int, column: int, dither: bool = True) -> int:
    """Round one value at its place; twin of `refcloud.image.quantize`."""
    threshold = (BAYER[row % 8][column % 8] + 0.5) / 64 if dither else 0.5
    return math.floor(255 * encoded + threshold)


def to_codes(
    linear: float,
    row: int,
    column: int,
    exposure: float = 1.0,
    tone: str = "shoulder",
    dither: bool = True,
) -> int:
    """Give the code of one value at its place; twin of `refcloud.image.to_codes`."""
    light = max(linear, 0.0) * exposure
    if tone == "shoulder":
        light = tone_shoulder(light)
    return quantize(srgb_encode(min(light, 1.0)), row, column, dither)


def difference_picture(a: float, b: float, gain: float = 10.0) -> float:
    """Show one difference; twin of `refcloud.image.difference_picture`."""
    return gain * abs(a - b)


def root_mean_square(a: Sequence[float], b: Sequence[float]) -> float:
    """Average squared differences; twin of `refcloud.image.root_mean_square`."""
    total = 0.0
    for u, v in zip(a, b, strict=True):
        total += (u - v) ** 2
    return math.sqrt(total / len(a))


def largest_difference(a: Sequence[float], b: Sequence[float]) -> float:
    """Find the largest difference; twin of `refcloud.image.largest_difference`."""
    largest = 0.0
    for u, v in zip(a, b, strict=True):
        largest = max(largest, abs(u - v))
    return largest


def compare_codes(
    a: Sequence[Sequence[int]],
    b: Sequence[Sequence[int]],
    codes: int = 1,
    fraction: float = 0.001,
) -> tuple[bool, int, float]:
    """Compare two lists of pixels; twin of `refcloud.image.compare_codes`.

    Returns the verdict, the worst difference and the share of pixels off at all.
    """
    worst, off = 0, 0
    for u, v in zip(a, b, strict=True):
        difference = max(abs(p - q) for p, q in zip(u, v, strict=True))
        worst = max(worst, difference)
        off += difference > 0
    share = off / len(a)
    return worst <= codes and share <= fraction, worst, share
