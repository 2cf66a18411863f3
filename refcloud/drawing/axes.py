"""Axes: a frame with ticks, and curves in the units of what is plotted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from refcloud.conventions import Array
from refcloud.drawing.canvas import BLACK, GREY, Canvas, box, polyline, words

TICK = 4.0  # units


@dataclass(frozen=True)
class Axes:
    """A frame on a canvas, and the numbers at its sides.

    Attributes
    ----------
    canvas
        What it is drawn on.
    left, top, right, bottom
        The frame, units of the canvas.
    x, y
        Numbers at left and right, and at bottom and top.
    """

    canvas: Canvas
    left: float
    top: float
    right: float
    bottom: float
    x: tuple[float, float]
    y: tuple[float, float]

    def place(self, x: Any, y: Any) -> Array:
        """Give the places of numbers, shape (N, 2)."""
        across = (np.asarray(x, np.float64) - self.x[0]) / (self.x[1] - self.x[0])
        up = (np.asarray(y, np.float64) - self.y[0]) / (self.y[1] - self.y[0])
        across, up = np.broadcast_arrays(across, up)
        left = self.left + across * (self.right - self.left)
        return np.stack([left, self.bottom + up * (self.top - self.bottom)], axis=-1)


def axes_in(
    canvas: Canvas,
    cell: tuple[float, float, float, float],
    x: tuple[float, float],
    y: tuple[float, float],
    *,
    ticks_x: Any = (),
    ticks_y: Any = (),
    title: str = "",
    below: str = "",
) -> Axes:
    """Draw a frame into a cell (left, top, right, bottom), with ticks and words."""
    left, top, right, bottom = cell
    frame = Axes(canvas, left + 38.0, top + 24.0, right - 12.0, bottom - 32.0, x, y)
    for value in ticks_x:
        (at,) = frame.place([value], [y[0]])
        polyline(canvas, [(at[0], frame.top), at], GREY, 0.6)
        words(canvas, (at[0], frame.bottom + TICK), f"{value:g}", size=10, anchor="mt")
    for value in ticks_y:
        (at,) = frame.place([x[0]], [value])
        polyline(canvas, [at, (frame.right, at[1])], GREY, 0.6)
        words(canvas, (frame.left - TICK, at[1]), f"{value:g}", size=10, anchor="rm")
    box(canvas, (frame.left, frame.top), (frame.right, frame.bottom), BLACK, 1.0)
    middle = 0.5 * (frame.left + frame.right)
    words(canvas, (middle, top + 13.0), title, size=13, anchor="mm")
    words(canvas, (middle, bottom - 7.0), below, size=10, anchor="mm")
    return frame


def curve(
    axes: Axes,
    x: Any,
    y: Any,
    color: Array = BLACK,
    width: float = 1.6,
    *,
    dash: float = 0.0,
) -> None:
    """Draw a curve through numbers; it is cut off at the frame's top and bottom."""
    low, high = min(axes.y), max(axes.y)
    inside = np.clip(np.asarray(y, np.float64), low, high)
    polyline(axes.canvas, axes.place(x, inside), color, width, dash=dash)


def grid_of(
    canvas: Canvas, columns: int, rows: int
) -> list[tuple[float, float, float, float]]:
    """Cut a canvas into cells (left, top, right, bottom), row after row."""
    width, height = 640.0 / columns, canvas.height / rows
    return [
        (i * width, j * height, (i + 1) * width, (j + 1) * height)
        for j in range(rows)
        for i in range(columns)
    ]
