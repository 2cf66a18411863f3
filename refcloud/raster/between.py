"""A tile of smooth balls from every second pixel: the others lie between these.

Halfway between two of equally spaced values, six of them tell

    f(1/2) = (3 f(-2) - 25 f(-1) + 150 f(0) + 150 f(1) - 25 f(2) + 3 f(3)) / 256

to the fifth degree: along rows first, then along columns. What is missing shows in the
fourth differences, f(-2) - 4 f(-1) + 6 f(0) - 4 f(1) + f(2): they are large where the
picture bends too suddenly for its samples, at a rim, and vanish where it is smooth.
Both are sums of samples, so that one product with a small matrix on either side gives
all pixels of a tile together with all differences. Samples of the tiles beside it are
among them: a tile's edge is like any other place.
"""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.raster.quadratics import Floats
from refcloud.raster.tile_lists import PIXELS, SIDE, TileLists, Whole
from refcloud.raster.tiles import pixel_places

STEP = 2  # pixels from sample to sample
SAMPLES = SIDE // STEP  # along a tile's edge
HALFWAY = np.array([3.0, -25.0, 150.0, 150.0, -25.0, 3.0]) / 256.0
FOURTH = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
BEFORE, AFTER = 2, 3  # samples beyond a tile's edges that its pixels need
AROUND = BEFORE + SAMPLES + AFTER
EACH = AROUND * (SAMPLES + 1)  # fourth differences of a tile, each way
TOGETHER = 96  # tiles at a time: they stay in the cache, and products are small ones
# Of a sample's error, what pixels of the tile beside it take over at most: the weights
# of all samples outside sum to 1.451 at a corner.
HANDED_ON = 1.46
# What an opaque front hides makes errors of one sign: from 0 to 1 at all samples, they
# make at most this at a pixel, (306^2 + 50^2) / 256^2 rounded up.
ONE_SIDED = 1.467
# A ball's opacity rises within radius / sqrt(tau) from its rim, or within its radius.
# Where that is less than this many steps, the samples could miss what the pixels show.
LEAST_RISE = 3.0
# Of the samples on lines outside a quarter and its edges: 25 + 3 of 256, rounded up.
FAR = 0.125
# Largest error of a quarter's pixels over its largest fourth difference. Of errors over
# 0.001 the worst seen is 0.119, in 32,000 such quarters of 7,000 scenes of all sorts;
# 0.03 is common.
PER_FOURTH = 0.14


def _matrices() -> tuple[Floats, Floats]:
    """Give what a row of samples is multiplied by: (13, 16) for pixels, (13, 9)."""
    pixels = np.zeros((AROUND, SIDE), np.float32)
    fourth = np.zeros((AROUND, SAMPLES + 1), np.float32)
    for k in range(SAMPLES):
        pixels[BEFORE + k, STEP * k] = 1.0
        pixels[k : k + 6, STEP * k + 1] = HALFWAY
    for k in range(SAMPLES + 1):
        fourth[k : k + 5, k] = FOURTH
    return pixels, fourth


FROM_ROW, ROW_FOURTH = _matrices()


def _counted() -> Floats:
    """Give how much each line of samples counts for each half of a tile, (2, 13)."""
    counted = np.zeros((2, AROUND), np.float32)
    for i, middle in enumerate((0, SAMPLES // 2)):
        counted[i, middle : middle + BEFORE + AFTER + SAMPLES // 2] = FAR
        counted[i, middle + BEFORE : middle + BEFORE + SAMPLES // 2 + 1] = 1.0
    return counted


COUNTED = _counted()


@functools.cache
def sampled() -> tuple[Whole, tuple[Array, Array]]:
    """Give the numbers of the pixels that are samples, and their places; (64,) each."""
    row, column = np.divmod(np.arange(PIXELS), SIDE)
    pixels = np.flatnonzero((row % STEP == 0) & (column % STEP == 0))
    x, y = pixel_places()
    return pixels, (x[pixels], y[pixels])


def samples_among(pixels: Floats) -> Floats:
    """View those pixels of tiles that are samples, (..., 256) to (..., 8, 8)."""
    parted = pixels.reshape(*pixels.shape[:-1], SAMPLES, STEP, SAMPLES, STEP)
    return parted[..., 0, :, 0]


class Quarters(NamedTuple):
    """The quarters of a tile, row after row, to be drawn where it is not smooth.

    Attributes
    ----------
    pixels
        Numbers of those pixels that are no samples, shape (4, 48).
    places
        x and y of these from the quarter's middle, the same in each, shape (48,).
    moved
        x and y of the quarters' middles from the tile's, shape (4,).
    """

    pixels: Whole
    places: tuple[Array, Array]
    moved: tuple[Array, Array]


@functools.cache
def quarters() -> Quarters:
    """Set up a tile's quarters."""
    half = SIDE // 2
    row, column = np.divmod(np.arange(half * half), half)
    left_out = (row % STEP != 0) | (column % STEP != 0)
    row, column = row[left_out], column[left_out]
    j, i = np.divmod(np.arange(4), 2)
    middle = 0.5 * (half - 1)
    return Quarters(
        (half * j[:, None] + row) * SIDE + half * i[:, None] + column,
        (column - middle, row - middle),
        (half * (i - 0.5), half * (j - 0.5)),
    )


def inside(lists: TileLists) -> NDArray[np.bool_]:
    """Tell which tiles have all their neighbours in the box, shape (T,)."""
    left, right, top, bottom = lists.box
    across = (lists.column > left) & (lists.column < right - 1)
    return across & (lists.row > top) & (lists.row < bottom - 1)


class Samples:
    """Samples of all tiles of a box: light 0 and clear 1 where there is no ball.

    Parameters
    ----------
    box
        First and one past the last column, and row, of its tiles.
    lights, clears
        Channels of light, then of what passes.
    """

    def __init__(
        self, box: tuple[int, int, int, int], lights: int, clears: int
    ) -> None:
        self.box, self.lights = box, lights
        across, down = box[1] - box[0], box[3] - box[2]
        channels = lights + clears
        self.plane = np.zeros((channels, down * SAMPLES, across * SAMPLES), np.float32)
        self.plane[lights:] = 1.0
        tiled = self.plane.reshape(channels, down, SAMPLES, across, SAMPLES)
        self.tiles = tiled.transpose(0, 1, 3, 2, 4)  # (C, down, across, 8, 8)
        self.windows = sliding_window_view(self.plane, (AROUND, AROUND), axis=(1, 2))

    def put(self, lists: TileLists, which: Whole, *values: Floats) -> None:
        """Write samples of some tiles: light and clear, (T, C, 64) or (T, C, 8, 8)."""
        where = lists.row[which] - self.box[2], lists.column[which] - self.box[0]
        channel = 0
        for part in values:
            square = part.reshape(*part.shape[:2], SAMPLES, SAMPLES)
            for k in range(part.shape[1]):
                self.tiles[channel][where] = square[:, k]
                channel += 1

    def around(self, lists: TileLists, which: Whole) -> Floats:
        """Give the samples of some tiles and those around them, (C, T, 13, 13)."""
        row = (lists.row[which] - self.box[2]) * SAMPLES - BEFORE
        column = (lists.column[which] - self.box[0]) * SAMPLES - BEFORE
        return self.windows[:, row, column]

    def either(self, sizes: Floats) -> tuple[Floats, Floats]:
        """Give the largest of light, and of what passes, of (C, ...)."""
        return (
            np.maximum.reduce(sizes[: self.lights]),
            np.maximum.reduce(sizes[self.lights :]),
        )


def halfway(around: Floats) -> Floats:
    """Give all pixels of tiles from their samples, (C, T, 13, 13) to (C, T, 256)."""
    rows = around.reshape(len(around), -1, AROUND)
    along = (rows @ FROM_ROW).reshape(*around.shape[:3], SIDE)
    return np.matmul(FROM_ROW.T, along).reshape(*around.shape[:2], PIXELS)


def fourth_differences(around: Floats) -> tuple[Floats, Floats]:
    """Give sizes of fourth differences: down columns and along rows.

    Parameters
    ----------
    around
        Samples of tiles, shape (C, T, 13, 13).

    Returns
    -------
    Shape (C, T, 9, 13) and (C, T, 13, 9).
    """
    down = np.matmul(ROW_FOURTH.T, around)
    rows = around.reshape(len(around), -1, AROUND)
    across = (rows @ ROW_FOURTH).reshape(*around.shape[:3], SAMPLES + 1)
    return np.abs(down, out=down), np.abs(across, out=across)


def largest_of_tiles(differences: tuple[Floats, Floats]) -> Floats:
    """Give the largest difference of each tile, shape (C, T)."""
    down, across = (
        np.maximum.reduce(each.reshape(*each.shape[:2], EACH), axis=2)
        for each in differences
    )
    return np.maximum(down, across)


def largest_of_quarters(differences: tuple[Floats, Floats]) -> Floats:
    """Give the largest difference of each quarter of tiles, shape (2, 2, T).

    Parameters
    ----------
    differences
        Of one channel each, or the largest of several: (T, 9, 13) and (T, 13, 9).
    """
    down, across = differences
    by_column = _by_quarter(across.swapaxes(1, 2)).swapaxes(0, 1)
    return np.maximum(_by_quarter(down), by_column)


def _by_quarter(values: Floats) -> Floats:
    """Give the largest difference of each quarter, (T, 9, 13) to (2, 2, T).

    Lines that a quarter's pixels take little of count by as much.
    """
    middle = SAMPLES // 2
    found = np.empty((2, 2, len(values)), values.dtype)
    for j in range(2):
        rows = values[:, middle * j : middle * j + middle + 1]
        along = np.maximum.reduce(rows, axis=1)
        for i in range(2):
            found[j, i] = np.maximum.reduce(along * COUNTED[i], axis=1)
    return found
