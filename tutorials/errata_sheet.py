"""What the figures of the errata share: panels of pictures, plots, and their codes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from refcloud.conventions import Array
from refcloud.drawing import (
    GREY,
    Axes,
    Canvas,
    axes_in,
    blank,
    box,
    grid_of,
    image,
    words,
)
from refcloud.image import srgb_decode

WIDTH, HEIGHT = 320, 150  # pixels of a figure
MARGIN, TITLE = 8.0, 26.0  # units around a panel, and for its title
UNITS = 640.0  # across a canvas


@dataclass(frozen=True, eq=False)
class Figure:
    """What is shown of an erratum.

    Attributes
    ----------
    line
        What the library computed, one sentence or two.
    canvas
        The picture; none where it would say nothing.
    """

    line: str
    canvas: Canvas | None = None

    def codes(self) -> np.ndarray:
        """Give the picture's codes, shape (H, W, 3)."""
        assert self.canvas is not None
        return self.canvas.picture().codes(tone="none", dither=False)


Draw = Callable[[], Figure]


def paper(height: int = HEIGHT) -> Canvas:
    """Make an empty sheet."""
    return blank(WIDTH, height)


def grey(values: Any) -> Array:
    """Show values in [0, 1] as the codes 255 v, shape (H, W, 3)."""
    shown = srgb_decode(np.clip(np.asarray(values, np.float64), 0.0, 1.0))
    return np.repeat(shown[..., None], 3, axis=-1)


def colours(values: Any) -> Array:
    """Show RGB values in [0, 1] as the codes 255 v."""
    return srgb_decode(np.clip(np.asarray(values, np.float64), 0.0, 1.0))


def pictures(panels: dict[str, Array]) -> tuple[Canvas, list[tuple[float, ...]]]:
    """Lay pictures of one shape side by side under their titles.

    Returns
    -------
    The canvas, and each panel's box (left, top, right, bottom), units.
    """
    count = len(panels)
    side = (UNITS - MARGIN * (count + 1)) / count
    h, w = next(iter(panels.values())).shape[:2]
    tall = side * h / w
    canvas = paper(round((tall + TITLE + MARGIN) * WIDTH / UNITS))
    boxes = []
    for i, (title, light) in enumerate(panels.items()):
        left = MARGIN + i * (side + MARGIN)
        place = (left, TITLE, left + side, TITLE + tall)
        image(canvas, light, place[:2], place[2:])
        box(canvas, place[:2], place[2:], GREY, 1.0)
        words(canvas, (left + 0.5 * side, 0.5 * TITLE), title, size=20, anchor="mm")
        boxes.append(place)
    return canvas, boxes


def plots(count: int, height: int = HEIGHT) -> tuple[Canvas, list[Any]]:
    """Give a sheet, and its cells side by side."""
    canvas = paper(height)
    return canvas, grid_of(canvas, count, 1)


def frame(
    canvas: Canvas,
    cell: Any,
    x: tuple[float, float],
    y: tuple[float, float],
    ticks: tuple[Any, Any],
    title: str,
    below: str = "",
) -> Axes:
    """Draw a frame with ticks; words are as large as this small sheet needs."""
    left, top, right, bottom = cell
    axes = axes_in(
        canvas, (left + 8.0, top + 6.0, right, bottom - 12.0), x, y,
        ticks_x=ticks[0], ticks_y=ticks[1],
    )  # fmt: skip
    middle = 0.5 * (axes.left + axes.right)
    words(canvas, (middle, top + 16.0), title, size=19, anchor="mm")
    words(canvas, (middle, bottom - 12.0), below, size=18, anchor="mm")
    return axes


def name(axes: Axes, x: float, y: float, text: str, ink: Array) -> None:
    """Write a curve's name at a place of its axes."""
    (at,) = axes.place([x], [y])
    words(axes.canvas, at, text, ink, size=18, halo=np.ones(3))
