"""All splats of a picture at once, tile by tile: the sums of `splat`, fast.

The literal loop blends ball after ball, far to near: c = s (1 - T) + T c. Written from
the front, with F_k the light that passes all balls nearer than ball k,

    F_k = T_0 T_1 ... T_{k-1},    c = sum_k s_k (F_k - F_{k+1}) + F_end background

so that a tile needs no order of blending, only running sums of log T over its list.
`composite` works on many tiles and a few balls of each at a time, in arrays that stay
in the processor's cache. Two products of small matrices do most of the work: footprints
(`quadratics`), and, summing by parts, colours, with s_{-1} = 0:

    c = sum_k (s_k - s_{k-1}) F_k - s_end F_end

Every product is smaller than 2^18, from where OpenBLAS may use more threads: the same
bits whatever their number.
"""

from __future__ import annotations

import copy
import functools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.raster.footprint import Law, Name
from refcloud.raster.quadratics import FORMS, Floats, Places, Quadratics
from refcloud.raster.tile_lists import SIDE, Discs, TileLists, Whole

CACHED = 1 << 20  # bytes composited at a time: about what the processor's cache holds
# Of these, list slots of as many tiles as are at work; a few of them, so that complete
# tiles are soon noticed, but more where that makes arrays too small to be worth a call.
LEAST_SLOTS, MOST_SLOTS = 12, 16
WORTH = 1 << 14
PER_E = 1.0 / math.log(2.0)  # powers of 2 are the faster ones
# Where w is not 0 it is above 1e-40: beyond this depth nothing passes there at all.
DEEPEST = {np.float64: 1e300, np.float32: 1e37}


def pixel_places() -> tuple[Array, Array]:
    """Give x and y of a tile's pixels from its middle, row after row."""
    step = np.arange(0.5 - SIDE / 2, SIDE / 2)
    return np.tile(step, SIDE), np.repeat(step, SIDE)


@functools.cache
def zeros(dtype: type) -> Floats:
    """Give as many zeros as are ever needed at a time, not to be written to."""
    found = np.zeros(CACHED // np.dtype(dtype).itemsize, dtype)
    found.flags.writeable = False
    return found


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


class Compositor:
    """Wyvill balls of one colour each, ready to be composited at any places, unchecked.

    Parameters
    ----------
    lists, discs
        The tiles' lists, and the balls near to far.
    tau
        Optical depth of each ball on its axis, shape (N,).
    colours
        What each ball shows where it is opaque, shape (N, C).
    name, law
        As `footprint` and `transmittance`.
    dtype
        float64, or float32, which is twice as fast.
    direct
        Balls whose places are measured one by one, shape (N,): see `cancelling`.
    """

    def __init__(
        self,
        lists: TileLists,
        discs: Discs,
        tau: Array,
        colours: Array,
        *,
        name: Name = "chord",
        law: Law = "beer",
        dtype: type = np.float64,
        direct: NDArray[np.bool_] | None = None,
    ) -> None:
        self.lists, self.dtype, self.channels = lists, dtype, colours.shape[1]
        self.beer = law == "beer"
        deep = np.minimum(tau, DEEPEST[dtype])
        strength = deep * PER_E if self.beer else -np.expm1(-tau)
        self.footprints = Quadratics(
            lists, discs, strength, FORMS[name], list(colours.T), direct, dtype
        )
        # Room to work in, the same one for all tiles; what is not used costs nothing.
        self.samples = CACHED // np.dtype(dtype).itemsize
        self.space = np.empty((2, 2 * self.samples), dtype)
        self.zeros = zeros(dtype)

    def on(self, lists: TileLists) -> Compositor:
        """Give a compositor of the same balls for other lists; it shares the room."""
        other = copy.copy(self)
        other.lists, other.footprints = lists, copy.copy(self.footprints)
        other.footprints.use(lists)
        return other

    def at(
        self,
        places: tuple[Array, Array],
        least: float,
        which: Whole | None = None,
    ) -> Result:
        """Composite tiles from the front.

        Parameters
        ----------
        places
            x and y of the S places from a tile's middle, pixels: `pixel_places`, or
            some of them, or nodes.
        least
            A tile through which no place lets more than this share pass is complete.
        which
            Numbers of the tiles; None for all.

        Returns
        -------
        The result for these tiles.
        """
        tiles = np.arange(len(self.lists.count)) if which is None else which
        counts, size = self.lists.count[tiles], len(places[0])
        light = np.empty((len(tiles), self.channels, size), self.dtype)
        clear = np.empty((len(tiles), size), self.dtype)
        unseen = np.zeros(len(tiles), np.intp)
        together = max(min(self.samples // (LEAST_SLOTS * size), len(tiles)), 1)
        at, every_place = Places(*places, self.dtype), np.ones(size, dtype=bool)
        ranked = np.argsort(-counts, kind="stable")  # lists of like length together
        for begin in range(0, len(tiles), together):
            live = ranked[begin : begin + together]
            left, start = counts[live], self.lists.first[tiles[live]]
            added = np.empty(0, self.dtype)  # nothing yet
            through = np.ones((len(live), size), self.dtype)
            total = np.zeros((len(live), size))  # its log2, in float64: no drift
            while n := len(live):
                # 1. The next balls of each tile; past a list's end, none.
                few = max(MOST_SLOTS, min(WORTH // (n * size), 4 * MOST_SLOTS))
                slots = min(self.samples // (n * size), few, int(left.max()))
                k = np.arange(slots)[:, None]
                pair = start + k
                if slots > left.min():
                    pair = np.where(k < left, pair, -1)

                # 2. What each takes of the light at each place: log2 T, or T - 1.
                shape, every = (slots, n, size), slots * n * size
                F = self.space[0, : every + n * size].reshape(slots + 1, n, size)
                taken, v = F[1:], self.space[1, :every].reshape(shape)
                zero = self.zeros[:every].reshape(shape)
                change = self.footprints.taken(pair, tiles[live], at, v, taken, zero)

                # 3. F, counted from this slot on: what passes the balls before.
                F[0] = 1.0
                if self.beer:
                    for j in range(1, slots):
                        taken[j] += taken[j - 1]
                    total += taken[-1]
                    np.exp2(taken[:-1], out=taken[:-1])
                else:
                    taken += taken.dtype.type(1.0)
                    for j in range(1, slots):
                        taken[j] *= taken[j - 1]

                # 4. Colours, by parts; in an empty slot nothing changes.
                change = np.ascontiguousarray(change.transpose(1, 2, 0))
                more = np.matmul(change, F[:-1].transpose(1, 0, 2))
                if not len(added):
                    added = more
                else:
                    more *= through[:, None]
                    added += more
                if self.beer:
                    through[...] = total
                    np.exp2(through, out=through)
                else:
                    through *= taken[-1]

                # 5. Lists at their end, and tiles that nothing passes, are complete.
                start += slots
                left -= slots
                # (A product of truths is what numpy has soonest.)
                done = (left <= 0) | ~((through > least) @ every_place)
                if done.all():
                    unseen[live] = np.maximum(left, 0)
                    light[live], clear[live] = added, through
                    break
                if 4 * np.count_nonzero(done) >= n:
                    over, kept = np.flatnonzero(done), np.flatnonzero(~done)
                    ended = live.take(over)
                    unseen[ended] = np.maximum(left.take(over), 0)
                    light[ended], clear[ended] = added[over], through[over]
                    live, added, through = live[kept], added[kept], through[kept]
                    total, left, start = total[kept], left[kept], start[kept]
        # 6. Where a list ends or is cut off, the last ball's colour ends too.
        last = self.lists.first[tiles] + counts - unseen - 1
        for channel, shows in enumerate(self.footprints.looked_up):
            ends = shows.take(last).astype(self.dtype)
            light[:, channel] -= ends[:, None] * clear
        return Result(light, clear, unseen)


def composite(
    lists: TileLists,
    discs: Discs,
    tau: Array,
    colours: Array,
    places: tuple[Array, Array],
    *,
    least: float = 0.0,
    **how: Any,
) -> Result:
    """Composite all tiles of `lists` at some places: `Compositor` in one call."""
    return Compositor(lists, discs, tau, colours, **how).at(places, least)
