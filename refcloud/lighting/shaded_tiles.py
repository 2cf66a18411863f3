"""Tiles of balls whose footprint and colour vary with the place that a pixel shows.

Where a look erodes footprints or takes colours from a field, no product of matrices can
give the samples: each has its own place in the world. So the tiles are composited one
list slot at a time, from the front, on a list of just those pixels that the slot's
balls cover and that still let light pass. What a pixel sees of a ball is looked up by
`ExactPlaces`, as the literal form does, or by `SinglePlaces`, in single precision.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np

from refcloud.conventions import Array
from refcloud.lighting.flat_tiles import Drawn
from refcloud.raster.quadratics import Floats
from refcloud.raster.tile_lists import PIXELS, TileLists, Whole

TILES = 256  # worked on together: calls are long, and samples stay near the processor


class Looked(NamedTuple):
    """What pixels see of one ball of each tile, M of them.

    Attributes
    ----------
    at
        Numbers of the pixels in the batch of tiles, shape (M,).
    color
        What the ball shows where it is opaque, red, green and blue of shape (M,).
    opacity
        By group of channels, each of shape (M,).
    doubt
        What rounding may change of the opacity, likewise; none where it does not count.
    """

    at: Whole
    color: Sequence[Floats]
    opacity: Sequence[Floats]
    doubt: Sequence[Floats] = ()


class Places(Protocol):
    """Where pixels look."""

    def at(
        self, lists: TileLists, live: Whole, ball: Whole, open_: np.ndarray
    ) -> Looked:
        """Look at one ball of each live tile, in pixels that are open, (T, 256)."""
        ...


def shaded_tiles(
    lists: TileLists,
    drawn: Whole,
    groups: Sequence[Sequence[int]],
    places: Places,
    least: float,
) -> Drawn:
    """Composite the tiles of balls that are shaded place by place, unchecked.

    Parameters
    ----------
    lists
        The tiles' lists of positions in `drawn`.
    drawn
        The balls that are drawn, near to far.
    groups
        Channels of one extinction each.
    places
        What is seen where.
    least
        A pixel that lets no more than this share pass is complete.

    Returns
    -------
    What was drawn of the 256 pixels of each tile; its `doubt` is the largest sum of a
    pixel: of what rounding may change of each opacity, seen through what lies in front.
    """
    count = len(lists.count)
    light = np.zeros((count, 3, PIXELS))
    clear = np.ones((count, len(groups), PIXELS))
    unseen, closed, most = np.zeros(count, np.intp), 0, 0.0
    ranked = np.argsort(-lists.count, kind="stable")  # lists of like length together
    for begin in range(0, count, TILES):
        batch = ranked[begin : begin + TILES]
        added = np.zeros((3, len(batch) * PIXELS))
        passed = np.ones((len(groups), len(batch), PIXELS))
        doubt = np.zeros_like(passed)
        alive = np.arange(len(batch))
        for slot in range(int(lists.count[batch[0]])):
            # 1. Tiles whose list goes on, and their pixels where a ball could show.
            alive = alive[: np.count_nonzero(lists.count[batch[alive]] > slot)]
            open_ = passed[:, alive].max(axis=0) > least
            opens = np.count_nonzero(open_, axis=1)
            if not opens.all():  # from here on nothing shows in some tiles
                hidden = batch[alive[opens == 0]]
                unseen[hidden] = lists.count[hidden] - slot
                alive, open_ = alive[opens > 0], open_[opens > 0]
            if not len(alive):
                break
            closed += open_.size - int(opens.sum())
            # 2. One ball of each.
            live = batch[alive]
            ball = drawn[lists.ball[lists.first[live] + slot]]
            found = places.at(lists, live, ball, open_)
            if not len(found.at):
                continue
            at = (alive * PIXELS).take(found.at // PIXELS)
            at += found.at % PIXELS
            # 3. Under what lies in front: add F times that, and dim F.
            for group, channels in enumerate(groups):
                dim = passed[group].reshape(-1)
                through: Array = dim.take(at)
                if found.doubt:
                    doubt[group].reshape(-1)[at] += found.doubt[group] * through
                opacity = found.opacity[group] * through
                dim[at] = through - opacity
                for channel in channels:
                    added[channel][at] += opacity * found.color[channel]
        light[batch] = added.reshape(3, -1, PIXELS).transpose(1, 0, 2)
        clear[batch] = passed.transpose(1, 0, 2)
        most = max(most, float(doubt.max(initial=0.0)))
    return Drawn(light, clear, unseen, closed, most)
