"""Document C's cloud sheet: a small seamless map, its octaves, an exponential filter.

Values are the document's, meant as grey levels: 128 + 128 g is in (0, 256], so the
"0 to 255" of its text is passed by one (E31), and the sum of four octaves reaches 480
= 256 (1 + 1/2 + 1/4 + 1/8). Its filter shows what lies above 255 - cover = 235, near
the mean of that sum (240): do not normalise the sum before, or no cloud is left.
What it calls "Perlin noise" is value noise, what it calls "mirror" is wrapping, and its
rand() % 5000 picks a part of one pattern, for r + 1 moves the numbers of r by (17, 2)
(E09). Its texture of type `char` cannot hold 0..255 where char is signed (E31).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Range, Seed
from refcloud.noise.sheet_map import (
    Grey,
    Numbers,
    Side,
    _neighbours,
    _some,
    sheet_map,
    wrapped_bilinear,
)

Octaves = Annotated[int, Range(1, 16)]

WHITE = 255.0  # what the filter approaches
AT_ONCE = 1 << 13  # samples: what one pass leaves, the next finds in the cache
COVER, SHARPNESS = 20.0, 0.95  # the document's filter


@checked
def overlap_octaves(values: Grey, size: Side = 256, *, octaves: Octaves = 4) -> Array:
    """Sum octaves of a map that repeats, each twice as often and half as strong.

    Formula: sum over o < octaves of map(x 2^o W / size, y 2^o H / size) / 2^o

    Parameters
    ----------
    values
        The map, shape (H, W) as [y, x].
    size
        Samples along each side of the sheet; 256 in the document.
    octaves
        How many are summed; 4 in the document, where the last shows the map sample by
        sample. Further ones leave samples out: the document allows them all the same.

    Returns
    -------
    Shape (size, size) as [y, x]. It repeats without a seam.

    Source: document C, OverlapOctaves (N17); E31.

    Examples
    --------
    >>> float(overlap_octaves([[256.0]], 8).max())
    480.0
    """
    values = _some(values)
    total = np.empty((size, size))
    for octave in range(octaves):
        # 1. An octave is one blown-up map, laid beside itself 2^o times both ways.
        #    Where the size is a power of two, places repeat exactly: one is enough.
        tiles = 2**octave if size & (size - 1) == 0 and size >= 2**octave else 1
        side = size // tiles
        tiled = total.reshape(tiles, side, tiles, side)
        # 2. Some rows at a time are added to all of their places at once.
        for rows, part in _blown_up(values, 2.0**octave / size, side):
            if octave == 0:  # by itself, and the first there
                total[rows] = part
                continue
            part *= 0.5**octave
            tiled[:, rows] += part[:, None]
    return total


def _blown_up(values: Array, scale: float, side: int) -> Iterator[tuple[slice, Array]]:
    """Give the first samples of a map seen `scale` maps apart, some rows at a time.

    Every row has the same places between the same columns: the map is interpolated
    along x once, for its few rows, and then between them. The numbers of
    `wrapped_bilinear`, and their order.
    """
    height, width = values.shape
    along = np.arange(side) * scale  # in maps, 1 is a whole one
    x0, x1, tx = _neighbours(along * width, width)
    y0, _, ty = _neighbours(along * height, height)
    lines = values[:, x0] + tx * (values[:, x1] - values[:, x0])  # (H, side)
    rise = np.roll(lines, -1, axis=0) - lines  # to the line above
    step = max(1, AT_ONCE // side)
    for first in range(0, side, step):
        rows = slice(first, first + step)
        part, change = lines.take(y0[rows], 0), rise.take(y0[rows], 0)
        change *= ty[rows, None]
        part += change
        yield rows, part


def _literal(values: Array, size: int, octaves: int) -> Array:
    """Sum octaves as the formula says it: each interpolated at every sample."""
    height, width = values.shape
    total = np.zeros((size, size))
    for octave in range(octaves):
        along = np.arange(size) * (2.0**octave / size)
        rows = along[:, np.newaxis] * height
        total += wrapped_bilinear(values, along * width, rows) / 2.0**octave
    return total


@checked
def exponential_filter(
    values: Annotated[Array, Range()],
    *,
    cover: Annotated[float, Range(0.0, 1e6, "grey levels")] = COVER,
    sharpness: Annotated[float, Range(0.0, 1.0)] = SHARPNESS,
) -> Array:
    """Turn a sum of octaves into cloud: clear below a level, ever denser above it.

    Formula: 255 - 255 sharpness^c, c = max(v - (255 - cover), 0)

    Parameters
    ----------
    values
        The sum of octaves, in the document's grey levels, not normalised.
    cover
        How far below 255 clouds begin.
    sharpness
        How much of the clear is left a grey level above that: 1 is never any cloud,
        0 a hard edge.

    Returns
    -------
    The cloud, in [0, 255], of the same shape.

    Source: document C, ExpFilter (N33).

    Examples
    --------
    >>> exponential_filter([235.0, 236.0]).round(9)
    array([ 0.  , 12.75])
    """
    return _filter(values.copy(), cover, sharpness)


def _filter(c: Array, cover: float, sharpness: float) -> Array:
    """Filter in place."""
    c -= WHITE - cover
    np.maximum(c, 0.0, out=c)
    if sharpness == 0.0:  # 0^0 is 1; its logarithm times 0 is nothing
        return WHITE - WHITE * sharpness**c
    # By the base's logarithm: numpy's power takes ten times as long as its exponential.
    c *= math.log(sharpness)
    np.exp(c, out=c)
    c *= -WHITE
    c += WHITE
    return c


@checked
def cloud_sheet(
    size: Side = 256,
    *,
    seed: Seed = 0,
    map_size: Side = 32,
    octaves: Octaves = 4,
    cover: Annotated[float, Range(0.0, 1e6, "grey levels")] = COVER,
    sharpness: Annotated[float, Range(0.0, 1.0)] = SHARPNESS,
    numbers: Numbers = "elias",
) -> Array:
    """Give document C's cloud: map, octaves and filter.

    Formula: exponential_filter(overlap_octaves(sheet_map(map_size), size))

    Parameters
    ----------
    size
        Samples along each side of the sheet; 256 in the document.
    seed
        Which pattern: the document's random.
    map_size
        Samples along each side of the map; 32 in the document.
    octaves
        How many are summed.
    cover
        How far below 255 clouds begin.
    sharpness
        How much of the clear is left a grey level above that.
    numbers
        The document's hash, "elias", or one whose seeds have nothing in common.

    Returns
    -------
    Shape (size, size) as [y, x], in [0, 255]. It repeats without a seam.

    Source: document C (N02, N06, N07, N14, N17, N33); E09, E31.

    Examples
    --------
    >>> cloud_sheet(16, seed=7).shape
    (16, 16)
    """
    small = sheet_map(map_size, seed=seed, numbers=numbers)
    total = overlap_octaves(small, size, octaves=octaves)
    return _filter(total, cover, sharpness)
