"""Row spans of triangles: the pixels whose centres lie in them, exactly.

A triangle fills the pixels whose centres lie in it. A centre on an edge belongs to the
triangle whose left or upper edge it is, so that triangles that share an edge fill every
pixel of both once: at 50 % a pixel filled twice would show.

In a row of pixels a triangle covers one stretch. Each edge ends it on one side, at a
quotient of whole numbers, so the first and the last column come from a division for
each edge that is rounded down, and no pixel is ever asked whether it lies inside.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.conventions import Array, Range, Shape
from refcloud.raster.framebuffer import Size
from refcloud.raster.window import SUBPIXEL, Places, to_subpixels

Indices = NDArray[np.int64]
HALF = SUBPIXEL // 2
ROWS_AT_ONCE = 1 << 18  # triangles are taken in batches that cover about so many rows
FARTHEST = 1 << 40  # column: beyond every window


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

    def batches(self, most: int) -> Iterator[Spans]:
        """Split them so that each part has at most so many pixels, or one span."""
        ends = np.cumsum(self.count)
        start = 0
        while start < len(ends):
            done = int(ends[start - 1]) if start else 0
            stop = max(int(np.searchsorted(ends, done + most, "right")), start + 1)
            part = slice(start, stop)
            yield Spans(
                self.triangle[part], self.row[part], self.first[part], self.count[part]
            )
            start = stop

    def pixels(self) -> tuple[Indices, Indices, Indices]:
        """Give triangle, row and column of every pixel, span after span."""
        begin = np.cumsum(self.count) - self.count
        triangle, row, first = (
            np.repeat(of_span, self.count)
            for of_span in (self.triangle, self.row, self.first - begin)
        )
        return triangle, row, first + np.arange(len(row))


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
    ends = np.cumsum(height)
    start = 0
    while start < len(ends):
        done = int(ends[start - 1]) if start else 0
        stop = int(np.searchsorted(ends, done + ROWS_AT_ONCE, side="right"))
        stop = max(stop, start + 1)
        part = slice(start, stop)
        triangle = np.repeat(np.arange(start, stop), height[part])
        within = np.arange(len(triangle)) - (ends - height - done)[triangle]
        row = top[triangle] + within
        low, high = _columns(x, y, triangle, row, columns)
        found = high > low
        yield Spans(triangle[found], row[found], low[found], high[found] - low[found])
        start = stop


def area_of(x: Places, y: Places) -> Indices:
    """Give twice the area of triangles, above 0 where they run clockwise on screen."""
    return (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])


def _columns(
    x: Places, y: Places, triangle: Indices, row: Indices, columns: slice
) -> tuple[Indices, Indices]:
    """Give the first column of each row, and the one behind the last."""
    low = np.full(len(row), columns.start)
    high = np.full(len(row), columns.stop)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        run, rise = x[b] - x[a], y[b] - y[a]
        # Twice the area spanned with the centre of column 0 in row 0, less than 0 on
        # the outer side; 1 less where the edge itself does not count.
        counts = (rise < 0) | ((rise == 0) & (run > 0))
        at_zero = run * (HALF - y[a]) - rise * (HALF - x[a]) - np.where(counts, 0, 1)
        # A step to the right changes that by -rise.
        step = np.maximum(np.abs(rise), 1) * SUBPIXEL
        value = at_zero[triangle] + (run * SUBPIXEL)[triangle] * row
        last = value // step[triangle]
        side = np.sign(rise)[triangle]
        # Edges that go down end the span, edges that go up begin it; level ones are
        # the rows' own ends.
        high = np.where(side > 0, np.minimum(high, last + 1), high)
        low = np.where(side < 0, np.maximum(low, -last), low)
    return low, high
