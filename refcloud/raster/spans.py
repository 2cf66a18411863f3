"""Row spans of triangles: the pixels whose centres lie in them, exactly.

A triangle fills the pixels whose centres lie in it. A centre on an edge belongs to the
triangle whose left or upper edge it is, so that triangles that share an edge fill every
pixel of both once: at 50 % a pixel filled twice would show.

In a row of pixels a triangle covers one stretch. Each edge ends it on one side, at a
quotient of whole numbers, so the first and the last column come from a division for
each edge that is rounded down, and no pixel is ever asked whether it lies inside.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.conventions import Array, Range, Shape
from refcloud.raster.framebuffer import Size
from refcloud.raster.window import SUBPIXEL, Places, to_subpixels

Indices = NDArray[np.int64]
HALF = SUBPIXEL // 2
ROWS_AT_ONCE = 1 << 18  # triangles are taken in batches that cover about so many rows
FARTHEST = 1 << 60  # column: beyond every window, and every edge's reach


@dataclass(frozen=True, eq=False)
class Spans:
    """Stretches of pixels, in the order of their triangles.

    Attributes
    ----------
    triangle
        Which triangle, shape (R,).
    row, first, count
        Row, first column and number of pixels, at least 1, shape (R,).
    """

    triangle: Indices
    row: Indices
    first: Indices
    count: Indices

    def some(self, which: Indices | NDArray[np.bool_] | slice) -> Spans:
        """Give some of them."""
        numbers = (self.triangle, self.row, self.first, self.count)
        if isinstance(which, slice) or which.dtype == bool:
            return Spans(*(of_span[which] for of_span in numbers))
        return Spans(*(of_span.take(which) for of_span in numbers))

    def parted(self) -> tuple[Spans, Spans]:
        """Give those that share no pixel, in the pixels' order, and the others.

        What has its pixels for itself may be drawn at any time. So it is drawn as the
        pixels lie in memory, and nothing of it is ever sorted out pixel by pixel.
        """
        # 1. By row, then by column. Numpy sorts numbers of 16 bits digit by digit.
        largest = max(int(k.max(initial=0)) for k in (self.first, self.row))
        kind = np.min_scalar_type(largest)
        order = np.lexsort([k.astype(kind) for k in (self.first, self.row)])
        # 2. Columns of all rows on one line: a span stands alone if it begins after all
        #    before it have ended, and ends before the next begins.
        width = int((self.first + self.count).max(initial=0))
        begin = (self.row * width + self.first).take(order)
        end = begin + self.count.take(order)
        before_next = end[:-1] <= begin[1:]
        if before_next.all():
            return self.some(order), self.some(slice(0, 0))
        alone = np.ones(len(order), bool)
        alone[1:] = begin[1:] >= np.maximum.accumulate(end)[:-1]
        alone[:-1] &= before_next
        shared = np.sort(order[~alone])
        return self.some(order[alone]), self.some(shared)

    def pixels(self) -> tuple[Indices, Indices, Indices]:
        """Give triangle, row and column of every pixel, span after span."""
        begin = np.cumsum(self.count) - self.count
        triangle, row, first = (
            np.repeat(of_span, self.count)
            for of_span in (self.triangle, self.row, self.first - begin)
        )
        return triangle, row, first + np.arange(len(row))


def batches(counts: Indices, most: int) -> Iterator[slice]:
    """Split a list so that the counts of each part add up to at most so many, or one.

    Parameters
    ----------
    counts
        At least 0 each, shape (n,).
    most
        The largest sum of a part of several.

    Yields
    ------
    Slices of the list, one after the other.
    """
    ends = np.cumsum(counts)
    start = 0
    while start < len(ends):
        done = int(ends[start - 1]) if start else 0
        stop = max(int(np.searchsorted(ends, done + most, "right")), start + 1)
        yield slice(start, stop)
        start = stop


@checked
def triangle_pixels(
    corners: Annotated[Array, Shape(3, 2), Range(-(2.0**22), 2.0**22, "pixels")],
    *,
    width: Size,
    height: Size,
) -> tuple[Indices, Indices]:
    """Find the pixels whose centres lie in a triangle.

    Formula: (b - a) x (f - a), (c - b) x (f - b) and (a - c) x (f - c) all have the
    sign of the triangle; 0 counts on a left or an upper edge

    Parameters
    ----------
    corners
        a, b, c in pixels from the left and the top edge, shape (3, 2), in any order;
        rounded to 1/256.
    width, height
        Size of the window.

    Returns
    -------
    Row and column of each pixel in the window, row by row.

    Source: OpenGL 4.6, section 14.6 (polygons); document D (F08).

    Examples
    --------
    >>> rows, columns = triangle_pixels([[0, 0], [3, 0], [0, 3]], width=2, height=2)
    >>> list(zip(rows.tolist(), columns.tolist()))
    [(0, 0), (0, 1), (1, 0)]
    """
    x, y = to_subpixels(corners).T[:, :, None]
    if area_of(x, y)[0] < 0:
        x, y = x[::-1], y[::-1]
    box = slice(0, height), slice(0, width)
    _, rows, columns = next(row_spans(x, y, *box)).pixels()
    return rows, columns


def row_spans(x: Places, y: Places, rows: slice, columns: slice) -> Iterator[Spans]:
    """Find the spans of triangles in a box of the window.

    Formula: run (y - ay) - rise (x - ax) >= 0 on the inner side of each edge, > 0 where
    it is a right or a lower edge

    Parameters
    ----------
    x, y
        Corners in sub-pixels, y downward, shape (3, T): run from left to right over the
        upper edge, that is with an area above 0; others are left out.
    rows, columns
        The box, slices with both ends.

    Yields
    ------
    Batches of spans, in the triangles' order.

    Source: OpenGL 4.6, section 14.6.1 (polygon rasterization, F10).
    """
    if not x.shape[1]:
        return
    # Rows whose centres lie between the highest corner and the lowest; that one does
    # not count.
    top = np.maximum(-((HALF - y.min(axis=0)) // SUBPIXEL), rows.start)
    bottom = np.minimum(-((HALF - y.max(axis=0)) // SUBPIXEL), rows.stop)
    height = np.where(area_of(x, y) > 0, np.maximum(bottom - top, 0), 0)
    before = np.cumsum(height) - height
    for part in batches(height, ROWS_AT_ONCE):
        rows_of = functools.partial(np.repeat, repeats=height[part])
        triangle = rows_of(np.arange(part.start, part.stop))
        row = rows_of((top - before)[part] + before[part.start])
        row += np.arange(len(row))
        low, high = _columns(x[:, part], y[:, part], rows_of, row, columns)
        spans = Spans(triangle, row, low, high - low)
        filled = high > low
        yield spans if filled.all() else spans.some(filled)


def area_of(x: Places, y: Places) -> Indices:
    """Give twice the area of triangles, above 0 where they run clockwise on screen."""
    return (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])


def reaching(places: Places, part: slice) -> NDArray[np.bool_]:
    """Tell of which triangles x or y, shape (3, T), reaches into columns or rows."""
    low, high = places.min(axis=0), places.max(axis=0)
    return (high >= part.start * SUBPIXEL) & (low <= part.stop * SUBPIXEL)


def _columns(
    x: Places,
    y: Places,
    of_rows: Callable[[Any], Any],
    row: Indices,
    columns: slice,
) -> tuple[Indices, Indices]:
    """Give the first column of each row, and the one behind the last.

    `of_rows` gives each row its triangle's number.
    """
    # Whole numbers below 2^53 are whole in float64 as well, in which numpy divides many
    # times faster; those below add up six products of two places at most. A quotient
    # rounded there has the right floor: it is 1 / step or more away from the next whole
    # number, further than it is rounded by.
    reach = max(int(np.abs(k).max(initial=0)) for k in (x, y, row * SUBPIXEL))
    kind: Any = np.float64 if 8 * (reach + SUBPIXEL) ** 2 < 1 << 53 else np.int64
    x, y, row = (k.astype(kind) for k in (x, y, row))
    low = np.full(len(row), columns.start, kind)
    high = np.full(len(row), columns.stop, kind)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        run, rise = x[b] - x[a], y[b] - y[a]
        # Twice the area spanned with the centre of column 0 in row 0, less than 0 on
        # the outer side; 1 less where the edge itself does not count.
        counts = (rise < 0) | ((rise == 0) & (run > 0))
        at_zero = run * (HALF - y[a]) - rise * (HALF - x[a]) - ~counts
        # A step to the right changes that by -rise.
        last = of_rows(run * SUBPIXEL)
        last *= row
        last += of_rows(at_zero)
        step = of_rows(np.maximum(np.abs(rise), 1) * SUBPIXEL)
        if kind is np.float64:
            last /= step
            np.floor(last, out=last)
        else:
            last //= step
        # Edges that go down end the span, edges that go up begin it; level ones are
        # the rows' own ends. Others are moved to where they cut nothing off.
        beyond = kind(FARTHEST)
        np.minimum(high, last + of_rows(np.where(rise > 0, kind(1), beyond)), out=high)
        np.maximum(low, of_rows(np.where(rise < 0, kind(0), -beyond)) - last, out=low)
    return low.astype(np.int64), high.astype(np.int64)
