"""Which fragments reach the framebuffer, in layers without two of one pixel.

OpenGL works fragment after fragment, in the order of the triangles. What is blended has
to be taken in that order, layer by layer. What hides all that was there needs only its
last fragment, or the nearest one, and the others are never shaded.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.raster.fragments import State
from refcloud.raster.framebuffer import Framebuffer

Indices = NDArray[np.int64]


def layers(
    buffer: Framebuffer, state: State, pixel: Indices, depth: Array
) -> Iterator[Indices]:
    """Sort out fragments.

    Parameters
    ----------
    buffer
        What they are drawn over.
    state
        The operations that are on.
    pixel
        Row times width plus column of each, in drawing order, shape (n,).
    depth
        Of each, shape (n,).

    Yields
    ------
    Indices of fragments, no two of one pixel, in an order that gives the same as one
    fragment after the other.
    """
    every = np.arange(len(pixel))
    tested = state.depth_func is not None and buffer.depth is not None
    size = buffer.pixels.shape[0] * buffer.pixels.shape[1]
    last = np.empty(size, np.int64)
    if state.blending is None and not tested:
        # Each hides what was there before: the last one shows.
        last[pixel] = every
        yield np.flatnonzero(last[pixel] == every)
    elif (
        state.blending is None
        and state.depth_func in ("LESS", "LEQUAL")
        and state.depth_mask
    ):
        yield _nearest(buffer, state, pixel, depth, last)
    else:
        yield from _in_turn(pixel, last)


def _nearest(
    buffer: Framebuffer, state: State, pixel: Indices, depth: Array, last: Indices
) -> Indices:
    """Find the nearest fragment of each pixel: of equal ones LESS shows the first."""
    assert buffer.depth is not None
    nearest = buffer.depth.ravel().copy()
    np.minimum.at(nearest, pixel, depth)
    seen = np.flatnonzero(depth == nearest[pixel])
    order = seen[::-1] if state.depth_func == "LESS" else seen
    last[pixel[order]] = order
    return seen[last[pixel[seen]] == seen]


def _in_turn(pixel: Indices, last: Indices) -> Iterator[Indices]:
    """Deal fragments out: the first of each pixel, then the second, and so on."""
    every = np.arange(len(pixel))
    last[pixel] = every
    if (last[pixel] == every).all():
        yield every
        return
    # A fragment's turn is its place among those of its pixel.
    order = np.argsort(pixel, kind="stable")
    ordered = pixel[order]
    begins = np.concatenate([[True], ordered[1:] != ordered[:-1]])
    begin = np.maximum.accumulate(np.where(begins, every, 0))
    turn = np.empty_like(every)
    turn[order] = every - begin
    by_turn = np.argsort(turn, kind="stable")
    yield from np.split(by_turn, np.cumsum(np.bincount(turn))[:-1])
