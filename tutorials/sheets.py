"""Sheets of codes: what a tutorial shows, panels side by side, and their labels."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from refcloud import Picture
from refcloud.image import write_png
from refcloud.image.png import encode_png

PAPER, INK = 255, (45, 50, 58)
LETTERS, LINE = 13, 19  # size of the letters and height of a line of labels, pixels
GAP = 4  # pixels between panels


@dataclass(frozen=True, eq=False)
class Sheet:
    """Codes that are shown as they are, without a tone curve.

    Attributes
    ----------
    codes
        Shape (H, W, 3), uint8, sRGB.
    """

    codes: np.ndarray

    def save(self, path: Any) -> Any:
        """Write a PNG file."""
        return write_png(path, self.codes)

    def _repr_png_(self) -> bytes:
        """Let a notebook show it."""
        file = io.BytesIO()
        encode_png(self.codes, file)
        return file.getvalue()


def sheet_of(shown: Picture | Sheet) -> Sheet:
    """Give the codes of a picture, over white where it is transparent."""
    if isinstance(shown, Sheet):
        return shown
    light = shown.linear
    if shown.alpha is not None:
        light = light + (1.0 - shown.alpha)[..., None]
    return Sheet(Picture(light).codes())


def grey(values: Any, lower: float = 0.0, upper: float = 1.0) -> Sheet:
    """Show values as grey: the code is 255 (v - lower) / (upper - lower).

    Parameters
    ----------
    values
        Shape (H, W), or (H, W, 3) for colours.
    lower, upper
        What is black, and what is white.
    """
    scaled = np.clip((np.asarray(values) - lower) / (upper - lower), 0.0, 1.0)
    codes = np.floor(255.0 * scaled + 0.5).astype(np.uint8)
    return Sheet(codes if codes.ndim == 3 else np.repeat(codes[..., None], 3, axis=-1))


def enlarged(sheet: Sheet, factor: int) -> Sheet:
    """Show each pixel as a square of so many."""
    return Sheet(sheet.codes.repeat(factor, axis=0).repeat(factor, axis=1))


def font() -> Any:
    """Give Pillow's own letters; before 10.1 they have one size."""
    try:
        return ImageFont.load_default(LETTERS)
    except TypeError:
        return ImageFont.load_default()


def write(codes: np.ndarray, texts: Sequence[tuple[float, float, str, str]]) -> Any:
    """Write texts on codes: x, y, the text, and which point of it lies there.

    Parameters
    ----------
    codes
        Shape (H, W, 3).
    texts
        Each with an anchor in Pillow's letters, such as "mm" for its middle.
    """
    image = Image.fromarray(codes)
    draw = ImageDraw.Draw(image)
    letters = font()
    for x, y, text, anchor in texts:
        draw.text((x, y), text, fill=INK, font=letters, anchor=anchor)
    return np.asarray(image)


def side_by_side(
    panels: Mapping[str, Sheet], *, columns: int = 5, labels: bool = True
) -> Sheet:
    """Lay panels in rows, each label below its panel.

    Parameters
    ----------
    panels
        By label; the sizes may differ.
    columns
        Panels in a row.
    labels
        Whether the labels are written.
    """
    sheets = list(panels.values())
    columns = min(columns, len(sheets))
    high = max(len(sheet.codes) for sheet in sheets)
    wide = max(sheet.codes.shape[1] for sheet in sheets)
    down, across = high + (LINE if labels else 0) + GAP, wide + GAP
    rows = -(-len(sheets) // columns)
    page = np.full((rows * down - GAP, columns * across - GAP, 3), PAPER, np.uint8)
    texts = []
    for k, (label, sheet) in enumerate(panels.items()):
        y, x = k // columns * down, k % columns * across
        height, width = sheet.codes.shape[:2]
        page[y : y + height, x : x + width] = sheet.codes
        texts.append((x + width / 2, y + high + LINE / 2 + 1, label, "mm"))
    return Sheet(write(page, texts) if labels else page)
