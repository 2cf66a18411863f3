"""The map of stability as a picture: a panel for each algorithm, a square a cell."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from PIL import Image, ImageDraw

from refcloud.bench.stability.probe import Panel
from refcloud.conventions import Array
from refcloud.image import Picture, srgb_decode

PAPER, INK = (255, 255, 255), (40, 40, 40)
# Codes that stay apart for those who see red and green alike: by lightness as well.
COLOURS = {
    "green": (86, 168, 104),
    "amber": (240, 190, 70),
    "red": (170, 30, 40),
    "refused": (205, 210, 218),
}
WIDTH = 640  # of the labelled map, pixels
CELL, LINE = 14, 11  # edge of a square and height of a line of text, pixels
LEFT, GAP = 104, 14  # room for a row's label; between panels


def bare_map(panels: Sequence[Panel], cell: int = 3, columns: int = 4) -> Picture:
    """Draw the panels without a word, in rows of so many: the small golden picture.

    Parameters
    ----------
    panels
        Of `refcloud.bench.stability.panels`.
    cell
        Edge of a square, pixels.
    columns
        Panels in a row.

    Returns
    -------
    The picture.
    """
    pages = [_squares(one, cell) for one in panels]
    rows = [pages[k : k + columns] for k in range(0, len(pages), columns)]
    columns = min(columns, len(pages))
    widths = [max(len(page[0]) for page in pages[c::columns]) for c in range(columns)]
    bands = []
    for row in rows:
        high = max(len(page) for page in row)
        band = np.full((high + 2 * cell, sum(widths) + 2 * cell * columns, 3), PAPER)
        for c, page in enumerate(row):
            x = sum(widths[:c]) + 2 * cell * c + cell
            band[cell : cell + len(page), x : x + len(page[0])] = page
        bands.append(band)
    return Picture(srgb_decode(np.concatenate(bands) / 255.0))


def _squares(one: Panel, cell: int) -> Array:
    codes = np.array([[COLOURS[c.colour] for c in row] for row in one.cells])
    return codes.repeat(cell, axis=0).repeat(cell, axis=1)


def labelled_map(panels: Sequence[Panel]) -> Picture:
    """Draw the panels with names, axes, values and a legend, two in a row.

    Parameters
    ----------
    panels
        Of `refcloud.bench.stability.panels`.

    Returns
    -------
    The picture, 640 pixels wide.
    """
    # 1. Each panel goes below the shorter column.
    bottoms, places = [2 * LINE + GAP] * 2, []
    for one in panels:
        side = bottoms.index(min(bottoms))
        places.append((side * WIDTH // 2, bottoms[side]))
        bottoms[side] += _height(one)
    # 2. Draw them all.
    image = Image.new("RGB", (WIDTH, max(bottoms)), PAPER)
    draw = ImageDraw.Draw(image)
    x = GAP
    for colour, meaning in MEANINGS.items():
        draw.rectangle((x, GAP, x + LINE - 2, GAP + LINE - 2), fill=COLOURS[colour])
        draw.text((x + LINE + 2, GAP - 2), meaning, fill=INK)
        x += LINE + GAP + int(draw.textlength(meaning)) + 4
    for one, place in zip(panels, places, strict=True):
        _labelled(draw, one, *place)
    return Picture(srgb_decode(np.asarray(image) / 255.0))


MEANINGS = {
    "green": "keeps its digits",
    "amber": "loses some",
    "red": "wrong",
    "refused": "refused at the door",
}
# Rows of the column labels, which stand upright, and of the title.
UPRIGHT, TITLE = 46, 2 * LINE + 4


def _height(one: Panel) -> int:
    return TITLE + UPRIGHT + CELL * len(one.cells) + GAP


def _labelled(draw: ImageDraw.ImageDraw, one: Panel, x: int, y: int) -> None:
    probe, worst = one.probe, one.worst
    draw.text((x + GAP, y), f"{probe.name}, {probe.dtype}", fill=INK)
    axes = f"{probe.down.name or 'value'} down, {probe.across.name} across"
    found = "" if worst is None else f"; worst {worst:.0e}"
    draw.text((x + GAP, y + LINE), axes + found, fill=INK)
    top, left = y + TITLE + UPRIGHT, x + LEFT
    for c, label in enumerate(probe.across.labels()):
        text = Image.new("L", (UPRIGHT, LINE + 2), 0)
        ImageDraw.Draw(text).text((0, 0), label, fill=255)
        where = (left + c * CELL + 1, y + TITLE - 2)
        draw.bitmap(where, text.rotate(90, expand=True), fill=INK)
    for r, (label, row) in enumerate(zip(probe.down.labels(), one.cells, strict=True)):
        draw.text(
            (left - 4, top + r * CELL + CELL // 2), label[:16], fill=INK, anchor="rm"
        )
        for c, cell in enumerate(row):
            corner = left + c * CELL, top + r * CELL
            end = corner[0] + CELL - 2, corner[1] + CELL - 2
            draw.rectangle((*corner, *end), fill=COLOURS[cell.colour])
