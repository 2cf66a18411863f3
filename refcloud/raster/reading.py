"""Reading back: a box of pixels, and its average."""

from __future__ import annotations

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array
from refcloud.raster.framebuffer import Framebuffer, clipped, within


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
    A copy, shape (h, w, 4), of what is stored: SRGB8_ALPHA8 gives encoded values, as
    glReadPixels does.

    Raises
    ------
    ValueError
        The box leaves the buffer or skips pixels.

    Source: paper M, section 4.1, second step (back reading); F03 (glReadPixels).

    Examples
    --------
    >>> from refcloud.raster import framebuffer
    >>> read_pixels(framebuffer(3, 3), slice(0, 2), slice(1, 3)).shape
    (2, 2, 4)
    """
    height, width, _ = buffer.pixels.shape
    box = within("rows", rows, height), within("columns", columns, width)
    return buffer.pixels[box].copy()


@checked
def read_average(buffer: Framebuffer, rows: slice, columns: slice) -> Array | None:
    """Read a box of pixels back and average it.

    Formula: sum of the pixels in the box / count of the pixels in the box

    Parameters
    ----------
    buffer
        The framebuffer.
    rows, columns
        The box, as slices with both ends and step 1. It may leave the buffer: what lies
        outside is neither read nor counted.

    Returns
    -------
    Mean RGBA of what is stored, shape (4,), summed in float64; None where the box holds
    no pixel of the buffer.

    Raises
    ------
    ValueError
        The box lacks an end or skips pixels.

    Source: paper M, section 4.1, second step; F03, L07, E27.

    Examples
    --------
    >>> from refcloud.raster import framebuffer
    >>> read_average(framebuffer(3, 3, color=[1, 1, 1, 1]), slice(-2, 1), slice(2, 9))
    array([1., 1., 1., 1.])
    """
    height, width, _ = buffer.pixels.shape
    box = clipped("rows", rows, height), clipped("columns", columns, width)
    read = buffer.pixels[box]
    return read.mean(axis=(0, 1), dtype=np.float64) if read.size else None
