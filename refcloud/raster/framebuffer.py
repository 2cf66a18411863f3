"""The framebuffer: RGBA numbers that are cleared, blended into and read back.

Row 0 is at the top and boxes are slices of rows and columns; OpenGL counts rows from
the bottom, and nothing else differs. The format is OpenGL's RGBA32F in float64:
nothing is clamped or rounded.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from refcloud.checking import checked, complaint
from refcloud.conventions import MOST_PIXELS, Array, Range, Shape

CHANNELS = 4  # red, green, blue, alpha
NOTHING = np.zeros(CHANNELS)
NOTHING.flags.writeable = False
Size = Annotated[int, Range(1, MOST_PIXELS, "pixels")]
Rgba = Annotated[Array, Shape(CHANNELS)]


@dataclass(frozen=True, eq=False)
class Framebuffer:
    """Pixels that passes write to and read from.

    Attributes
    ----------
    pixels
        Shape (H, W, 4), writable float64, RGBA of any size; row 0 at the top.
    """

    pixels: Array

    def __post_init__(self) -> None:
        pixels = self.pixels
        if not isinstance(pixels, np.ndarray) or pixels.dtype != np.float64:
            kind = getattr(pixels, "dtype", type(pixels).__name__)
            raise TypeError(complaint("pixels", "an array of float64", f"{kind}"))
        if pixels.ndim != 3 or pixels.shape[2] != CHANNELS or pixels.size == 0:
            raise ValueError(
                complaint(
                    "pixels", "an array of shape (H, W, 4)", f"shape {pixels.shape}"
                )
            )
        if not pixels.flags.writeable:
            raise ValueError(
                complaint("pixels", "a writable array", "a read-only one", "copy it")
            )


@checked
def framebuffer(width: Size, height: Size, *, color: Rgba = NOTHING) -> Framebuffer:
    """Make a framebuffer of one colour.

    Formula: pixel = color

    Parameters
    ----------
    width, height
        Size in pixels, together at most 64 million pixels.
    color
        RGBA of every pixel, shape (4,).

    Returns
    -------
    The framebuffer, pixels of shape (height, width, 4).

    Raises
    ------
    ValueError
        More than 64 million pixels.

    Source: paper M, section 4.1, first step (white clear); F01.

    Examples
    --------
    >>> framebuffer(3, 2, color=[1, 1, 1, 1]).pixels.shape
    (2, 3, 4)
    """
    if width * height > MOST_PIXELS:
        raise ValueError(
            complaint(
                "width x height", f"at most {MOST_PIXELS} pixels", f"{width * height}"
            )
        )
    # Each channel lies in one piece of memory: blends run along whole rows of it.
    planes = np.empty((CHANNELS, height, width))
    planes[:] = color[:, None, None]
    return Framebuffer(planes.transpose(1, 2, 0))


@checked
def clear(buffer: Framebuffer, color: Rgba) -> None:
    """Set every pixel to one colour.

    Formula: pixel = color

    Parameters
    ----------
    buffer
        The framebuffer, written in place.
    color
        RGBA, shape (4,).

    Returns
    -------
    Nothing.

    Source: paper M, section 4.1, first step; F01 (glClearColor, glClear).

    Examples
    --------
    >>> buffer = framebuffer(2, 1)
    >>> clear(buffer, [1, 1, 1, 0])
    >>> buffer.pixels[0, 1]
    array([1., 1., 1., 0.])
    """
    buffer.pixels[:] = color


@checked
def read_pixels(buffer: Framebuffer, rows: slice, columns: slice) -> Array:
    """Read a box of pixels back.

    Formula: result[i, j] = pixel[rows.start + i, columns.start + j]

    Parameters
    ----------
    buffer
        The framebuffer.
    rows, columns
        The box, as slices with step 1 that lie within the buffer.

    Returns
    -------
    A copy, shape (h, w, 4).

    Raises
    ------
    ValueError
        The box leaves the buffer or skips pixels.

    Source: paper M, section 4.1, second step (back reading); F03 (glReadPixels).

    Examples
    --------
    >>> read_pixels(framebuffer(3, 3), slice(0, 2), slice(1, 3)).shape
    (2, 2, 4)
    """
    height, width, _ = buffer.pixels.shape
    box = within("rows", rows, height), within("columns", columns, width)
    return buffer.pixels[box].copy()


def within(name: str, part: slice, size: int) -> slice:
    """Give a slice its ends, or refuse one that leaves the buffer or has a step.

    Parameters
    ----------
    name
        What the refusal calls it.
    part
        A slice; None stands for either end.
    size
        Rows or columns of the buffer.

    Returns
    -------
    The slice from a first to a last index, 0 <= first <= last <= size.

    Raises
    ------
    ValueError
        The slice does not lie within the buffer.
    """
    first = 0 if part.start is None else part.start
    last = size if part.stop is None else part.stop
    whole = all(isinstance(end, (int, np.integer)) for end in (first, last))
    if not whole or part.step not in (None, 1) or not 0 <= first <= last <= size:
        expected = f"a slice of step 1 within 0 to {size}"
        raise ValueError(complaint(name, expected, f"{part}"))
    return slice(int(first), int(last))
