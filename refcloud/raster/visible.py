"""Which fragments reach the framebuffer, in layers without two of one pixel.

OpenGL works fragment after fragment, in the order of the triangles. What is blended has
to be taken in that order, layer by layer. What hides all that was there needs only its
last fragment, or the nearest one, and the others are never shaded.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.raster.store import DEPTH_FUNCS, State, Store

Indices = NDArray[np.int64]
Some = Indices | slice  # of a list of fragments; a slice is free


def layers(
    store: Store,
    states: tuple[State, State],
    pixel: Some,
    depth: Callable[[], Array],
    scratch: Indices,
    *,
    alone: bool = False,
) -> Iterator[tuple[Some, State]]:
    """Sort out fragments, and note depths where no more needs to be known of them.

    Parameters
    ----------
    store
        What they are drawn over.
    states
        The operations that are on, and the same without a depth test.
    pixel
        Row times width plus column of each, in drawing order, shape (n,); a slice only
        where none shares its pixel.
    depth
        Gives the depth of each, shape (n,), where it is asked.
    scratch
        One whole number for each pixel of the framebuffer, whatever it is.
    alone
        Whether it is known that none shares its pixel.

    Yields
    ------
    Fragments, no two of one pixel, and which operations they still have to go through:
    done one after the other, that gives the same as one fragment after the other.
    """
    state, tested = states
    tests = state.depth_func is not None and store.depth is not None
    if alone:
        if tests:
            yield _passing(store, state, pixel, depth()), tested
        elif isinstance(pixel, slice):
            yield slice(0, pixel.stop - pixel.start), state
        else:
            yield slice(0, len(pixel)), state
        return
    assert not isinstance(pixel, slice)
    opaque = state.blending is None
    if opaque and not tests:
        # Each hides what was there before: the last one shows.
        last = _last(pixel, np.arange(len(pixel)), scratch)
        yield _all(last, len(pixel)), state
    elif opaque and state.depth_func in ("LESS", "LEQUAL") and state.depth_mask:
        seen = _nearest(store, state, pixel, depth(), scratch)
        yield seen, tested
    else:
        for layer in _in_turn(pixel, scratch):
            yield layer, state


def _passing(store: Store, state: State, pixel: Some, depth: Array) -> Some:
    """Test the depths of fragments that have their pixels for themselves."""
    assert store.depth is not None
    assert state.depth_func is not None
    passed = DEPTH_FUNCS[state.depth_func](depth, store.depth[pixel])
    seen = slice(0, len(depth)) if passed.all() else np.flatnonzero(passed)
    if state.depth_mask:
        store.depth[places(pixel, seen)] = depth[seen]
    return seen


def _last(pixel: Indices, order: Indices, scratch: Indices) -> Indices:
    """Keep of some fragments the last one of each pixel, in the order given."""
    at = pixel.take(order)
    scratch[at] = order
    last = scratch.take(at) == order
    return order if last.all() else order[last]


def _nearest(
    store: Store, state: State, pixel: Indices, depth: Array, scratch: Indices
) -> Some:
    """Find the nearest fragment of each pixel: of equal ones LESS shows the first."""
    assert store.depth is not None
    before = store.depth.take(pixel)
    np.minimum.at(store.depth, pixel, depth)
    shows = depth == store.depth.take(pixel)
    if state.depth_func == "LESS":
        shows &= depth < before
    seen = np.flatnonzero(shows)
    if state.depth_func == "LESS":
        return _all(_last(pixel, seen[::-1], scratch)[::-1], len(pixel))
    return _all(_last(pixel, seen, scratch), len(pixel))


def _all(seen: Indices, count: int) -> Some:
    """Give all fragments as a slice, which is free; some as they are."""
    return seen if len(seen) < count else slice(0, count)


def _in_turn(pixel: Indices, scratch: Indices) -> Iterator[Some]:
    """Deal fragments out: the first of each pixel, then the second, and so on."""
    every = np.arange(len(pixel))
    if len(_last(pixel, every, scratch)) == len(pixel):
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


def places(pixel: Some, some: Some) -> Some:
    """Give the pixels of some fragments, as a slice where both are one."""
    if not isinstance(pixel, slice):
        return pixel[some]
    if isinstance(some, slice):
        return slice(pixel.start + some.start, pixel.start + some.stop)
    return some + pixel.start


def pieces(some: Some, most: int) -> Iterator[Some]:
    """Split a layer so that each part has at most so many fragments."""
    if isinstance(some, slice):
        for start in range(some.start, some.stop, most):
            yield slice(start, min(start + most, some.stop))
    else:
        for start in range(0, len(some), most):
            yield some[start : start + most]
