"""Tiles of balls of one colour each, within a tolerance: each as cheaply as it allows.

A tolerance may take float32, and fewer places than pixels: Chebyshev nodes where balls
are very wide, samples on a grid where they are wide enough. All of it is certified:
last terms and fourth differences tell where places are too few, and a hashed sample of
pixels is compared with the exact method before anything counts. A sample can miss what
lies beside it: the margins are those that generated scenes needed.
"""

from __future__ import annotations

import functools

import numpy as np

from refcloud.conventions import Skipped
from refcloud.lighting.flat_tiles import (
    Drawn,
    Flat,
    exact_tiles,
)
from refcloud.lighting.sampled_pixels import exact_pixels, hashed_pixels, hashed_tiles
from refcloud.lighting.sparse_tiles import SparseTiles
from refcloud.raster import between
from refcloud.raster.tile_lists import PIXELS, TileLists
from refcloud.raster.tiles import pixel_places

# Tolerances below this leave float32's own rounding, 6e-8 a step, no room.
LEAST_FLOAT32 = 1e-5
MOST_FLOAT32 = 1e-4  # of the tolerance's share: nothing is won by more
OF_NODES = 1.0 / 8.0  # of what fewer places may change: tiles beside take some over
# Tiles that are compared with the exact method, at 16 pixels each. Where pixels lie
# between samples a tolerance is a hundred times what float32 rounds.
SAMPLED, SAMPLED_BETWEEN = 32, 8
# The largest error of a picture over the largest of its sample: of float32, whose
# errors are sums of many roundings; and between places, where they sit at a few rims.
MARGIN_FLOAT32, MARGIN_BETWEEN = 6.0, 1.2


def certified_tiles(
    lists: TileLists,
    flat: Flat,
    least: float,
    most: float,
    brightest: float,
    behind: float,
) -> tuple[Drawn, list[Skipped]]:
    """Composite tiles with an error of at most `most`, as cheaply as that allows.

    Parameters
    ----------
    lists, flat, least
        As `exact_tiles`.
    most
        Largest error of a channel.
    brightest
        Largest colour, at least 1.
    behind
        Largest colour of the background; 0 where there is none.

    Returns
    -------
    What was drawn, and the rows of the report.
    """
    share = most if most < 2.0 * MOST_FLOAT32 else MOST_FLOAT32
    # What rounding may change of one ball's opacity at the worst; the sample tells.
    digits = 4.0 * share / brightest
    if most < 0.4 * LEAST_FLOAT32:
        return exact_tiles(lists, flat, least), []
    direct = flat.cancelling(np.float32, digits)
    # It pays where most balls' opacities keep enough digits.
    if any(2 * np.count_nonzero(balls) > len(balls) for balls in direct):
        return exact_tiles(lists, flat, least), []
    room = most - share  # for fewer places than pixels
    # Places between others may enlarge what the front hides at these.
    seen = least / between.ONE_SIDED if room > 0.0 else least
    work = SparseTiles(lists, flat, direct, seen, behind)
    used = 0.0
    if room > 0.0:
        # 1. Tiles of very wide balls at nodes; of wide ones at samples.
        used = work.at_nodes(OF_NODES * room)
        room -= between.HANDED_ON * used
        work.at_samples(room)
    # 2. All others at their pixels.
    work.at_pixels()
    if len(work.sparse):
        # 3. The pixels between samples; quarters of tiles that have too few at all.
        work.between_samples(room)
    # 4. The sample decides whether it counts.
    cut = least * brightest  # what an opaque front may hide is counted apart
    whole, sparse = (max(error - cut, 0.0) for error in _sampled_error(work, flat))
    if MARGIN_FLOAT32 * whole > share or MARGIN_BETWEEN * sparse > most:
        return exact_tiles(lists, flat, least), []
    count = len(lists.count)
    told = functools.partial(Skipped, "eye", how="certified")
    rows = [told("tiles in double precision", count, count, share)]
    every = count * PIXELS
    if work.saved_by_nodes:
        what = "pixels between nodes of smooth tiles"
        rows.append(told(what, work.saved_by_nodes, every, used))
    if work.saved_by_samples:
        what = "pixels between samples of smooth tiles"
        rows.append(told(what, work.saved_by_samples, every, room))
    return work.drawn, rows


def _sampled_error(work: SparseTiles, flat: Flat) -> tuple[float, float]:
    """Compare hashed pixels with the exact method.

    Returns
    -------
    The largest error where all pixels were drawn, and where fewer places were.
    """
    tiles = SAMPLED if work.exact.all() else SAMPLED_BETWEEN
    some, at = hashed_tiles(work.lists, tiles), hashed_pixels()
    x, y = pixel_places()
    light, clear = exact_pixels(work.lists, some, flat, (x[at], y[at]))
    error = work.of_picture(
        np.abs(light - work.drawn.light[some][..., at]).max(axis=(1, 2)),
        np.abs(clear - work.drawn.clear[some][..., at]).max(axis=(1, 2)),
    )
    whole = work.exact[some]
    return (
        float(error[whole].max(initial=0.0)),
        float(error[~whole].max(initial=0.0)),
    )
