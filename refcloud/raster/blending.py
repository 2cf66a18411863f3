"""Blending: how a new colour and the framebuffer's own make one (paper M, eq 28).

One rule per factor and one per equation, under OpenGL's names. ``blend_patch`` is the
unchecked inner form for loops over thousands of patches; `blend` checks and calls it.

The four dual-source factors of glBlendFunc (SRC1_...) need a second colour from a
shader; there is none here, so they are refused by name.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import checked, complaint
from refcloud.conventions import Array, Shape
from refcloud.raster.framebuffer import NOTHING, Framebuffer, Rgba, within

Factor = Literal[
    "ZERO",
    "ONE",
    "SRC_COLOR",
    "ONE_MINUS_SRC_COLOR",
    "DST_COLOR",
    "ONE_MINUS_DST_COLOR",
    "SRC_ALPHA",
    "ONE_MINUS_SRC_ALPHA",
    "DST_ALPHA",
    "ONE_MINUS_DST_ALPHA",
    "CONSTANT_COLOR",
    "ONE_MINUS_CONSTANT_COLOR",
    "CONSTANT_ALPHA",
    "ONE_MINUS_CONSTANT_ALPHA",
    "SRC_ALPHA_SATURATE",
]
Equation = Literal["FUNC_ADD", "FUNC_SUBTRACT", "FUNC_REVERSE_SUBTRACT", "MIN", "MAX"]


def _saturate(source: Array, destination: Array, constant: Array) -> Array:
    """Let colour in only as far as the buffer's alpha leaves room; alpha whole."""
    room = np.minimum(source[..., 3:], 1.0 - destination[..., 3:])
    return np.concatenate([room, room, room, np.ones_like(room)], axis=-1)


# Factor of (source, destination, constant); a last axis of 1 is the same on RGBA.
FACTORS: dict[str, Callable[[Array, Array, Array], Array]] = {
    "ZERO": lambda s, d, c: np.zeros(1),
    "ONE": lambda s, d, c: np.ones(1),
    "SRC_COLOR": lambda s, d, c: s,
    "ONE_MINUS_SRC_COLOR": lambda s, d, c: 1.0 - s,
    "DST_COLOR": lambda s, d, c: d,
    "ONE_MINUS_DST_COLOR": lambda s, d, c: 1.0 - d,
    "SRC_ALPHA": lambda s, d, c: s[..., 3:],
    "ONE_MINUS_SRC_ALPHA": lambda s, d, c: 1.0 - s[..., 3:],
    "DST_ALPHA": lambda s, d, c: d[..., 3:],
    "ONE_MINUS_DST_ALPHA": lambda s, d, c: 1.0 - d[..., 3:],
    "CONSTANT_COLOR": lambda s, d, c: c,
    "ONE_MINUS_CONSTANT_COLOR": lambda s, d, c: 1.0 - c,
    "CONSTANT_ALPHA": lambda s, d, c: c[3:],
    "ONE_MINUS_CONSTANT_ALPHA": lambda s, d, c: 1.0 - c[3:],
    "SRC_ALPHA_SATURATE": _saturate,
}

# Result of (source, destination, source factor, destination factor).
EQUATIONS: dict[str, Callable[[Array, Array, Array, Array], Array]] = {
    "FUNC_ADD": lambda s, d, fs, fd: s * fs + d * fd,
    "FUNC_SUBTRACT": lambda s, d, fs, fd: s * fs - d * fd,
    "FUNC_REVERSE_SUBTRACT": lambda s, d, fs, fd: d * fd - s * fs,
    "MIN": lambda s, d, fs, fd: np.minimum(s, d),  # the factors do not count
    "MAX": lambda s, d, fs, fd: np.maximum(s, d),
}


@checked
def blend(
    buffer: Framebuffer,
    rows: slice,
    columns: slice,
    source: Annotated[Array, Shape("h", "w", 4)],
    src_factor: Factor,
    dst_factor: Factor,
    *,
    equation: Equation = "FUNC_ADD",
    constant: Rgba = NOTHING,
) -> None:
    """Blend a patch of colours into the framebuffer.

    Formula: c = f_src c_src + f_dst c_dst (FUNC_ADD; nothing is clamped)

    Parameters
    ----------
    buffer
        The framebuffer, written in place.
    rows, columns
        The box that the patch fills, as slices within the buffer.
    source
        New colours, RGBA, shape (h, w, 4).
    src_factor, dst_factor
        Factors of the new colour and of the buffer's, under OpenGL's names.
    equation
        How the two products make one; MIN and MAX leave the factors out.
    constant
        RGBA of the CONSTANT factors, shape (4,).

    Returns
    -------
    Nothing.

    Raises
    ------
    ValueError
        The box leaves the buffer, or the patch has another size than the box.

    Source: paper M, eq 28; F02, L09 (glBlendFunc, glBlendEquation, glBlendColor).

    Examples
    --------
    >>> from refcloud.raster import framebuffer
    >>> buffer, half = framebuffer(1, 1, color=[1, 1, 1, 1]), [[[0.2, 0, 0, 0.5]]]
    >>> blend(buffer, slice(0, 1), slice(0, 1), half, "ONE", "ONE_MINUS_SRC_ALPHA")
    >>> buffer.pixels[0, 0]
    array([0.7, 0.5, 0.5, 1. ])
    """
    height, width, _ = buffer.pixels.shape
    rows, columns = within("rows", rows, height), within("columns", columns, width)
    box = rows.stop - rows.start, columns.stop - columns.start
    if source.shape[:2] != box:
        expected = f"shape {(*box, 4)}, that of the box"
        raise ValueError(complaint("source", expected, f"shape {source.shape}"))
    destination = buffer.pixels[rows, columns]
    blend_patch(destination, source, src_factor, dst_factor, equation, constant)


def blend_patch(
    destination: Array,
    source: Array,
    src_factor: str = "ONE",
    dst_factor: str = "ONE_MINUS_SRC_ALPHA",
    equation: str = "FUNC_ADD",
    constant: Array = NOTHING,
) -> None:
    """Blend without a check: the inner form of `blend`.

    Parameters
    ----------
    destination
        A view of the framebuffer, shape (h, w, 4), written in place.
    source
        RGBA of the same shape; it may be another part of the same framebuffer, since
        all is read before anything is written.
    src_factor, dst_factor, equation, constant
        As `blend`.
    """
    if (src_factor, dst_factor, equation) == (
        "ONE",
        "ONE_MINUS_SRC_ALPHA",
        "FUNC_ADD",
    ):  # the pair of every splat: the same sums and products, fewer of them
        covered = destination * (1.0 - source[..., 3:])
        covered += source
        destination[:] = covered
        return
    destination[:] = blended(
        source, destination, src_factor, dst_factor, equation, constant
    )


def blended(
    source: Array,
    destination: Array,
    src_factor: str,
    dst_factor: str,
    equation: str,
    constant: Array,
) -> Array:
    """Give the blend of two arrays of colours by the general rule, unchecked.

    Parameters
    ----------
    source, destination
        RGBA, shape (..., 4).
    src_factor, dst_factor, equation, constant
        As `blend`.

    Returns
    -------
    RGBA, shape (..., 4).
    """
    f_src = FACTORS[src_factor](source, destination, constant)
    f_dst = FACTORS[dst_factor](source, destination, constant)
    return EQUATIONS[equation](source, destination, f_src, f_dst)
