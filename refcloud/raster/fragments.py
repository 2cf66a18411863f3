"""What happens to fragments on their way into the framebuffer, step by step.

Scissor, depth test, blending, rounding, colour mask: OpenGL's per-fragment operations
in OpenGL's order. `clear` takes the same state, of which it honours scissor and masks.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Range, Shape
from refcloud.raster.formats import stored
from refcloud.raster.framebuffer import (
    Framebuffer,
    Rgba,
    clipped,
    refuse_other_box,
    within,
)
from refcloud.raster.store import State, stored_in, write, written

PLAIN = State()
DepthOf = (
    Annotated[float, Range(0.0, 1.0)]
    | Annotated[Array, Shape("h", "w"), Range(0.0, 1.0)]
)


@checked
def draw_fragments(
    buffer: Framebuffer,
    rows: slice,
    columns: slice,
    source: Annotated[Array, Shape("h", "w", 4)],
    *,
    depth: DepthOf = 0.0,
    state: State = PLAIN,
) -> None:
    """Send a patch of fragments into the framebuffer.

    Formula: where the scissor lets by and the depth passes, pixel = blend(source,
    pixel), rounded, in the channels of the colour mask

    Parameters
    ----------
    buffer
        The framebuffer, written in place.
    rows, columns
        The box that the patch fills, as slices within the buffer.
    source
        Colours of the fragments, linear RGBA, shape (h, w, 4).
    depth
        Their depths, one number or shape (h, w), in [0, 1].
    state
        The operations that are on.

    Returns
    -------
    Nothing.

    Raises
    ------
    ValueError
        The box leaves the buffer, or the patch has another size than the box.

    Source: OpenGL 4.6, section 17.3; F02.

    Examples
    --------
    >>> from refcloud.raster import framebuffer
    >>> buffer = framebuffer(1, 1, depth=0.5)
    >>> state = State(depth_func="LESS", color_mask=(True, False, False, True))
    >>> draw_fragments(buffer, slice(1), slice(1), [[[1, 1, 1, 1]]], state=state)
    >>> buffer.pixels[0, 0], buffer.depth[0, 0]
    (array([1., 0., 0., 1.]), np.float64(0.0))
    """
    height, width, _ = buffer.pixels.shape
    rows, columns = within("rows", rows, height), within("columns", columns, width)
    refuse_other_box("source", source, rows, columns)
    depths = np.broadcast_to(depth, source.shape[:2])
    refuse_other_box("depth", depths, rows, columns)

    # 1. Scissor: what lies outside of it is never drawn.
    box = scissored(state, rows, columns, height, width)
    inner = tuple(
        slice(part.start - whole.start, part.stop - whole.start)
        for part, whole in zip(box, (rows, columns), strict=True)
    )
    source, depths = source[inner], depths[inner]

    write(stored_in(buffer), box, source, depths, state)


@checked
def clear(
    buffer: Framebuffer,
    color: Rgba | None,
    *,
    depth: Annotated[float, Range(0.0, 1.0)] | None = None,
    state: State = PLAIN,
) -> None:
    """Set every pixel to one colour, and every depth to one number.

    Formula: pixel = color, as the format holds it

    Parameters
    ----------
    buffer
        The framebuffer, written in place.
    color
        Linear RGBA, shape (4,); None leaves the colours as they are.
    depth
        In [0, 1]; None leaves the depths as they are. A buffer without depth has none
        to clear.
    state
        Its scissor and its masks are honoured; blending and depth test do not count.

    Returns
    -------
    Nothing.

    Source: paper M, section 4.1, first step; F01 (glClearColor, glClearDepth, glClear).

    Examples
    --------
    >>> from refcloud.raster import framebuffer
    >>> buffer = framebuffer(2, 1)
    >>> clear(buffer, [1, 1, 1, 0])
    >>> buffer.pixels[0, 1]
    array([1., 1., 1., 0.])
    """
    height, width, _ = buffer.pixels.shape
    box = scissored(state, slice(0, height), slice(0, width), height, width)
    if color is not None:
        kept = stored(color, buffer.format, arithmetic=buffer.arithmetic)
        for channel in written(state):
            buffer.pixels[(*box, channel)] = kept[channel]
    if depth is not None and buffer.depth is not None and state.depth_mask:
        buffer.depth[box] = depth


def scissored(
    state: State, rows: slice, columns: slice, height: int, width: int
) -> tuple[slice, slice]:
    """Give the part of a box that the scissor lets by, unchecked.

    Parameters
    ----------
    state
        Its scissor may leave the buffer.
    rows, columns
        The box.
    height, width
        Of the buffer.

    Returns
    -------
    Rows and columns; they may be empty.
    """
    if state.scissor is None:
        return rows, columns
    down, across = state.scissor
    return (
        _common(rows, clipped("scissor", down, height)),
        _common(columns, clipped("scissor", across, width)),
    )


def _common(one: slice, other: slice) -> slice:
    """Give what two slices share; an empty one where that is nothing."""
    first = max(one.start, other.start)
    return slice(first, max(first, min(one.stop, other.stop)))
