"""A canvas: smooth-edged lines, discs and boxes, and words in Pillow's own font.

A place is (x, y) in units of a drawing that is 640 units wide, y downward; the canvas
has as many pixels as it is asked for. What covers a pixel's centre by a distance d
beyond its edge covers it by clip(1/2 - d, 0, 1), which hides the pixels' stairs.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from refcloud.conventions import Array
from refcloud.image import Picture, srgb_decode

UNITS = 640.0  # across a drawing, whatever its pixels
LEGIBLE = 0.4  # pixels to a unit: below it words would be specks, and are left out
LEAST_LETTERS = 9.0  # pixels: no word is smaller
MORE_PIXELS = 2  # pixels around a shape that its soft edge may reach

WHITE, BLACK = np.ones(3), np.zeros(3)
GREY = srgb_decode(np.full(3, 0.72))
# Inks of curves, told apart by brightness as well (after Okabe and Ito, 2008).
BLUE = srgb_decode(np.array([0.0, 0.45, 0.70]))
ORANGE = srgb_decode(np.array([0.90, 0.60, 0.0]))
GREEN = srgb_decode(np.array([0.0, 0.62, 0.45]))
RED = srgb_decode(np.array([0.84, 0.37, 0.0]))
INKS = (BLUE, RED, GREEN, ORANGE, BLACK)


@dataclass(frozen=True, eq=False)
class Canvas:
    """Light that is drawn on.

    Attributes
    ----------
    light
        Linear RGB, shape (H, W, 3); drawing changes it.
    """

    light: Array

    @property
    def scale(self) -> float:
        """Give how many pixels a unit has."""
        return self.light.shape[1] / UNITS

    @property
    def height(self) -> float:
        """Give its height in units."""
        return self.light.shape[0] / self.scale

    def picture(self, *notes: str) -> Picture:
        """Give what was drawn."""
        return Picture(self.light, notes=notes)


def blank(width: int, height: int, color: Array = WHITE) -> Canvas:
    """Make a canvas of one colour, sizes in pixels."""
    return Canvas(np.broadcast_to(color, (height, width, 3)).copy())


def _inked(
    canvas: Canvas, lower: Array, upper: Array, color: Array, share: float, away: Any
) -> None:
    """Cover pixels in a box by a shape, given its distance function in pixels."""
    H, W, _ = canvas.light.shape
    low = np.clip(np.floor(lower) - MORE_PIXELS, 0, [W, H]).astype(int)
    high = np.clip(np.ceil(upper) + MORE_PIXELS, 0, [W, H]).astype(int)
    if np.any(high <= low):
        return
    x = np.arange(low[0], high[0]) + 0.5
    y = np.arange(low[1], high[1])[:, None] + 0.5
    cover = share * np.clip(0.5 - away(x, y), 0.0, 1.0)[..., None]
    where = canvas.light[low[1] : high[1], low[0] : high[0]]
    where += cover * (color - where)


def polyline(
    canvas: Canvas,
    points: Any,
    color: Array = BLACK,
    width: float = 1.5,
    *,
    share: float = 1.0,
    dash: float = 0.0,
) -> None:
    """Draw a line through places, shape (N, 2), perhaps dashed (units)."""
    s = canvas.scale
    path = s * np.asarray(points, np.float64)
    for a, b in _dashes(path, s * dash) if dash else itertools.pairwise(path):
        way = b - a
        long = max(float(way @ way), 1e-30)

        def away(x: Array, y: Array, a: Any = a, way: Any = way, long: float = long):
            along = np.clip(((x - a[0]) * way[0] + (y - a[1]) * way[1]) / long, 0, 1)
            dx, dy = x - a[0] - along * way[0], y - a[1] - along * way[1]
            return np.sqrt(dx * dx + dy * dy) - max(0.5 * width * s, 0.5)

        reach = 0.5 * width * s
        lower, upper = np.minimum(a, b) - reach, np.maximum(a, b) + reach
        _inked(canvas, lower, upper, color, share, away)


def _dashes(path: Array, dash: float) -> list[tuple[Array, Array]]:
    """Cut a path into dashes with gaps as long."""
    lengths = np.sqrt(np.square(np.diff(path, axis=0)).sum(axis=1))
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    pieces = []
    for start in np.arange(0.0, ends[-1], 2.0 * dash):
        inner = ends[(ends > start) & (ends < start + dash)]
        at = np.concatenate([[start], inner, [min(start + dash, ends[-1])]])
        knots = np.stack([np.interp(at, ends, path[:, k]) for k in (0, 1)], axis=1)
        pieces += itertools.pairwise(knots)
    return pieces


def disc(
    canvas: Canvas,
    center: Any,
    radius: float,
    color: Array = BLACK,
    *,
    share: float = 1.0,
) -> None:
    """Fill a disc."""
    s = canvas.scale
    x0, y0 = (s * float(v) for v in center)
    r = s * radius

    def away(x: Array, y: Array) -> Array:
        return np.sqrt((x - x0) ** 2 + (y - y0) ** 2) - r

    middle = np.array([x0, y0])
    _inked(canvas, middle - r, middle + r, color, share, away)


def ring(
    canvas: Canvas,
    center: Any,
    radius: float,
    color: Array = BLACK,
    width: float = 1.5,
    *,
    share: float = 1.0,
) -> None:
    """Draw a circle's line."""
    s = canvas.scale
    x0, y0 = (s * float(v) for v in center)
    r, half = s * radius, max(0.5 * width * s, 0.5)

    def away(x: Array, y: Array) -> Array:
        return np.abs(np.sqrt((x - x0) ** 2 + (y - y0) ** 2) - r) - half

    middle = np.array([x0, y0])
    _inked(canvas, middle - r - half, middle + r + half, color, share, away)


def box(
    canvas: Canvas,
    lower: Any,
    upper: Any,
    color: Array = BLACK,
    width: float = 1.0,
    *,
    fill: Array | None = None,
    share: float = 1.0,
) -> None:
    """Outline a box from its upper left to its lower right corner, perhaps filled."""
    (x0, y0), (x1, y1) = lower, upper
    if fill is not None:
        s = canvas.scale
        a, b = s * np.array([x0, y0]), s * np.array([x1, y1])

        def away(x: Array, y: Array) -> Array:
            return np.maximum(
                np.maximum(a[0] - x, x - b[0]), np.maximum(a[1] - y, y - b[1])
            )

        _inked(canvas, a, b, fill, share, away)
    if width:
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1), (x0, y0)]
        polyline(canvas, corners, color, width)


def arrow(
    canvas: Canvas,
    start: Any,
    end: Any,
    color: Array = BLACK,
    width: float = 1.5,
    *,
    head: float = 7.0,
) -> None:
    """Draw a line with an open head at its end."""
    a, b = np.asarray(start, np.float64), np.asarray(end, np.float64)
    polyline(canvas, [a, b], color, width)
    way = (a - b) / max(float(np.hypot(*(a - b))), 1e-30)
    for turn in (0.45, -0.45):  # radians
        c, s = math.cos(turn), math.sin(turn)
        side = np.array([c * way[0] - s * way[1], s * way[0] + c * way[1]])
        polyline(canvas, [b, b + head * side], color, width)


def image(canvas: Canvas, light: Array, lower: Any, upper: Any) -> None:
    """Lay a picture into a box, each pixel of the canvas from the nearest of it."""
    s = canvas.scale
    H, W, _ = canvas.light.shape
    x0, y0 = (round(s * float(v)) for v in lower)
    x1, y1 = (round(s * float(v)) for v in upper)
    x, y = np.arange(max(x0, 0), min(x1, W)), np.arange(max(y0, 0), min(y1, H))
    h, w = light.shape[:2]
    rows = np.clip(((y - y0 + 0.5) * h / max(y1 - y0, 1)).astype(int), 0, h - 1)
    columns = np.clip(((x - x0 + 0.5) * w / max(x1 - x0, 1)).astype(int), 0, w - 1)
    canvas.light[y[:, None], x] = light[rows[:, None], columns]


def words(
    canvas: Canvas,
    place: Any,
    text: str,
    color: Array = BLACK,
    *,
    size: float = 12.0,
    anchor: str = "lm",
    halo: Array | None = None,
) -> None:
    """Write a line at a place; the anchor is Pillow's: "lm" puts its left middle there.

    A halo keeps it apart from lines that it crosses. On a canvas so small that words
    would be specks none is written.
    """
    s = canvas.scale
    if s < LEGIBLE:
        return
    font: Any = ImageFont.load_default(max(size * s, LEAST_LETTERS))
    H, W, _ = canvas.light.shape
    place = s * float(place[0]), s * float(place[1])
    inks = [(color, 0)] if halo is None else [(halo, round(2.0 * s) + 1), (color, 0)]
    for ink, stroke in inks:
        mask = Image.new("L", (W, H))
        ImageDraw.Draw(mask).text(
            place, text, fill=255, font=font, anchor=anchor, stroke_width=stroke
        )
        cover = np.asarray(mask, np.float64)[..., None] / 255.0
        canvas.light[...] += cover * (ink - canvas.light)
