"""All splats of a picture at once, tile by tile: the sums of `splat`, fast.

The literal loop blends ball after ball, far to near: c = s (1 - T) + T c. Written from
the front, with F_k the light that passes all balls nearer than ball k,

    F_k = T_0 T_1 ... T_{k-1},    c = sum_k s_k (F_k - F_{k+1}) + F_end background

so that a tile needs no order of blending, only running sums of log T over its list.
`composite` works on many tiles and a few balls of each at a time, in arrays that stay
in the processor's cache. Two products of small matrices do most of the work: footprints
(`quadratics`), and, summing by parts, colours:

    c = s_0 + sum_k (s_k - s_{k-1}) F_k - s_end F_end

Every product is smaller than 2^18, from where OpenBLAS may use more threads: the same
bits whatever their number.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.raster.footprint import Law, Name
from refcloud.raster.quadratics import FORMS, Floats, Quadratics
from refcloud.raster.tile_lists import SIDE, Discs, TileLists, Whole

SAMPLES = 1 << 17  # composited at a time: about what the processor's cache holds
# Of these, list slots of as many tiles as are at work; few of them at least, so that
# complete tiles are soon noticed.
LEAST_SLOTS, MOST_SLOTS = 8, 64
PER_E = 1.0 / math.log(2.0)  # powers of 2 are the faster ones
# Where w is not 0 it is above 1e-40: beyond this depth nothing passes there at all.
DEEPEST = {np.float64: 1e300, np.float32: 1e37}


def pixel_places() -> tuple[Array, Array]:
    """Give x and y of a tile's pixels from its middle, row after row."""
    step = np.arange(0.5 - SIDE / 2, SIDE / 2)
    return np.tile(step, SIDE), np.repeat(step, SIDE)


@dataclass(frozen=True, eq=False)
class Result:
    """What `composite` gives for the tiles of one list.

    Attributes
    ----------
    light
        What the balls add, shape (T, C, S): C channels at S places of each tile.
    clear
        Share of the background that passes all of them, shape (T, S).
    unseen
        Entries of each list that were not drawn, since they lie behind an opaque
        front, shape (T,).
    """

    light: Floats
    clear: Floats
    unseen: Whole


def composite(
    lists: TileLists,
    discs: Discs,
    tau: Array,
    colours: Array,
    places: tuple[Array, Array],
    *,
    name: Name = "chord",
    law: Law = "beer",
    dtype: type = np.float64,
    least: float = 0.0,
    direct: NDArray[np.bool_] | None = None,
) -> Result:
    """Composite Wyvill balls of one colour each, from the front, unchecked.

    Parameters
    ----------
    lists, discs
        The tiles' lists, and the balls near to far.
    tau
        Optical depth of each ball on its axis, shape (N,).
    colours
        What each ball shows where it is opaque, shape (N, C).
    places
        x and y of the S places from a tile's middle, pixels: `pixel_places`, or nodes.
    name, law
        As `footprint` and `transmittance`.
    dtype
        float64, or float32, which is twice as fast.
    least
        A tile through which no place lets more than this share pass is complete.
    direct
        Balls whose places are measured one by one, shape (N,): see `cancelling`.

    Returns
    -------
    The result.
    """
    beer = law == "beer"
    deep = np.minimum(tau, DEEPEST[dtype])
    strength = deep * PER_E if beer else -np.expm1(-tau)
    footprints = Quadratics(lists, discs, strength, FORMS[name], places, direct, dtype)
    # In rows of memory, whatever the order of `colours`: they are looked up by rows.
    hue = np.zeros((len(tau) + 1, colours.shape[1]), dtype)
    hue[:-1] = colours

    count, channels, size = len(lists.count), colours.shape[1], len(places[0])
    light = np.empty((count, channels, size), dtype)
    clear = np.empty((count, size), dtype)
    unseen = np.zeros(count, np.intp)
    together = max(min(SAMPLES // (LEAST_SLOTS * size), count), 1)
    longest = min(int(lists.count.max(initial=0)), MOST_SLOTS)
    room = min(SAMPLES, longest * together * size) + together * size
    space, zeros = np.empty((2, room), dtype), np.zeros(room, dtype)
    ranked = np.argsort(-lists.count, kind="stable")  # lists of like length together
    for begin in range(0, count, together):
        live = ranked[begin : begin + together]
        added = np.zeros((len(live), channels, size), dtype)
        through = np.ones((len(live), size), dtype)
        total = np.zeros((len(live), size))  # its log2, in float64: no end, no drift
        slot = 0
        while n := len(live):
            # 1. The next balls of each tile; past a list's end, the empty pair.
            left = lists.count[live] - slot
            slots = min(SAMPLES // (n * size), MOST_SLOTS, int(left.max()))
            k = slot + np.arange(slots)[:, None]
            listed = k < lists.count[live]
            pair = np.where(listed, lists.first[live] + k, len(lists.ball))

            # 2. What each takes of the light at each place: log2 T, or T - 1.
            shape = slots, n, size
            every = slots * n * size
            F = space[0, : every + n * size].reshape(slots + 1, n, size)
            taken, v = F[1:], space[1, :every].reshape(shape)
            footprints.taken(pair, live, v, taken, zeros[:every].reshape(shape))

            # 3. F, counted from this slot on: what passes the balls before.
            F[0] = 1.0
            if beer:
                for j in range(1, slots):
                    taken[j] += taken[j - 1]
                total += taken[-1]
                np.exp2(taken, out=taken)
            else:
                taken += zeros.dtype.type(1.0)
                for j in range(1, slots):
                    taken[j] *= taken[j - 1]

            # 4. Colours, by parts; an empty slot is black.
            shown = hue.take(footprints.ball.take(pair), axis=0).transpose(1, 2, 0)
            change = np.empty((n, channels, slots + 1), dtype)
            change[..., 0], change[..., -1] = shown[..., 0], -shown[..., -1]
            np.subtract(shown[..., 1:], shown[..., :-1], out=change[..., 1:-1])
            more = np.matmul(change, F.transpose(1, 0, 2))
            more *= through[:, None]
            added += more
            if beer:
                through[...] = np.exp2(total)
            else:
                through *= taken[-1]

            # 5. Lists at their end, and tiles that nothing passes, are complete.
            slot += slots
            left -= slots
            done = (left <= 0) | (through.max(axis=1) <= least)
            if 4 * np.count_nonzero(done) >= n:
                unseen[live[done]] = np.maximum(left[done], 0)
                light[live[done]] = added[done]
                clear[live[done]] = through[done]
                kept = ~done
                live, added, through = live[kept], added[kept], through[kept]
                total = total[kept]
    return Result(light, clear, unseen)
