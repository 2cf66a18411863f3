"""One axis of a grid: the lattice lines it needs, and its weights, tile by tile.

Along an axis a sample weighs two lines, by 1 - w and w; gradient noise also asks for
these times the offset from the line. As matrices, samples by lines, the weights have a
narrow band: a tile of neighbouring samples needs but a few lines. Products of tiles are
small enough that the linear algebra library starts no threads for them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.noise.gradient import FADES, How
from refcloud.noise.mixing import Bits, _axis_bits
from refcloud.noise.scattered import PERIOD, Numbers, _split, _wrapped

TILE = 16  # samples along an axis that share one product


@dataclass(frozen=True)
class Tile:
    """Neighbouring samples of an axis.

    Attributes
    ----------
    samples, lines
        Which samples, and which of the axis's lattice lines they need.
    weights, slopes
        Weights of the lines, alone and times the offset from the line, shape (m, K).
    both
        The two side by side for each line, shape (m, 2 K).
    """

    samples: slice
    lines: slice
    weights: Numbers
    slopes: Numbers
    both: Numbers


@dataclass(frozen=True)
class Axis:
    """One axis of a grid, its samples in ascending order.

    Attributes
    ----------
    bits
        Hashed words of the lattice lines, ascending, each once, shape (L,).
    tiles
        The samples, some at a time.
    size
        How many samples there are.
    """

    bits: Bits
    tiles: list[Tile]
    size: int


def _ascending(coordinates: Array, period: int | None) -> tuple[Array, NDArray | None]:
    """Take coordinates modulo the period and sort them: places and their order.

    The order is None where they ascend already.
    """
    reduced = np.fmod(coordinates, PERIOD if period is None else period)
    if (np.diff(reduced) >= 0.0).all():
        return reduced, None
    order = np.argsort(reduced, kind="stable")
    return reduced[order], order


def _lines(reduced: Array) -> NDArray[np.int64]:
    """List the lattice lines that samples lie between, ascending, each once."""
    cells = np.floor(reduced).astype(np.int64)
    return np.unique(np.concatenate((cells, cells + 1)))


def _axis(reduced: Array, number: int, how: How) -> Axis:
    """Lay out ascending samples along axis 0, 1 or 2."""
    cells, t = _split(reduced)
    w = FADES[how.fade](t)
    lines = _lines(reduced)
    place = np.searchsorted(lines, cells)
    tiles = []
    for first in range(0, reduced.size, TILE):
        part = slice(first, min(first + TILE, reduced.size))
        low = int(place[first])
        row, column = np.arange(place[part].size), place[part] - low
        weights = np.zeros((row.size, int(column[-1]) + 2))
        slopes = np.zeros_like(weights)
        weights[row, column], weights[row, column + 1] = 1.0 - w[part], w[part]
        slopes[row, column] = (1.0 - w[part]) * t[part]
        slopes[row, column + 1] = w[part] * (t[part] - 1.0)
        band = slice(low, low + weights.shape[1])
        both = np.stack((weights, slopes), axis=-1).reshape(row.size, -1)
        kinds = (a.astype(how.dtype) for a in (weights, slopes, both))
        tiles.append(Tile(part, band, *kinds))
    bits = _axis_bits(_wrapped(lines, how.period), number, how.seed, how.hash)
    return Axis(bits, tiles, reduced.size)
