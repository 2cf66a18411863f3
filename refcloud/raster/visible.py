"""Which fragments reach the framebuffer, in layers without two of one pixel.

OpenGL works fragment after fragment, in the order of the triangles. What is blended has
to be taken in that order, layer by layer. What hides all that was there needs only its
last fragment, or the nearest one, and the others are never shaded.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.raster.store import State, Store
from refcloud.raster.varying import Fragments

Indices = NDArray[np.int64]
Some = Indices | slice  # of a list of fragments; a slice is free


def layers(
    store: Store, state: State, pixel: Indices, fragments: Fragments
) -> Iterator[tuple[Some, State]]:
    """Sort out fragments, and note depths where no more needs to be known of them.

    Parameters
    ----------
    store
        What they are drawn over.
    state
        The operations that are on.
    pixel
        Row times width plus column of each, in drawing order, shape (n,).
    fragments
        The fragments.

    Yields
    ------
    Fragments, no two of one pixel, and which operations they still have to go through:
    done one after the other, that gives the same as one fragment after the other.
    """
    opaque = state.blending is None
    if opaque and (state.depth_func is None or store.depth is None):
        # Each hides what was there before: the last one shows.
        yield _last(pixel, np.arange(len(pixel)), len(store.pixels)), state
    elif opaque and state.depth_func in ("LESS", "LEQUAL") and state.depth_mask:
        seen = _nearest(store, state, pixel, fragments.depth)
        yield seen, dataclasses.replace(state, depth_func=None)
    else:
        for layer in _in_turn(pixel, len(store.pixels)):
            yield layer, state


def _last(pixel: Indices, order: Indices, size: int) -> Some:
    """Keep of some fragments the last one of each pixel, in the order given."""
    last = np.empty(size, np.intp)
    last[pixel[order]] = order
    kept = np.flatnonzero(last[pixel] == np.arange(len(pixel)))
    return kept if len(kept) < len(pixel) else slice(0, len(pixel))


def _nearest(store: Store, state: State, pixel: Indices, depth: Array) -> Some:
    """Find the nearest fragment of each pixel: of equal ones LESS shows the first."""
    assert store.depth is not None
    before = store.depth.copy()
    np.minimum.at(store.depth, pixel, depth)
    seen = np.flatnonzero(depth == store.depth.take(pixel))
    if len(seen) > np.count_nonzero(store.depth < before):  # equal depths, or old ones
        if state.depth_func == "LESS":
            seen = seen[depth[seen] < before[pixel[seen]]]
        order = seen[::-1] if state.depth_func == "LESS" else seen
        seen = np.sort(order[_last(pixel[order], np.arange(len(order)), len(before))])
    return seen if len(seen) < len(pixel) else slice(0, len(pixel))


def _in_turn(pixel: Indices, size: int) -> Iterator[Some]:
    """Deal fragments out: the first of each pixel, then the second, and so on."""
    every = np.arange(len(pixel))
    if isinstance(_last(pixel, every, size), slice):
        yield slice(0, len(pixel))
        return
    # A fragment's turn is its place among those of its pixel.
    order = np.argsort(pixel, kind="stable")
    ordered = pixel[order]
    begins = np.concatenate([[True], ordered[1:] != ordered[:-1]])
    turn = np.empty_like(every)
    turn[order] = every - np.maximum.accumulate(np.where(begins, every, 0))
    by_turn = np.argsort(turn, kind="stable")
    yield from np.split(by_turn, np.cumsum(np.bincount(turn))[:-1])


def pieces(some: Some, most: int) -> Iterator[Some]:
    """Split a layer so that each part has at most so many fragments."""
    if isinstance(some, slice):
        for start in range(some.start, some.stop, most):
            yield slice(start, min(start + most, some.stop))
    else:
        for start in range(0, len(some), most):
            yield some[start : start + most]
