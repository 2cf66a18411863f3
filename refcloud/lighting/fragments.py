"""The pixels of the light's framebuffer, each with the list of balls that touch it.

A fragment is one ball at one pixel. They are stored slot after slot: first the first
ball of every pixel, then the second of all that have one, and so on, pixels with long
lists first. So one step of the recurrence of pass 1, at all pixels at once, is a few
operations on whole pieces of arrays.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.lighting.lightview import LightView
from refcloud.lighting.look import Look
from refcloud.raster.footprint import footprint_of
from refcloud.raster.splat import SOFT_EDGE

# A view with more fragments, half a gigabyte, is carried ball after ball.
MOST_FRAGMENTS = 1 << 23

# Relative room of a row's span, over what rounding may do; pixels on it weigh nothing.
ROOM = 1e-9

Whole = NDArray[np.intp]
Floats = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class Fragments:
    """Every ball at every pixel that it covers or is read from.

    Attributes
    ----------
    ball
        Number of each fragment's ball, shape (M,).
    weight
        Its footprint there, shape (M,); 0 where it is only read.
    read
        Its weight in the ball's mean, shape (M,).
    total
        Sum of these weights by ball, shape (N,), above 0.
    counts
        Fragments of each slot, from the first slot on, shape (slots,), descending.
    pixel
        Numbers of the pixels in the order of each slot, shape (counts[0],).
    """

    ball: Whole
    weight: Floats
    read: Floats
    total: Array
    counts: list[int]
    pixel: Whole


def fragments_per_ball(view: LightView) -> float:
    """Estimate how many pixels a ball covers, on the mean; no more than the buffer."""
    square = np.minimum(np.pi * np.square(view.radius), float(view.side) ** 2)
    return float(square.mean()) if len(square) else 0.0


def fragments(view: LightView, look: Look, dtype: type) -> Fragments | None:
    """List the fragments of a light's view; None where there are too many.

    Parameters
    ----------
    view
        The balls as the light sees them.
    look
        Its `footprint` and `readback`.
    dtype
        Of weights and shares, float64 or float32.

    Returns
    -------
    The fragments.
    """
    order, side = view.order, view.side
    x, y, radius = (np.asarray(a[order]) for a in (view.x, view.y, view.radius))
    soft = SOFT_EDGE if look.readback == "antialiased" else 0.0
    reach = radius + soft

    # 1. The rows of pixels of each ball's square, near to far, and on each the span
    #    that the ball covers: a chord of the disc, or the square's whole width.
    top, high = _span(y, reach, side)
    left, wide = _span(x, reach, side)
    if float(high.sum(dtype=np.float64)) > MOST_FRAGMENTS:
        return None
    ball = np.repeat(np.arange(len(order)), high)
    j = np.arange(len(ball)) - np.repeat(np.cumsum(high) - high - top, high)
    aside = (j + 0.5 - y[ball]) / radius[ball]
    aside *= aside
    first, count = left[ball], wide[ball]
    if look.readback != "square":
        far = (1.0 + soft / radius) ** 2 * (1.0 + ROOM)
        half = np.sqrt(np.maximum(far[ball] - aside, 0.0)) * radius[ball]
        begin, length = _span(x[ball], half, side)
        end = np.minimum(begin + length, first + count)
        first = np.maximum(begin, first)
        count = np.maximum(end - first, 0)
    if float(count.sum(dtype=np.float64)) > MOST_FRAGMENTS:
        return None

    # 2. One fragment for each pixel of each span: q, footprint, what the mean reads.
    before = np.cumsum(count) - count
    step = np.arange(int(count.sum()))
    pixel = step + np.repeat(j * side + first - before, count)
    q: Array = np.asarray(step + np.repeat(first - before, count), np.float64)
    q += 0.5
    q -= np.repeat(x[ball], count)
    r = np.repeat(radius[ball], count)
    q /= r
    q *= q
    q += np.repeat(aside, count)
    weight = footprint_of(q, view.balls.kernel, look.footprint)
    if look.readback == "footprint":
        read = weight
    elif look.readback == "disc":
        read = (q <= 1.0).astype(np.float64)
    elif look.readback == "square":
        read = np.ones_like(q)
    else:
        np.sqrt(q, out=q)
        q *= -r
        q += r
        q += soft
        read = np.maximum(np.minimum(q, 1.0, out=q), 0.0, out=q)
    ball = np.repeat(ball, count)
    total: Array = np.bincount(ball, read, minlength=len(order)).astype(np.float64)

    # 3. An area that holds no pixel's centre reads the nearest pixel.
    lost = np.flatnonzero(total <= 0.0)
    if len(lost):
        i, j = (
            np.minimum(np.clip(at[lost], 0.0, side).astype(np.intp), side - 1)
            for at in (x, y)
        )
        joined = np.argsort(np.concatenate([ball, lost]), kind="stable")
        pixel = np.append(pixel, j * side + i)[joined]
        ball = np.append(ball, lost)[joined]
        weight = np.append(weight, np.zeros(len(lost)))[joined]
        read = np.append(read, np.ones(len(lost)))[joined]
        total[lost] = 1.0
    by_ball = np.empty(len(order))
    by_ball[order] = total
    rows = np.stack([order[ball], weight, read], axis=1, dtype=dtype, casting="unsafe")
    moved, counts, used = _by_slots(pixel, side)
    number, weight, read = rows.take(moved, axis=0).T  # one look-up for the three
    return Fragments(
        number.astype(np.intp),
        np.ascontiguousarray(weight),
        np.ascontiguousarray(read),
        by_ball,
        counts,
        used,
    )


def _span(place: Array, reach: Array, side: int) -> tuple[Whole, Whole]:
    """Give the first pixel within reach along an axis, as `patch` does; how many."""
    low = np.ceil(np.clip(place - reach, 0.0, side) - 0.5).astype(np.intp)
    high = np.floor(np.clip(place + reach, 0.0, side) - 0.5).astype(np.intp) + 1
    return low, np.maximum(high - low, 0)


def _by_slots(pixel: Whole, side: int) -> tuple[Whole, list[int], Whole]:
    """Order fragments, which come near to far, by slot and by length of the list.

    Returns
    -------
    Where each fragment of that order comes from, how many each slot has, the pixels.
    """
    # 1. By pixel; a stable sort leaves each pixel's list near to far. numpy counts
    #    keys of 16 bits in no time: longer ones are sorted by column, then by row.
    if side * side <= 1 << 16:
        order = np.argsort(pixel.astype(np.uint16), kind="stable")
    else:
        order = np.argsort((pixel % side).astype(np.uint16), kind="stable")
        rows = (pixel // side).astype(np.uint16)[order]
        order = order[np.argsort(rows, kind="stable")]
    length = np.bincount(pixel, minlength=side * side)
    slot = np.arange(len(pixel)) - np.repeat(np.cumsum(length) - length, length)
    # 2. Pixels with long lists first: those of each slot are then the first ones.
    ranked = np.argsort(-length, kind="stable")
    rank = np.empty_like(ranked)
    rank[ranked] = np.arange(len(ranked))
    counts = np.bincount(slot)
    place = (np.cumsum(counts) - counts)[slot] + np.repeat(rank, length)
    moved = np.empty_like(order)
    moved[place] = order
    used = ranked[: int(counts[0]) if len(counts) else 0]
    return moved, counts.tolist(), used
