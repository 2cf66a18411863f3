"""Blending: how a new colour and the framebuffer's own make one (paper M, eq 28).

``blend_patch`` is the unchecked inner form for loops over thousands of patches in
float64; `blend` checks, and rounds as the framebuffer's format has it.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Shape
from refcloud.raster.factors import (
    Blending,
    Equation,
    Factor,
    Numbers,
    by_channel,
    by_rule,
)
from refcloud.raster.formats import (
    FIXED_POINT,
    LARGEST_32,
    Arithmetic,
    Format,
    stored,
)
from refcloud.raster.framebuffer import (
    NOTHING,
    Framebuffer,
    Rgba,
    linear_of,
    refuse_other_box,
    within,
)
from refcloud.raster.llvmpipe import blended_llvmpipe


@checked
def blend(
    buffer: Framebuffer,
    rows: slice,
    columns: slice,
    source: Annotated[Array, Shape("h", "w", 4)],
    src_factor: Factor,
    dst_factor: Factor,
    *,
    src_alpha: Factor | None = None,
    dst_alpha: Factor | None = None,
    equation: Equation = "FUNC_ADD",
    equation_alpha: Equation | None = None,
    constant: Rgba = NOTHING,
) -> None:
    """Blend a patch of colours into the framebuffer.

    Formula: c = f_src c_src + f_dst c_dst (FUNC_ADD), rounded as the format has it

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
    src_alpha, dst_alpha
        Those of the alpha channel (glBlendFuncSeparate); None for the same.
    equation
        How the two products make one; MIN and MAX leave the factors out.
    equation_alpha
        That of the alpha channel (glBlendEquationSeparate); None for the same.
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
    refuse_other_box("source", source, rows, columns)
    blending = Blending(
        src_factor,
        dst_factor,
        src_alpha,
        dst_alpha,
        equation,
        equation_alpha,
        constant,
    )
    destination = buffer.pixels[rows, columns]
    destination[:] = blended_as(
        source, destination, blending, buffer.format, buffer.arithmetic
    )


def blended_as(
    source: Array,
    destination: Array,
    blending: Blending,
    format: Format,
    arithmetic: Arithmetic = "ideal",
) -> Array:
    """Give what a framebuffer of a format holds after a blend, unchecked.

    Parameters
    ----------
    source
        New colours, linear RGBA, shape (..., 4).
    destination
        What the framebuffer holds, the same shape.
    blending
        Factors, equations and constant.
    format, arithmetic
        Of the framebuffer.

    Returns
    -------
    Shape (..., 4), a new array.
    """
    if arithmetic == "llvmpipe" and format != "RGBA64F":
        return blended_llvmpipe(source, destination, blending, format)
    s, d, c = source, linear_of(destination, format), blending.constant
    # A float format clamps nothing, except that a colour is a float32; the others clamp
    # all that goes in.
    if format in FIXED_POINT:
        s, c = np.clip(s, 0.0, 1.0), np.clip(c, 0.0, 1.0)
    elif format != "RGBA64F":
        s, c = (np.clip(a, -LARGEST_32, LARGEST_32) for a in (s, c))
    return stored(by_channel(by_rule, s, d, c, blending), format)


def blend_patch(
    destination: Array,
    source: Array,
    src_factor: str = "ONE",
    dst_factor: str = "ONE_MINUS_SRC_ALPHA",
    equation: str = "FUNC_ADD",
    constant: Array = NOTHING,
) -> None:
    """Blend in float64 without a check: the inner form of `blend`.

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
    source: Numbers,
    destination: Numbers,
    src_factor: str,
    dst_factor: str,
    equation: str,
    constant: Array = NOTHING,
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
    rule = src_factor, dst_factor, equation
    return by_rule(source, destination, constant, rule)
