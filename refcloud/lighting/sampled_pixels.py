"""A few pixels of a few tiles, exactly: what a picture with a tolerance is held to.

Nothing is shared with the tiles' own arithmetic: each pair of pixel and ball measures
its distance, and running sums of log T along each tile's list tell what reaches a ball.
"""

from __future__ import annotations

import functools

import numpy as np

from refcloud.conventions import Array
from refcloud.lighting.flat_tiles import Flat
from refcloud.noise import uniform
from refcloud.raster.footprint import footprint_of
from refcloud.raster.tile_lists import PIXELS, SIDE, TileLists, Whole

SAMPLE_PIXELS = 16  # of each tile are compared
TABLE = 256  # rows and columns of tiles after which the choice repeats itself
TOGETHER = 1 << 17  # pairs of pixel and ball at a time: 1 MB a list
DARKEST = -800.0  # exp of it is 0: deeper logarithms would cost the sums their digits


def exact_pixels(
    lists: TileLists, some: Whole, flat: Flat, places: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Composite some pixels of some tiles, unchecked.

    Formula: light = sum_k s_k (1 - T_k) F_k, F_k = exp(log T_0 + ... + log T_{k-1})

    Parameters
    ----------
    lists, flat
        As `FlatTiles`.
    some
        Numbers of the tiles.
    places
        x and y of S pixels from a tile's middle.

    Returns
    -------
    Light and clear as `Drawn` has them, of shape (T, L, S) and (T, G, S).
    """
    # 1. The pairs of these tiles, tile after tile; middles of balls from their tiles'.
    mine = lists.chosen(some)
    ball, last = mine.ball, mine.first + mine.count - 1
    x, y = (
        center.take(ball) - np.repeat((at + 0.5) * SIDE, mine.count)
        for center, at in ((flat.discs.x, mine.column), (flat.discs.y, mine.row))
    )
    radius = flat.discs.radius.take(ball)
    taus = [tau.take(ball) for tau in flat.tau]
    colours = [lights.take(ball, axis=1) for lights in flat.lights]
    channels = sum(len(lights) for lights in colours)
    light = np.empty((len(some), channels, len(places[0])))
    clear = np.empty((len(some), len(taus), len(places[0])))
    step = max(TOGETHER // max(len(ball), 1), 1)
    for begin in range(0, len(places[0]), step):
        now = slice(begin, begin + step)
        # 2. Footprints, pixel by pair.
        right, down = (place[now, None] for place in places)
        q = np.square((right - x) / radius)
        q += np.square((down - y) / radius)
        weight = footprint_of(q, "wyvill", flat.look.footprint)
        channel = 0
        for group, tau in enumerate(taus):
            # 3. log T of each, and of all before it in its tile.
            if flat.look.transmittance == "beer":
                log = weight * -tau
            else:
                with np.errstate(divide="ignore"):
                    log = np.log1p(weight * np.expm1(-tau))
            np.maximum(log, DARKEST, out=log)
            total = np.cumsum(log, axis=1)
            before = total - log
            before -= np.repeat(before[:, mine.first], mine.count, axis=1)
            clear[:, group, now] = np.exp(before[:, last] + log[:, last]).T
            # 4. What each shows of its colour.
            shows = np.exp(before, out=before)
            shows *= np.expm1(log, out=log)
            for color in colours[group]:
                sums = np.add.reduceat(shows * -color, mine.first, axis=1)
                light[:, channel, now] = sums.T
                channel += 1
    return light, clear


def hashed_tiles(lists: TileLists, count: int) -> Whole:
    """Choose tiles that are compared: a hash of their rows and columns does."""
    keys = _keys()[lists.row % TABLE, lists.column % TABLE]
    return np.sort(np.argsort(keys, kind="stable")[:count])


@functools.cache
def _keys() -> Array:
    """Give keys whose order chooses the tiles, by row and column."""
    row, column = np.indices((TABLE, TABLE))
    return uniform(row, column, seed=0)


@functools.cache
def hashed_pixels() -> Whole:
    """Choose the pixels of a tile that are compared."""
    order = np.argsort(uniform(np.arange(PIXELS), seed=1), kind="stable")
    return order[:SAMPLE_PIXELS]
