"""A framebuffer on OpenGL: made, written and read back.

OpenGL's row 0 is at the bottom, ours at the top: rows are turned over where pixels go
in and out, in this file, and in the boxes that it turns.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from refcloud.checking import complaint
from refcloud.conventions import Array
from refcloud.gl.opengl import context, refuse_errors, refuse_large_side
from refcloud.gl.state import SRGB8_ALPHA8
from refcloud.raster.formats import WHITE, Format
from refcloud.raster.framebuffer import CHANNELS, clipped, within

# moderngl's name of a format, and numpy's of what goes in and out.
DTYPES: dict[str, tuple[str, str]] = {
    "RGBA32F": ("f4", "f4"),
    "RGBA16F": ("f2", "f2"),
    "RGBA8": ("f1", "u1"),
    "SRGB8_ALPHA8": ("f1", "u1"),
}


@dataclass(frozen=True, eq=False)
class Target:
    """A framebuffer that OpenGL draws into.

    Attributes
    ----------
    width, height
        Size in pixels.
    formats
        One for each attachment: all of them get the same fragments.
    fbo
        The moderngl.Framebuffer.
    """

    width: int
    height: int
    formats: tuple[Format, ...]
    fbo: Any

    def box(self, rows: slice, columns: slice) -> tuple[int, int, int, int]:
        """Turn a box over: left, bottom, width and height as OpenGL counts them."""
        across, down = columns.stop - columns.start, rows.stop - rows.start
        return columns.start, self.height - rows.stop, across, down


def framebuffer(
    width: int, height: int, *formats: Format, depth: bool = False
) -> Target:
    """Make a framebuffer.

    Parameters
    ----------
    width, height
        Size in pixels.
    formats
        One for each attachment; RGBA32F where none is given.
    depth
        Whether it has a depth buffer, of 24 bits.

    Returns
    -------
    The framebuffer; nothing is cleared.

    Raises
    ------
    ValueError
        This OpenGL cannot hold it, or it has no such format.
    """
    refuse_large_side(width, height)
    ctx, textures = context(), []
    for format in formats or ("RGBA32F",):
        if format not in DTYPES:
            known = ", ".join(DTYPES)
            raise ValueError(complaint("format", f"one of {known}", f"{format!r}"))
        more = {"internal_format": SRGB8_ALPHA8} if format == "SRGB8_ALPHA8" else {}
        textures.append(
            ctx.texture((width, height), CHANNELS, dtype=DTYPES[format][0], **more)
        )
    depths = ctx.depth_renderbuffer((width, height)) if depth else None
    fbo = ctx.framebuffer(textures, depths)
    refuse_errors("making a framebuffer")
    return Target(width, height, formats or ("RGBA32F",), fbo)


def write_pixels(target: Target, pixels: Array, attachment: int = 0) -> None:
    """Write every pixel as it is stored, unblended.

    Parameters
    ----------
    target
        The framebuffer.
    pixels
        Shape (H, W, 4) of what the format holds, as `refcloud.raster.Framebuffer`.
    attachment
        Which of its formats.
    """
    format = target.formats[attachment]
    codes = pixels * WHITE if DTYPES[format][1] == "u1" else pixels
    data = np.rint(codes) if DTYPES[format][1] == "u1" else codes
    flipped = np.ascontiguousarray(data[::-1], dtype=DTYPES[format][1])
    target.fbo.color_attachments[attachment].write(flipped.tobytes(), alignment=1)


def read_pixels(
    target: Target, rows: slice, columns: slice, attachment: int = 0
) -> Array:
    """Read a box of pixels back; twin of `refcloud.raster.read_pixels`.

    Parameters
    ----------
    target
        The framebuffer.
    rows, columns
        The box, as slices with step 1 that lie within the buffer.
    attachment
        Which of its formats.

    Returns
    -------
    Shape (h, w, 4), float64.

    Raises
    ------
    ValueError
        The box leaves the buffer or skips pixels.
    """
    rows, columns = (
        within("rows", rows, target.height),
        within("columns", columns, target.width),
    )
    shape = rows.stop - rows.start, columns.stop - columns.start, CHANNELS
    if 0 in shape:
        return np.zeros(shape)
    name, dtype = DTYPES[target.formats[attachment]]
    data = target.fbo.read(
        viewport=target.box(rows, columns),
        components=CHANNELS,
        attachment=attachment,
        dtype=name,
        alignment=1,
    )
    pixels = np.frombuffer(data, dtype).reshape(shape)[::-1].astype(np.float64)
    return pixels / WHITE if dtype == "u1" else pixels


def read_average(
    target: Target, rows: slice, columns: slice, attachment: int = 0
) -> Array | None:
    """Read a box back and average it; twin of `refcloud.raster.read_average`.

    Parameters
    ----------
    target
        The framebuffer.
    rows, columns
        The box, as slices with both ends; what lies outside is not counted (E27).
    attachment
        Which of its formats.

    Returns
    -------
    Mean RGBA, shape (4,), summed in float64; None where the box is empty.
    """
    rows, columns = (
        clipped("rows", rows, target.height),
        clipped("columns", columns, target.width),
    )
    read = read_pixels(target, rows, columns, attachment)
    return read.mean(axis=(0, 1)) if read.size else None


def read_depth(target: Target) -> Array:
    """Read every depth back.

    Parameters
    ----------
    target
        A framebuffer with depth.

    Returns
    -------
    Shape (H, W), in [0, 1].
    """
    data = target.fbo.read(components=1, attachment=-1, dtype="f4", alignment=1)
    depths = np.frombuffer(data, "f4").reshape(target.height, target.width)
    return depths[::-1].astype(np.float64)
