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

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import Camera, OrthographicCamera
from refcloud.checking import checked
from refcloud.conventions import Array, Range, Shape
from refcloud.raster.factors import Blending, Factor
from refcloud.raster.framebuffer import CHANNELS, Framebuffer, Rgba, Size
from refcloud.raster.meshes import WORLD
from refcloud.raster.store import State, stored_in, write
from refcloud.raster.window import (
    NEAR,
    SUBPIXEL,
    Near,
    Places,
    cut_line,
    planes_of,
    refuse_other_size,
    snapped,
    to_camera,
    to_subpixels,
)

Indices = NDArray[np.intp]
HALF = SUBPIXEL // 2
# Products of two sub-pixel coordinates stay below 2^63.
Place = Annotated[Array, Shape(2), Range(-(2.0**22), 2.0**22, "pixels")]
Thickness = Annotated[int, Range(1, 256, "pixels")]


@checked
def line_pixels(
    start: Place, end: Place, *, width: Size, height: Size, thickness: Thickness = 1
) -> tuple[Indices, Indices]:
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
    return pixels_between(ends, width, height, thickness)


def pixels_between(
    ends: Places, width: int, height: int, thickness: int
) -> tuple[Indices, Indices]:
    """Find the pixels of a line between sub-pixels: the inner form of `line_pixels`.

    Parameters
    ----------
    ends
        Start and end, x and y in sub-pixels, shape (2, 2).
    width, height, thickness
        As `line_pixels`.

    Returns
    -------
    As `line_pixels`.
    """
    # 1. Let u run along the line and v across it. A thick line is moved by half of
    #    what it gains, and grows from there.
    run, rise = np.abs(ends[1] - ends[0]).tolist()
    along_x = run >= rise
    (ua, va), (ub, vb) = (ends if along_x else ends[:, ::-1]).tolist()
    shift = (thickness - 1) * HALF
    va, vb = va - shift, vb - shift
    du, dv = ub - ua, vb - va

    # 2. Columns (or rows) whose middle lies between the ends; the hair lets the lower
    #    end in and the upper one out.
    low, high = min(ua, ub), max(ua, ub)
    first, last = -((HALF - low) // SUBPIXEL), -((HALF - high) // SUBPIXEL)

    # 3. The diamond that holds the start counts, the one that holds the end does not.
    start, end = (_diamond_with(u, v, along_x) for u, v in ((ua, va), (ub, vb)))
    if du > 0:
        first = first if start is None else min(first, start)
        last = last if end is None else min(last, end)
    else:
        last = last if start is None else max(last, start + 1)
        first = first if end is None else max(first, end + 1)
    size, breadth = (width, height) if along_x else (height, width)
    steps = np.arange(max(first, 0), min(last, size), dtype=np.int64)
    if du == 0 or not steps.size:
        return np.zeros(0, np.intp), np.zeros(0, np.intp)

    # 4. Where the line crosses the middle of each. On a border between two pixels the
    #    hair decides: rising along x it leads to the upper one, else to the lower.
    crossing = (va * du + (steps * SUBPIXEL + HALF - ua) * dv) * (1 if du > 0 else -1)
    rising = along_x and dv * du > 0
    across = (crossing - (0 if rising else 1)) // (SUBPIXEL * abs(du))

    # 5. Its pixels across, as many as it is thick, within the window.
    steps = np.repeat(steps, thickness)
    across = (across[:, None] + np.arange(thickness)).ravel()
    inside = (across >= 0) & (across < breadth)
    steps, across = steps[inside].astype(np.intp), across[inside].astype(np.intp)
    return (across, steps) if along_x else (steps, across)


def _diamond_with(u: int, v: int, along_x: bool) -> int | None:
    """Give the column (or row) of the pixel whose diamond holds a place, or None."""
    # The hair takes places on a border to the pixel before it.
    column, row = (u - 1) // SUBPIXEL, (v - 1) // SUBPIXEL
    du, dv = u - column * SUBPIXEL - HALF, v - row * SUBPIXEL - HALF
    far = abs(du) + abs(dv)
    # On the diamond's border the hair along x leads inward from the right side.
    inside = far < HALF or (far == HALF and (du if along_x else dv) > 0)
    return column if inside else None


@checked
def draw_lines(
    buffer: Framebuffer,
    camera: Camera | OrthographicCamera,
    lines: Annotated[Array, Shape("N", 2, 3), WORLD],
    *,
    color: Rgba,
    thickness: Thickness = 1,
    near: Near = NEAR,
    src_factor: Factor = "SRC_ALPHA",
    dst_factor: Factor = "ONE_MINUS_SRC_ALPHA",
) -> None:
    """Draw lines of the world, one after the other, as GL_LINES.

    Formula: c = f_src color + f_dst c at the pixels of `line_pixels`

    Parameters
    ----------
    buffer
        The framebuffer, of the camera's size, written in place.
    camera
        The eye.
    lines
        Start and end of each, shape (N, 2, 3), scene units.
    color
        RGBA, shape (4,), not multiplied by its alpha.
    thickness
        Pixels across; 1 is OpenGL's default.
    near
        Depth before which lines are cut off, scene units.
    src_factor, dst_factor
        Blend factors under OpenGL's names.

    Returns
    -------
    Nothing.

    Raises
    ------
    ValueError
        The framebuffer has another size than the camera's picture.

    Source: document D, Prior to Ray Tracing (F07).

    Examples
    --------
    >>> from refcloud.raster import framebuffer
    >>> buffer = framebuffer(4, 3)
    >>> view = OrthographicCamera([0, 0, 1], [0, 0, 0], width=4, height=3)
    >>> draw_lines(buffer, view, [[[-9, 0, 0], [9, 0, 0]]], color=[1, 0.5, 0, 1])
    >>> buffer.pixels[..., 0].sum(axis=1)
    array([0., 4., 0.])
    """
    refuse_other_size(buffer, camera)
    planes = planes_of(camera, near)
    state = State(blending=Blending(src_factor, dst_factor))
    store = stored_in(buffer)
    for ends in to_camera(camera, lines):
        cut = cut_line(ends, planes)
        if cut is None:
            continue
        place = snapped(camera, cut, near)
        found = pixels_between(place, camera.width, camera.height, thickness)
        source = np.broadcast_to(color, (len(found[0]), CHANNELS))
        write(store, found, source, None, state)
