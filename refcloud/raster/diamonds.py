"""Lines as OpenGL draws them: one pixel for each diamond that the line leaves.

Every pixel has a diamond, |x - xf| + |y - yf| < 1/2 about its centre. A line from a to
b draws the pixels whose diamond it meets, but not the one in whose diamond b lies:
lines that go on from each other draw no pixel twice. Ends are thought to lie a hair
(epsilon, epsilon squared) nearer to the corner of the window, so that no end lies on a
diamond's border; row 0 is at the top here, and nothing else differs from OpenGL.

The pixels are found without looking at diamonds one by one. A line that runs more along
x than along y, and meets a pixel's diamond, crosses the middle of that pixel's column
in it: a diamond is as high as it is wide. Only at its ends may the line stop short of
the middle in a diamond, or have crossed it. Lines along y are the same turned.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.conventions import Array, Range, Shape
from refcloud.raster.framebuffer import Size
from refcloud.raster.window import SUBPIXEL, Places, to_subpixels

Indices = NDArray[np.int64]
HALF = SUBPIXEL // 2
# Products of two sub-pixel coordinates stay below 2^63.
Place = Annotated[Array, Shape(2), Range(-(2.0**22), 2.0**22, "pixels")]
Thickness = Annotated[int, Range(1, 256, "pixels")]


class Crossed(NamedTuple):
    """Pixels of lines, line after line.

    Attributes
    ----------
    line
        Which line, shape (n,).
    row, column
        Shape (n,).
    share
        How far along its line each is, 0 at the start and 1 at the end, shape (n,):
        where the line crosses the middle of its column (or row). OpenGL 4.6 words it as
        the foot of the perpendicular from the centre, up to half a pixel aside; Mesa
        does as here, and all pixels across a thick line have one share.
    """

    line: Indices
    row: Indices
    column: Indices
    share: Array


@checked
def line_pixels(
    start: Place, end: Place, *, width: Size, height: Size, thickness: Thickness = 1
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Find the pixels of a line by the diamond-exit rule.

    Formula: pixels f with a point of the line in |x - xf| + |y - yf| < 1/2, without the
    one whose diamond holds the end

    Parameters
    ----------
    start, end
        In pixels from the left and the top edge, shape (2,); rounded to 1/256.
    width, height
        Size of the window.
    thickness
        Pixels across, above or beside each other; 1 is OpenGL's default.

    Returns
    -------
    Row and column of each pixel in the window, from the left or from the top on.

    Source: OpenGL 4.6, section 14.5 (line segments); document D (F07).

    Examples
    --------
    >>> line_pixels([0.5, 0.5], [3.5, 1.5], width=4, height=2)
    (array([0, 0, 1]), array([0, 1, 2]))
    """
    ends = to_subpixels(np.stack([start, end]))
    found = pixels_between(ends[None], width, height, thickness)
    return found.row.astype(np.intp), found.column.astype(np.intp)


def pixels_between(ends: Places, width: int, height: int, thickness: int) -> Crossed:
    """Find the pixels of lines between sub-pixels: the inner form of `line_pixels`.

    Parameters
    ----------
    ends
        Start and end of each, x and y in sub-pixels, shape (N, 2, 2).
    width, height, thickness
        As `line_pixels`.

    Returns
    -------
    The pixels in the window, in the lines' order.
    """
    # 1. Let u run along each line and v across it. A thick line is moved by half of
    #    what it gains, and grows from there.
    run, rise = np.abs(ends[:, 1] - ends[:, 0]).T
    along_x = run >= rise
    u, v = np.where(along_x, ends.T, ends.T[::-1])  # (2, N): of starts, of ends
    v = v - (thickness - 1) * HALF
    du, dv = u[1] - u[0], v[1] - v[0]
    forward = du > 0

    # 2. Columns (or rows) whose middle lies between the ends; the hair lets the lower
    #    end in and the upper one out.
    first = -((HALF - u.min(axis=0)) // SUBPIXEL)
    last = -((HALF - u.max(axis=0)) // SUBPIXEL)

    # 3. The diamond that holds the start counts, the one that holds the end does not.
    (start, starts), (end, stops) = (_diamond_with(u[k], v[k], along_x) for k in (0, 1))
    first = np.where(forward & starts, np.minimum(first, start), first)
    last = np.where(forward & stops, np.minimum(last, end), last)
    last = np.where(~forward & starts, np.maximum(last, start + 1), last)
    first = np.where(~forward & stops, np.maximum(first, end + 1), first)
    first = np.maximum(first, 0)
    last = np.minimum(last, np.where(along_x, width, height))
    count = np.where(du != 0, np.maximum(last - first, 0), 0)
    line = np.repeat(np.arange(len(count)), count)
    steps = np.arange(len(line)) + (first - np.cumsum(count) + count)[line]

    # 4. Where the lines cross the middle of each. On a border between two pixels the
    #    hair decides: rising along x it leads to the upper one, else to the lower.
    rising = along_x & (dv * du > 0)
    before = v[0] * du + (HALF - u[0]) * dv
    crossing = (before[line] + (dv * SUBPIXEL)[line] * steps) * np.sign(du)[line]
    across = (crossing - ~rising[line]) // (SUBPIXEL * np.abs(du))[line]
    share: Any = (steps * SUBPIXEL + HALF - u[0][line]) / du[line]

    # 5. Their pixels across, as many as they are thick, within the window.
    line, steps, share = (np.repeat(of, thickness) for of in (line, steps, share))
    across = (across[:, None] + np.arange(thickness)).ravel()
    inside = (across >= 0) & (across < np.where(along_x, height, width)[line])
    line, steps, across = line[inside], steps[inside], across[inside]
    row = np.where(along_x[line], across, steps)
    column = np.where(along_x[line], steps, across)
    return Crossed(line, row, column, share[inside])


def _diamond_with(
    u: Indices, v: Indices, along_x: NDArray[np.bool_]
) -> tuple[Indices, NDArray[np.bool_]]:
    """Give the column (or row) of a place's pixel, and if its diamond holds the place.

    The hair takes places on a border to the pixel before it.
    """
    column, row = (u - 1) // SUBPIXEL, (v - 1) // SUBPIXEL
    du, dv = u - column * SUBPIXEL - HALF, v - row * SUBPIXEL - HALF
    far = np.abs(du) + np.abs(dv)
    # On the diamond's border the hair along x leads inward from the right side.
    inward = np.where(along_x, du, dv) > 0
    return column, (far < HALF) | ((far == HALF) & inward)
