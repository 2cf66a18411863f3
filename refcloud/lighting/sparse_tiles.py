"""Tiles of balls of one colour each from fewer places than pixels, in float32.

Chebyshev nodes where balls are very wide, samples on a grid where they are wide enough;
all pixels elsewhere. Last terms and fourth differences tell where places are too few:
`certified_tiles` says what that is worth.
"""

from __future__ import annotations

import functools

import numpy as np
from numpy.typing import NDArray

from refcloud.lighting.flat_tiles import Drawn, Flat, FlatTiles
from refcloud.raster import between
from refcloud.raster.between import Fourth, Lattice, Samples
from refcloud.raster.nodes import LEAST_RISE, nodes, one_sided
from refcloud.raster.quadratics import Floats
from refcloud.raster.tile_lists import PIXELS, TileLists, Whole
from refcloud.raster.tiles import pixel_places

NODES = 6  # along a tile's edge, where balls are so wide that these serve
# Nodes are tried where opacity rises within many of their spacings. Samples, where half
# the tiles rise within so many steps that `GUESS` over these, to the power of 2.4, is
# allowed: else too many are drawn again. With `SPARE` times these steps few of them
# are. Measured on the benchmark's scenes; a wrong guess costs time alone.
LEAST_NODES, GUESS, GUESSED_POWER, SPARE = 4.0 * LEAST_RISE, 0.2, 2.4, 1.9
FEW = 10  # balls of a tile, to which filling it up costs more than drawing its pixels


class SparseTiles:
    """Tiles on their way into a picture, in float32, unchecked.

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
        self.tiles, self.discs = FlatTiles(lists, flat, np.float32, direct), flat.discs
        count, groups = len(lists.count), len(flat.groups)
        self.lights = sum(len(lights) for lights in flat.lights)
        self.drawn = Drawn(
            np.empty((count, self.lights, PIXELS), np.float32),
            np.empty((count, groups, PIXELS), np.float32),
            np.zeros(count, np.intp),
        )
        self.open = np.ones(count, dtype=bool)  # not drawn yet
        self.exact = np.zeros(count, dtype=bool)  # at all pixels
        self.sparse = np.arange(0)  # tiles that have samples
        # Tiles that have nodes, and light and clear at these.
        self.of_nodes: tuple[Whole, Floats, Floats] | None = None
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
        found = self.tiles.at(level.places, self.least / _one_sided(), tried)
        error = self.of_picture(
            level.error_of(found.light), level.error_of(found.clear)
        )
        good = np.flatnonzero(error <= most)
        self._keep(
            tried[good],
            level.at_pixels(found.light[good]),
            level.at_pixels(found.clear[good]),
            found.unseen[good],
        )
        self.of_nodes = tried[good], found.light[good], found.clear[good]
        self.saved_by_nodes = len(good) * (PIXELS - level.n**2)
        return float(error[good].max(initial=0.0))

    def at_samples(self, most: float) -> None:
        """Draw tiles of wide balls at samples between which their pixels may lie."""
        wide = (self.lists.count > FEW) & between.inside(self.lists) & self.open
        wide &= self.rise >= between.LEAST_RISE * between.least_step()
        rises = self.rise[wide]
        if not len(rises):
            return
        half = len(rises) // 2
        rise = float(np.partition(rises, half)[half])
        steps = (GUESS / most) ** (1.0 / GUESSED_POWER)
        if rise < steps * between.least_step():
            return
        grid = between.samples_for(rise / (SPARE * steps))
        wide &= self.rise >= between.LEAST_RISE * grid.step
        self.sparse = np.flatnonzero(wide)
        if len(self.sparse):
            groups = len(self.tiles.compositors)
            self.samples = Samples(grid, self.lists.box, self.lights, groups)
            found = self.tiles.at(grid.places, self.least, self.sparse)
            self.samples.put(self.lists, self.sparse, found.light, found.clear)
            self.drawn.unseen[self.sparse] = found.unseen
            self.open[self.sparse] = False
            self._nodes_as_samples(grid)

    def _nodes_as_samples(self, grid: Lattice) -> None:
        """Give tiles of nodes their samples: tiles beside lie between these."""
        if self.of_nodes is None:
            return
        which, *values = self.of_nodes
        spread = nodes(NODES).spread_to(grid.along).astype(np.float32)
        self.samples.put(self.lists, which, *(np.matmul(of, spread) for of in values))

    def at_pixels(self) -> None:
        """Draw all tiles that are left at their pixels, and at samples for others."""
        left = np.flatnonzero(self.open)
        if len(left):
            places = pixel_places()
            if len(self.sparse):
                more = self.samples.grid.places
                places = (
                    np.concatenate([places[0], more[0]]),
                    np.concatenate([places[1], more[1]]),
                )
            found = self.tiles.at(places, self.least, left)
            light, clear = found.light, found.clear
            self._keep(left, light[..., :PIXELS], clear[..., :PIXELS], found.unseen)
            self.exact[left] = True
            if len(self.sparse):
                more = light[..., PIXELS:], clear[..., PIXELS:]
                self.samples.put(self.lists, left, *more)

    def between_samples(self, most: float) -> None:
        """Fill tiles up from their samples, or draw quarters that have too few."""
        light, clear, grid = self.drawn.light, self.drawn.clear, self.samples.grid
        rough: list[tuple[Whole, Floats, Floats]] = []
        together = between.TOGETHER // (self.lights + clear.shape[1])
        for begin in range(0, len(self.sparse), together):
            some = self.sparse[begin : begin + together]
            around = self.samples.around(self.lists, some)
            pixels = self.samples.pixels(around)
            for channel in range(self.lights):
                light[some, channel] = pixels[channel]
            for group in range(clear.shape[1]):
                clear[some, group] = pixels[self.lights + group]
            # Most tiles are smooth everywhere: only of the others quarters are looked
            # at, of all together.
            fourth = Fourth.of(self.samples, around)
            largest = self.samples.either(fourth.of_tiles())
            at = np.flatnonzero(self._too_large(largest, most))
            down, across = fourth.down[:, at], fourth.across[:, at]
            down, across = self.samples.either(down), self.samples.either(across)
            rough.append((some[at], down, across))
        self.saved_by_samples = len(self.sparse) * (PIXELS - grid.n**2)
        some = np.concatenate([tiles for tiles, _, _ in rough])
        if len(some):
            down = np.concatenate([each for _, each, _ in rough], axis=1)
            across = np.concatenate([each for _, _, each in rough], axis=1)
            sizes = Fourth(grid, down, across).of_quarters().transpose(2, 0, 1, 3)
            row, column, at = np.nonzero(self._too_large(sizes, most))
            self._draw_quarters(some[at], row, column)

    def _too_large(self, largest: Floats, most: float) -> NDArray[np.bool_]:
        """Tell where fourth differences, of light and of what passes, are too large."""
        per_fourth = between.PER_FOURTH[self.samples.grid.n]
        return self.of_picture(*largest) * per_fourth > most

    def _draw_quarters(self, tile: Whole, row: Whole, column: Whole) -> None:
        """Draw all pixels of some quarters of tiles."""
        quarters = self.lists.quarters(tile, row, column, self.discs)
        found = self.tiles.on(quarters).at(between.quarter_places(), self.least)
        for pixels, drawn in (
            (self.drawn.light, found.light),
            (self.drawn.clear, found.clear),
        ):
            parts = between.by_quarter(pixels)
            parts[tile, row, column] = drawn.reshape(len(tile), *parts.shape[3:])
        self.saved_by_samples -= found.clear[:, 0].size

    def _keep(self, which: Whole, light: Floats, clear: Floats, unseen: Whole) -> None:
        """Take pixels of some tiles into the picture."""
        self.drawn.light[which], self.drawn.clear[which] = light, clear
        self.drawn.unseen[which] = unseen
        self.open[which] = False

    def of_picture(self, light: Floats, clear: Floats) -> Floats:
        """Give a picture's error from those of what is added and of what passes.

        Before a background it shows light + clear background, before none an alpha.
        """
        if self.behind > 0.0:
            return light + self.behind * clear
        return np.maximum(light, clear)


@functools.cache
def _one_sided() -> float:
    """Give the most that errors from 0 to 1 at nodes make at pixels or at samples."""
    level = nodes(NODES)
    grids = (level.spread_to(between.lattice(n).along) for n in between.SIZES)
    return max(level.one_sided, *(one_sided(spread) for spread in grids))
