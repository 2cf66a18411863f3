"""Which balls touch which tile: one list of pairs, sorted by tile, near to far in each.

A tile is a square of pixels that is composited by itself. All that the picture needs of
a ball is in the few tiles that its disc reaches; all that a tile needs is its own short
list of balls.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array

SIDE = 16  # pixels along a tile's edge: lists stay short, rows of numbers stay long
PIXELS = SIDE * SIDE
# Pairs that are listed at once, about 100 MB: a picture with more is made in parts.
MOST_PAIRS = 1 << 20
MOST_TILES = 4096  # likewise: 32 MB of float64 for each channel of the parts' results
# Relative room in the test of a disc against a tile, over what rounding may do.
ROOM = 1e-9

Whole = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Discs:
    """The balls of a picture as they are drawn, near to far.

    Attributes
    ----------
    x, y, radius
        Centres and radii in pixels, shape (N,); every radius above 0.
    """

    x: Array
    y: Array
    radius: Array


@dataclass(frozen=True, eq=False)
class TileLists:
    """The balls of each tile that has any.

    Attributes
    ----------
    row, column
        Of the tiles, in tiles, shape (T,).
    first, count
        Where each tile's list begins in `ball`, and how many it has, shape (T,).
    ball
        Numbers of balls, shape (P,): tile after tile, near to far within one.
    box
        First and one past the last column, and row, of the tiles that were looked at.
    edge
        Pixels along a tile's edge.
    """

    row: Whole
    column: Whole
    first: Whole
    count: Whole
    ball: Whole
    box: tuple[int, int, int, int]
    edge: int = SIDE

    def from_middles(self, discs: Discs) -> tuple[Array, Array]:
        """Give x and y of each pair's ball from its tile's middle, pixels, (P,)."""
        x, y = discs.x.take(self.ball), discs.y.take(self.ball)
        x -= np.repeat((self.column + 0.5) * self.edge, self.count)
        y -= np.repeat((self.row + 0.5) * self.edge, self.count)
        return x, y

    def chosen(self, which: Whole) -> TileLists:
        """Give the lists of some of the tiles."""
        count = self.count[which]
        end = np.cumsum(count)
        pair = np.arange(int(end[-1]) if len(end) else 0)
        pair += np.repeat(self.first[which] - (end - count), count)
        return TileLists(
            self.row[which],
            self.column[which],
            end - count,
            count,
            self.ball[pair],
            self.box,
            self.edge,
        )

    def quarters(
        self, tile: Whole, row: Whole, column: Whole, discs: Discs
    ) -> TileLists:
        """List the balls of quarters of tiles: each is a tile of half the edge.

        Parameters
        ----------
        tile, row, column
            Numbers of the tiles, and which of their quarters, 0 or 1, shape (Q,).
        discs
            The balls.

        Returns
        -------
        The lists of the quarters, in that order.
        """
        # 1. Those of the whole tiles, from the quarters' middles.
        mine, edge = self.chosen(tile), self.edge // 2
        row, column = 2 * mine.row + row, 2 * mine.column + column
        box = (2 * self.box[0], 2 * self.box[1], 2 * self.box[2], 2 * self.box[3])
        whole = TileLists(row, column, mine.first, mine.count, mine.ball, box, edge)
        # 2. Of these, the balls that reach a pixel's centre; of each list one at least.
        outside = np.zeros(len(whole.ball))
        for place in whole.from_middles(discs):
            gap = np.maximum(np.abs(place, out=place) - 0.5 * (edge - 1), 0.0)
            outside += np.square(gap, out=gap)
        radius = discs.radius.take(whole.ball)
        kept = outside <= (1.0 + ROOM) * radius * radius
        kept[whole.first] = True
        count = np.add.reduceat(kept, whole.first, dtype=np.intp)
        first = np.cumsum(count) - count
        return TileLists(row, column, first, count, whole.ball[kept], box, edge)


@dataclass(frozen=True)
class Ranges:
    """First and one past the last tile of each ball, by column and by row, (N,)."""

    left: Whole
    right: Whole
    top: Whole
    bottom: Whole

    def within(self, box: tuple[int, int, int, int]) -> Ranges:
        """Cut the ranges off at a box of tiles: left, right, top, bottom."""
        return Ranges(
            np.maximum(self.left, box[0]),
            np.minimum(self.right, box[1]),
            np.maximum(self.top, box[2]),
            np.minimum(self.bottom, box[3]),
        )

    def tiles(self) -> Whole:
        """Count the tiles of each ball."""
        across = np.maximum(self.right - self.left, 0)
        return across * np.maximum(self.bottom - self.top, 0)


def ranges_of(discs: Discs, width: int, height: int, edge: int = SIDE) -> Ranges:
    """Give the tiles that hold pixels of each ball's bounding square, as `patch` does.

    Parameters
    ----------
    discs
        The balls.
    width, height
        Size of the picture, pixels.
    edge
        Pixels along a tile's edge.

    Returns
    -------
    The ranges; empty ones for balls that reach no pixel's centre.
    """
    ends = []
    for place, size in ((discs.x, width), (discs.y, height)):
        # Cut off at the borders before rounding: no radius makes a large integer.
        low = np.minimum(np.maximum(place - discs.radius, 0.0), size)
        high = np.maximum(np.minimum(place + discs.radius, size), 0.0)
        first = np.ceil(low - 0.5).astype(np.intp)
        stop = np.floor(high - 0.5).astype(np.intp) + 1
        empty = stop <= first
        ends += [first // edge, np.where(empty, 0, (stop + edge - 1) // edge)]
    return Ranges(*ends)


def parts(discs: Discs, width: int, height: int) -> Iterator[TileLists]:
    """List the pairs of a picture, in parts of bounded size.

    Parameters
    ----------
    discs
        The balls, near to far.
    width, height
        Size of the picture, pixels.

    Yields
    ------
    The lists of one box of tiles after the other; boxes without balls are left out.
    """
    ranges = ranges_of(discs, width, height)
    boxes = [(0, -(-width // SIDE), 0, -(-height // SIDE))]
    while boxes:
        box = boxes.pop()
        left, right, top, bottom = box
        here = ranges.within(box)
        counts = here.tiles()
        many = int(counts.sum())
        tiles = (right - left) * (bottom - top)
        if tiles > 1 and (many > MOST_PAIRS or tiles > MOST_TILES):
            x, y = (left + right) // 2, (top + bottom) // 2
            if right - left > bottom - top:
                boxes += [(x, right, top, bottom), (left, x, top, bottom)]
            else:
                boxes += [(left, right, y, bottom), (left, right, top, y)]
        elif many:
            yield tile_lists(discs, here, counts, box)


def tile_lists(
    discs: Discs,
    ranges: Ranges,
    counts: Whole,
    box: tuple[int, int, int, int],
    edge: int = SIDE,
) -> TileLists:
    """List the pairs of tile and ball of a box of tiles.

    Parameters
    ----------
    discs
        The balls, near to far.
    ranges, counts
        Their tiles within the box, and how many each has.
    box
        First and one past the last column, and row, of the tiles.
    edge
        Pixels along a tile's edge.

    Returns
    -------
    The lists.
    """
    # 1. The rows of tiles of each ball, and on each the columns that its disc reaches:
    #    those whose rectangle of pixels' centres the chord nearest to the middle meets.
    high = np.where(counts > 0, ranges.bottom - ranges.top, 0)
    ball = np.repeat(np.arange(len(counts)), high)
    row = np.arange(len(ball)) - np.repeat(np.cumsum(high) - high - ranges.top, high)
    x, y, radius = (of.take(ball) for of in (discs.x, discs.y, discs.radius))
    low = row * float(edge) + 0.5
    gap = np.maximum(low, np.minimum(y, low + (edge - 1.0)))
    gap -= y
    gap /= radius
    half = np.sqrt(np.maximum(1.0 + ROOM - gap * gap, 0.0))
    half *= radius
    left, right = ranges.left.take(ball), ranges.right.take(ball)
    first = np.ceil((x - half - (edge - 0.5)) / edge)
    stop = np.floor((x + half - 0.5) / edge) + 1.0
    first = np.maximum(left, np.minimum(first, right)).astype(np.intp)
    stop = np.maximum(left, np.minimum(stop, right)).astype(np.intp)
    count = np.maximum(stop - first, 0)

    # 2. One pair for each tile of these, ball after ball.
    wide = box[1] - box[0]
    shift = first - box[0] + (row - box[2]) * wide - (np.cumsum(count) - count)
    tile = np.repeat(shift, count)
    tile += np.arange(len(tile))
    ball = np.repeat(ball, count)

    # 3. Sort by tile; a stable sort leaves the balls of a tile near to far.
    few = wide * (box[3] - box[2]) <= 1 << 16  # numpy counts short keys, in no time
    order = np.argsort(tile.astype(np.uint16) if few else tile, kind="stable")
    counted = np.bincount(tile, minlength=wide * (box[3] - box[2]))
    used = np.flatnonzero(counted)
    count = counted[used]
    return TileLists(
        used // wide + box[2],
        used % wide + box[0],
        np.cumsum(count) - count,
        count,
        ball[order],
        box,
        edge,
    )
