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
        Its footprint there, shape (M,), or (M, S) where S pixels go together, as in
        `light_tiles`; 0 where it is only read.
    read
        Its weight in the ball's mean, that shape.
    total
        Sum of these weights by ball, shape (N,), above 0.
    counts
        Fragments of each slot, from the first slot on, shape (slots,), descending.
    pixel
        Numbers of the pixels in the order of each slot, shape (counts[0],), or
        (counts[0], S); the buffer's side squared for pixels outside it.
    roundings
        What they do to a mean of light 1 at most, in eps.
    """

    ball: Whole
    weight: Floats
    read: Floats
    total: Array
    counts: list[int]
    pixel: Whole
    roundings: float

    def spread(self, per_ball: Floats) -> Floats:
        """Give each fragment its ball's number: shape (M,), or (M, 1)."""
        return per_ball.take(self.ball).reshape(-1, *(1,) * (self.weight.ndim - 1))

    @property
    def rough(self) -> float:
        """Bound what rounding does to a mean, of light 1."""
        return float(np.finfo(self.weight.dtype).eps) * self.roundings


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
    #    Spans are sorted already here, row after row: there are fewer than fragments.
    sorted_ = np.argsort(j.astype(np.uint16), kind="stable")  # counted: short keys
    ball, j = ball[sorted_], j[sorted_]
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
    many = int(count.sum(dtype=np.float64))
    if many > MOST_FRAGMENTS:
        return None

    # 2. One fragment for each pixel of each span: q, footprint, what the mean reads.
    shift = first - (np.cumsum(count) - count)
    column = np.arange(many) + np.repeat(shift, count)
    q: Array = np.asarray(column, np.float64) + 0.5
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
    row, number = np.repeat(j, count), np.repeat(order[ball], count)
    total: Array = np.bincount(number, read, minlength=len(order)).astype(np.float64)

    # 3. An area that holds no pixel's centre reads the nearest pixel.
    lost = np.flatnonzero(total[order] <= 0.0)
    if len(lost):
        i, j = (
            np.minimum(np.clip(at[lost], 0.0, side).astype(np.intp), side - 1)
            for at in (x, y)
        )
        near = np.concatenate([np.repeat(ball, count), lost])
        row = np.append(row, j)
        joined = np.lexsort((near, row))
        row, number = row[joined], order[near[joined]]
        column = np.append(column, i)[joined]
        weight = np.append(weight, np.zeros(len(lost)))[joined]
        read = np.append(read, np.ones(len(lost)))[joined]
        total[order[lost]] = 1.0

    # 4. Slot after slot. What is looked up is made short first.
    moved, counts, used = _by_slots(row, column, side)
    weight = weight.astype(dtype)
    shown = weight.take(moved)
    return Fragments(
        number.astype(np.int32).take(moved).astype(np.intp),
        shown,
        shown
        if look.readback == "footprint" and not len(lost)
        else read.astype(dtype).take(moved),
        total,
        counts,
        used,
        len(counts) + 8.0,
    )


def _span(place: Array, reach: Array, side: int) -> tuple[Whole, Whole]:
    """Give the first pixel within reach along an axis, as `patch` does; how many."""
    low = np.ceil(np.clip(place - reach, 0.0, side) - 0.5).astype(np.intp)
    high = np.floor(np.clip(place + reach, 0.0, side) - 0.5).astype(np.intp) + 1
    return low, np.maximum(high - low, 0)


def _by_slots(row: Whole, column: Whole, side: int) -> tuple[Whole, list[int], Whole]:
    """Order fragments by slot and by length of the list.

    They come row after row, near to far in each.

    Returns
    -------
    Where each fragment of that order comes from, how many each slot has, the pixels.
    """
    # 1. By column, then row; a stable sort leaves each pixel's list near to far. numpy
    #    counts keys of 8 bits in one go, of 16 in two: others take many.
    short = column.astype(np.uint8 if side <= 1 << 8 else np.uint16)
    order = np.argsort(short, kind="stable")
    length = np.bincount(column * side + row, minlength=side * side)
    # 2. Pixels with long lists first: those of each slot are then the first ones.
    ranked, counts, place = slot_after_slot(length)
    used = ranked[: counts[0] if counts else 0]
    return order.take(place), counts, used % side * side + used // side


def slot_after_slot(length: Whole) -> tuple[Whole, list[int], Whole]:
    """Order lists by length, and their entries slot after slot.

    Parameters
    ----------
    length
        Of each list, shape (L,); they lie one after the other.

    Returns
    -------
    The lists, the longest first; how many have each slot; where each slot's entries
    are, in that order.
    """
    longest = int(length.max(initial=0))
    short = (longest - length).astype(np.uint16 if longest < 1 << 16 else np.intp)
    ranked = np.argsort(short, kind="stable")
    begin = (np.cumsum(length) - length)[ranked]
    shorter = np.bincount(length, minlength=longest + 1).cumsum()
    counts = (len(length) - shorter[:longest]).tolist()
    place = np.empty(sum(counts), np.intp)
    end = 0
    for slot, count in enumerate(counts):
        np.add(begin[:count], slot, out=place[end : end + count])
        end += count
    return ranked, counts, place
