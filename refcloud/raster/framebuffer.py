"""The framebuffer: pixels and depths in one of OpenGL's formats.

Row 0 is at the top and boxes are slices of rows and columns; OpenGL counts rows from
the bottom, and nothing else differs. Without a format the pixels are OpenGL's RGBA32F
in float64: nothing is clamped or rounded.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from refcloud.checking import check, checked, complaint
from refcloud.conventions import MOST_PIXELS, Array, Range, Shape
from refcloud.image import srgb_decode
from refcloud.raster.formats import Arithmetic, Format, stored

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
        Shape (H, W, 4), writable float64, RGBA of any size; row 0 at the top. The
        8-bit formats hold codes divided by 255, SRGB8_ALPHA8 those of encoded values.
    depth
        Shape (H, W), writable float64 in [0, 1], 0 at the near plane; None for a
        buffer without depth, in front of which the depth test always passes.
    format
        What the pixels can hold: OpenGL's name, or RGBA64F for float64 as it is.
    arithmetic
        Whose rounding: "ideal", the specification's, or "llvmpipe", Mesa's.
    """

    pixels: Array
    depth: Array | None = None
    format: Format = "RGBA64F"
    arithmetic: Arithmetic = "ideal"

    def __post_init__(self) -> None:
        check("format", self.format, Format)
        check("arithmetic", self.arithmetic, Arithmetic)
        _refuse_other("pixels", self.pixels, "(H, W, 4)")
        if self.pixels.ndim != 3 or self.pixels.shape[2] != CHANNELS:
            _refuse_shape("pixels", "(H, W, 4)", self.pixels)
        if self.format != "RGBA64F":
            kept = stored(self.linear(), self.format)
            if not np.array_equal(kept, self.pixels):
                expected = f"numbers that {self.format} holds"
                advice = "make it with framebuffer and clear it"
                raise ValueError(complaint("pixels", expected, "others", advice))
        if self.depth is not None:
            _refuse_other("depth", self.depth, "(H, W)")
            if self.depth.shape != self.pixels.shape[:2]:
                _refuse_shape("depth", f"{self.pixels.shape[:2]}", self.depth)
            check("depth", self.depth, Annotated[Array, Range(0.0, 1.0)])

    def linear(self) -> Array:
        """Give the pixels as light that adds: SRGB8_ALPHA8 is decoded."""
        return linear_of(self.pixels, self.format)


def linear_of(pixels: Array, format: Format) -> Array:
    """Give stored values as light that adds, unchecked; a new array where decoded."""
    if format != "SRGB8_ALPHA8":
        return pixels
    light = pixels.copy()
    light[..., :3] = srgb_decode(pixels[..., :3])
    return light


def _refuse_other(name: str, array: object, shape: str) -> None:
    if not isinstance(array, np.ndarray) or array.dtype != np.float64:
        kind = getattr(array, "dtype", type(array).__name__)
        raise TypeError(complaint(name, "an array of float64", f"{kind}"))
    if array.size == 0:
        _refuse_shape(name, shape, array)
    if not array.flags.writeable:
        raise ValueError(
            complaint(name, "a writable array", "a read-only one", "copy it")
        )


def _refuse_shape(name: str, shape: str, array: Array) -> None:
    raise ValueError(
        complaint(name, f"an array of shape {shape}", f"shape {array.shape}")
    )


@checked
def framebuffer(
    width: Size,
    height: Size,
    *,
    color: Rgba = NOTHING,
    depth: Annotated[float, Range(0.0, 1.0)] | None = None,
    format: Format = "RGBA64F",
    arithmetic: Arithmetic = "ideal",
) -> Framebuffer:
    """Make a framebuffer of one colour.

    Formula: pixel = color, as the format holds it

    Parameters
    ----------
    width, height
        Size in pixels, together at most 8.3 million pixels.
    color
        RGBA of every pixel, shape (4,).
    depth
        Depth of every pixel, in [0, 1]; None for a buffer without depth.
    format
        RGBA64F, RGBA32F, RGBA16F, RGBA8 or SRGB8_ALPHA8.
    arithmetic
        Whose rounding: "ideal", the specification's, or "llvmpipe", Mesa's.

    Returns
    -------
    The framebuffer, pixels of shape (height, width, 4).

    Raises
    ------
    ValueError
        More than 8.3 million pixels.

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
    planes[:] = stored(color, format, arithmetic=arithmetic)[:, None, None]
    depths = None if depth is None else np.full((height, width), depth)
    return Framebuffer(planes.transpose(1, 2, 0), depths, format, arithmetic)


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


def clipped(name: str, part: slice, size: int) -> slice:
    """Cut a slice off at the buffer's borders, or refuse one without ends or with step.

    Parameters
    ----------
    name
        What the refusal calls it.
    part
        A slice; a negative end lies outside, it does not count from the other side.
    size
        Rows or columns of the buffer.

    Returns
    -------
    A slice within the buffer; where nothing is left, an empty one.

    Raises
    ------
    ValueError
        An end is missing or no whole number, or there is a step.
    """
    ends = part.start, part.stop
    whole = all(isinstance(end, (int, np.integer)) for end in ends)
    if not whole or part.step not in (None, 1):
        raise ValueError(complaint(name, "a slice of step 1 with both ends", f"{part}"))
    first = min(max(int(part.start), 0), size)
    return slice(first, max(min(int(part.stop), size), first))


def refuse_other_box(name: str, patch: Array, rows: slice, columns: slice) -> None:
    """Refuse a patch whose first two axes are not those of its box.

    Parameters
    ----------
    name
        What the refusal calls it.
    patch
        Shape (h, w, ...).
    rows, columns
        The box.

    Raises
    ------
    ValueError
        They differ.
    """
    box = rows.stop - rows.start, columns.stop - columns.start
    if patch.shape[:2] != box:
        expected = f"shape {(*box, *patch.shape[2:])}, that of the box"
        raise ValueError(complaint(name, expected, f"shape {patch.shape}"))
