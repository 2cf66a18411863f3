"""Curves on paper, in numpy alone: the same pixels on every machine but for letters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from sheets import PAPER, Sheet, write

# Apart for those who see red and green alike: by lightness as well.
INKS = ((32, 98, 168), (222, 120, 20), (70, 150, 90), (160, 40, 60), (120, 120, 130))
GRID, FRAME = (228, 231, 235), (150, 155, 162)
LEFT, RIGHT, TOP, BOTTOM = 52, 20, 12, 44  # margins of a labelled plot, pixels
WIDE = 300  # narrower plots carry no letters
STROKE = 1.1  # half the width of a curve, pixels


def curves(
    size: tuple[int, int],
    x: Any,
    lines: Mapping[str, Any],
    *,
    y_range: tuple[float, float],
    marks: Mapping[str, tuple[Any, Any]] | None = None,
    names: tuple[str, str] = ("", ""),
    log: tuple[bool, bool] = (False, False),
    legend: Literal["top", "bottom"] = "bottom",
) -> Sheet:
    """Draw curves over one axis, and points.

    Parameters
    ----------
    size
        Width and height, pixels.
    x
        Where the curves are known, rising; shape (N,).
    lines
        Values by name, each of shape (N,).
    y_range
        What the frame spans upward.
    marks
        Points by name: their x and their y.
    names
        Of the two axes.
    log
        Which axes are logarithmic.
    legend
        Where the names stand, at the right.
    """
    width, height = size
    labels = width >= WIDE
    left, right, top, bottom = (LEFT, RIGHT, TOP, BOTTOM) if labels else (2, 2, 2, 2)
    x = np.asarray(x, float)
    span_x, span_y = _scaled(np.array([x[0], x[-1]]), log[0]), _scaled(y_range, log[1])
    codes = np.full((height, width, 3), float(PAPER))
    columns = np.arange(left, width - right)
    rows = np.arange(top, height - bottom)
    inside = codes[top : height - bottom, left : width - right]

    def to_pixels(values: Any, span: Any, ends: tuple[float, float], on: bool) -> Any:
        share = (_scaled(values, on) - span[0]) / (span[1] - span[0])
        return ends[0] + share * (ends[1] - ends[0])

    ends_x, ends_y = (left, width - right - 1.0), (height - bottom - 1.0, top)
    ticks = _ticks(span_x, log[0]), _ticks(span_y, log[1])
    texts = []
    for tick in ticks[0]:
        at = to_pixels(tick, span_x, ends_x, log[0])
        inside[:, min(max(round(at) - left, 0), len(columns) - 1)] = GRID
        texts.append((at, height - bottom + 11, f"{tick:g}", "mm"))
    for tick in ticks[1]:
        at = to_pixels(tick, span_y, ends_y, log[1])
        inside[min(max(round(at) - top, 0), len(rows) - 1)] = GRID
        texts.append((left - 5, at, f"{tick:g}", "rm"))
    places = to_pixels(x, span_x, ends_x, log[0])
    for k, values in enumerate(lines.values()):
        y = np.interp(columns, places, to_pixels(values, span_y, ends_y, log[1]))
        # Distance to the curve: height above it, over the length of its slope.
        off = np.abs(rows[:, None] - y) / np.hypot(1.0, np.gradient(y))
        _ink(inside, np.clip(STROKE + 0.5 - off, 0.0, 1.0), k)
    for k, (px, py) in enumerate((marks or {}).values(), start=len(lines)):
        across = to_pixels(px, span_x, ends_x, log[0])
        down = to_pixels(py, span_y, ends_y, log[1])
        for a, b in zip(np.atleast_1d(across), np.atleast_1d(down), strict=True):
            off = np.hypot(columns - a, rows[:, None] - b)
            _ink(inside, np.clip(3.0 - off, 0.0, 1.0), k)
    for edge in (inside[0], inside[-1], inside[:, 0], inside[:, -1]):
        edge[...] = FRAME
    sheet = np.floor(codes + 0.5).astype(np.uint8)
    if not labels:
        return Sheet(sheet)
    every = [*lines, *(marks or {})]
    first = top + 12 if legend == "top" else height - bottom - 10 - 17 * len(every)
    texts.append(((left + width - right) / 2, height - 12, names[0], "mm"))
    texts.append((left + 6, top + 9, names[1], "lm"))
    return Sheet(_legend(write(sheet, texts), every, right, first))


def _scaled(values: Any, log: bool) -> Any:
    return np.log10(values) if log else np.asarray(values, float)


def _ticks(span: Any, log: bool) -> list[float]:
    """Choose four to eight round numbers; whole powers of ten where logarithmic."""
    low, high = float(span[0]), float(span[1])
    if log:
        step = max(1, round((high - low) / 6))
        powers = range(int(np.ceil(low - 1e-9)), int(np.floor(high + 1e-9)) + 1)
        return [10.0**p for p in powers if p % step == 0]
    rough = (high - low) / 5.0
    power = 10.0 ** np.floor(np.log10(rough))
    step = power * min((1, 2, 2.5, 5, 10), key=lambda s: abs(s * power - rough))
    first = int(np.ceil(low / step - 1e-9))
    return [k * step for k in range(first, int(np.floor(high / step + 1e-9)) + 1)]


def _ink(inside: Any, cover: Any, k: int) -> None:
    colour = np.array(INKS[k % len(INKS)], float)
    inside += cover[..., None] * (colour - inside)


def _legend(codes: Any, names: list[str], right: int, first: int) -> Any:
    """Name the curves at the right, each beside a stroke of its ink."""
    codes = codes.copy()
    x, texts = codes.shape[1] - right - 8, []
    for k, name in enumerate(names):
        y = first + 17 * k
        codes[y - 1 : y + 2, x - 16 : x] = INKS[k % len(INKS)]
        texts.append((x - 21, y, name, "rm"))
    return write(codes, texts)
