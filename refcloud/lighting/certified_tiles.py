"""Tiles of balls of one colour each, within a tolerance: each as cheaply as it allows.

A tolerance may take float32, and fewer places than pixels: Chebyshev nodes where balls
are very wide, every second pixel where they are wide enough. All of it is certified:
last terms and fourth differences tell where places are too few, and a hashed sample of
pixels is compared with the exact method before anything counts. A sample can miss what
lies beside it: the margins are those that generated scenes needed.
"""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array, Skipped
from refcloud.lighting.flat_tiles import (
    Drawn,
    Flat,
    FlatTiles,
    exact_tiles,
    one_ball_a_pair,
)
from refcloud.noise import uniform
from refcloud.raster import between
from refcloud.raster.between import Samples, quarters, sampled
from refcloud.raster.nodes import LEAST_RISE, nodes
from refcloud.raster.quadratics import Floats
from refcloud.raster.tile_lists import PIXELS, TileLists, Whole
from refcloud.raster.tiles import pixel_places

# Tolerances below this leave float32's own rounding, 6e-8 a step, no room.
LEAST_FLOAT32 = 1e-5
MOST_FLOAT32 = 1e-4  # of the tolerance's share: nothing is won by more
NODES = 6  # along a tile's edge, where balls are so wide that these serve
OF_NODES = 1.0 / 8.0  # of what fewer places may change: tiles beside take some over
# Nodes are tried where opacity rises within many of their spacings. Samples, where this
# is allowed over the steps of the rise to the power of 2.4: half the median of the
# estimates in the benchmark's scenes. A wrong guess costs time alone.
LEAST_NODES, GUESS = 4.0 * LEAST_RISE, 0.15
FEW = 10  # balls of a tile, to which filling it up costs more than drawing its pixels
SAMPLE_TILES, SAMPLE_PIXELS = 32, 16  # 512 pixels are compared with the exact method
TABLE = 256  # rows and columns of tiles after which the choice repeats itself
SAMPLE_LEAST = 0.01  # what the sample itself may leave out behind an opaque front
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
    work = _Work(lists, flat, direct, seen, behind)
    used = 0.0
    if room > 0.0:
        # 1. Tiles of very wide balls at nodes; of wide ones at every second pixel.
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
    sampled_error = work.sampled_error(flat, SAMPLE_LEAST * share / brightest)
    whole, sparse = (max(error - cut, 0.0) for error in sampled_error)
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
        what = "pixels between every second one"
        rows.append(told(what, work.saved_by_samples, every, room))
    return work.drawn, rows


class _Work:
    """Tiles on their way into a picture, in float32.

    Parameters
    ----------
    lists, flat, least, behind
        As `certified_tiles`.
    direct
        Balls to which float32 would be too rough, by group of channels.
    """

    def __init__(
        self,
        lists: TileLists,
        flat: Flat,
        direct: list[NDArray[np.bool_]],
        least: float,
        behind: float,
    ) -> None:
        self.lists, self.least, self.behind = lists, least, behind
        self.tiles = FlatTiles(lists, flat, np.float32, direct)
        count, groups = len(lists.count), len(flat.groups)
        self.drawn = Drawn(
            np.empty((count, 3, PIXELS), np.float32),
            np.empty((count, groups, PIXELS), np.float32),
            np.zeros(count, np.intp),
        )
        self.open = np.ones(count, dtype=bool)  # not drawn yet
        self.exact = np.zeros(count, dtype=bool)  # at all pixels
        self.sparse = np.arange(0)  # tiles that have samples
        self.saved_by_nodes = self.saved_by_samples = 0
        # Pixels over which the steepest ball of each tile becomes opaque.
        deepest = np.maximum(np.max(flat.tau, axis=0), 1.0)
        rise = (flat.discs.radius / np.sqrt(deepest))[lists.ball]
        self.rise = np.minimum.reduceat(rise, lists.first)

    def at_nodes(self, most: float) -> float:
        """Draw tiles of very wide balls at nodes; give the largest error of theirs."""
        level = nodes(NODES)
        wide = self.rise >= LEAST_NODES * level.spacing
        tried = np.flatnonzero(wide & (self.lists.count > FEW))
        if not len(tried):
            return 0.0
        found = self.tiles.at(level.places, self.least / level.one_sided, tried)
        error = self._of_picture(
            level.error_of(found.light), level.error_of(found.clear)
        )
        good = np.flatnonzero(error <= most)
        self._keep(
            tried[good],
            level.at_pixels(found.light[good]),
            level.at_pixels(found.clear[good]),
            found.unseen[good],
        )
        self.saved_by_nodes = len(good) * (PIXELS - level.n**2)
        return float(error[good].max(initial=0.0))

    def at_samples(self, most: float) -> None:
        """Draw tiles of wide balls at every second pixel, where that may be enough."""
        steps = self.rise / between.STEP
        wide = (steps >= between.LEAST_RISE) & (GUESS * steps**-2.4 <= most)
        wide &= self.lists.count > FEW
        self.sparse = np.flatnonzero(wide & self.open & between.inside(self.lists))
        if len(self.sparse):
            self.samples = Samples(self.lists.box, 3, len(self.tiles.groups))
            found = self.tiles.at(sampled()[1], self.least, self.sparse)
            self.samples.put(self.lists, self.sparse, found.light, found.clear)
            self.drawn.unseen[self.sparse] = found.unseen
            self.open[self.sparse] = False

    def at_pixels(self) -> None:
        """Draw all tiles that are left at their pixels."""
        left = np.flatnonzero(self.open)
        if len(left):
            found = self.tiles.at(pixel_places(), self.least, left)
            self._keep(left, found.light, found.clear, found.unseen)
            self.exact[left] = True

    def between_samples(self, most: float) -> None:
        """Fill tiles up from their samples, or draw quarters that have too few."""
        light, clear = self.drawn.light, self.drawn.clear
        others = np.ones(len(light), dtype=bool)
        others[self.sparse] = False
        others = np.flatnonzero(others)
        known = (between.samples_among(pixels)[others] for pixels in (light, clear))
        self.samples.put(self.lists, others, *known)
        rough: list[tuple[Whole, Whole]] = []
        for begin in range(0, len(self.sparse), between.TOGETHER):
            some = self.sparse[begin : begin + between.TOGETHER]
            around = self.samples.around(self.lists, some)
            pixels = between.halfway(around)
            for channel in range(3):
                light[some, channel] = pixels[channel]
            for group in range(clear.shape[1]):
                clear[some, group] = pixels[3 + group]
            rough += self._rough_quarters(some, around, most)
        self.saved_by_samples = len(self.sparse) * (PIXELS - between.SAMPLES**2)
        parts = quarters()
        if rough:
            tile, part = (np.concatenate(each) for each in zip(*rough, strict=True))
            moved = parts.moved[0][part], parts.moved[1][part]
            found = self.tiles.at(parts.places, self.least, tile, moved)
            at, tile = parts.pixels[part][:, None], tile[:, None, None]
            light[tile, np.arange(3)[:, None], at] = found.light
            clear[tile, np.arange(clear.shape[1])[:, None], at] = found.clear
            self.saved_by_samples -= found.clear[:, 0].size

    def _rough_quarters(
        self, some: Whole, around: Floats, most: float
    ) -> list[tuple[Whole, Whole]]:
        """List tiles and quarters of theirs whose samples may be too few."""
        fourth = between.fourth_differences(around)
        # Most tiles are smooth everywhere: only of the others quarters are looked at.
        error = self._of_picture(*self.samples.either(between.largest_of_tiles(fourth)))
        rough = np.flatnonzero(error * between.PER_FOURTH > most)
        if not len(rough):
            return []
        down, across = (self.samples.either(each[:, rough]) for each in fourth)
        error = self._of_picture(
            *map(between.largest_of_quarters, zip(down, across, strict=True))
        )
        row, column, tile = np.nonzero(error * between.PER_FOURTH > most)
        return [(some[rough[tile]], 2 * row + column)]

    def _keep(self, which: Whole, light: Floats, clear: Floats, unseen: Whole) -> None:
        """Take pixels of some tiles into the picture."""
        self.drawn.light[which], self.drawn.clear[which] = light, clear
        self.drawn.unseen[which] = unseen
        self.open[which] = False

    def _of_picture(self, light: Floats, clear: Floats) -> Floats:
        """Give a picture's error from those of what is added and of what passes.

        Before a background it shows light + clear background, before none an alpha.
        """
        if self.behind > 0.0:
            return light + self.behind * clear
        return np.maximum(light, clear)

    def sampled_error(self, flat: Flat, least: float) -> tuple[float, float]:
        """Compare hashed pixels with the exact method.

        Returns
        -------
        The largest error where all pixels were drawn, and where fewer places were.
        """
        keys = _hashed_tiles()[self.lists.row % TABLE, self.lists.column % TABLE]
        some = np.sort(np.argsort(keys, kind="stable")[:SAMPLE_TILES])
        at = _hashed_pixels()
        x, y = pixel_places()
        lists, theirs = one_ball_a_pair(self.lists.chosen(some), flat)
        exact = FlatTiles(lists, theirs).at((x[at], y[at]), least)
        error = self._of_picture(
            np.abs(exact.light - self.drawn.light[some][..., at]).max(axis=(1, 2)),
            np.abs(exact.clear - self.drawn.clear[some][..., at]).max(axis=(1, 2)),
        )
        whole = self.exact[some]
        return (
            float(error[whole].max(initial=0.0)),
            float(error[~whole].max(initial=0.0)),
        )


@functools.cache
def _hashed_tiles() -> Array:
    """Give keys whose order chooses the tiles that are compared, by row and column."""
    row, column = np.indices((TABLE, TABLE))
    return uniform(row, column, seed=0)


@functools.cache
def _hashed_pixels() -> Whole:
    """Choose the pixels of a tile that are compared."""
    order = np.argsort(uniform(np.arange(PIXELS), seed=1), kind="stable")
    return order[:SAMPLE_PIXELS]
