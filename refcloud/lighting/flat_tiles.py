"""Tiles of balls of one colour each: the paper's splats."""

from __future__ import annotations

import numpy as np

from refcloud.conventions import Array
from refcloud.lighting.seen import Seen
from refcloud.raster.quadratics import cancelling
from refcloud.raster.tile_lists import PIXELS, Discs, TileLists, Whole
from refcloud.raster.tiles import composite, pixel_places


def flat_tiles(
    lists: TileLists, discs: Discs, seen: Seen, drawn: Whole, least: float
) -> tuple[Array, Array, int]:
    """Composite the tiles of balls of one colour each, unchecked.

    Parameters
    ----------
    lists, discs
        The tiles' lists, and the balls that are drawn, near to far.
    seen, drawn
        What the eye sees, and the numbers of the balls that are drawn.
    least
        A tile through which no pixel lets more than this share pass is complete.

    Returns
    -------
    As `shaded_tiles`.
    """
    look = seen.lit.look
    groups = seen.channel_groups()
    colours = seen.flat_colours()[drawn]
    light = np.empty((len(lists.count), 3, PIXELS))
    clear = np.empty((len(lists.count), len(groups), PIXELS))
    unseen = 0
    for g, channels in enumerate(groups):
        tau = seen.tau[channels[0]][drawn]
        result = composite(
            lists,
            discs,
            tau,
            colours[:, channels],
            pixel_places(),
            name=look.footprint,
            law=look.transmittance,
            least=least,
            direct=cancelling(discs, tau, look.transmittance),
        )
        light[:, channels] = result.light
        clear[:, g] = result.clear
        unseen += result.unseen
    return light, clear, unseen
