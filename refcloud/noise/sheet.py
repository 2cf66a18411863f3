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

from typing import Annotated, Literal

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Range, Seed, Shape
from refcloud.noise.hashing import elias2d, lattice_random
from refcloud.noise.lattice import Cells

Numbers = Literal["elias", "hashed"]
Side = Annotated[int, Range(1, 1 << 13, "samples")]
Octaves = Annotated[int, Range(1, 16)]
Grey = Annotated[Array, Shape("H", "W")]

MIDDLE = 128.0  # grey level of a random number 0, and the distance of 1 from it
WHITE = 255.0  # what the filter approaches
COVER, SHARPNESS = 20.0, 0.95  # the document's filter


@checked
def sheet_map(size: Side = 32, *, seed: Seed = 0, numbers: Numbers = "elias") -> Array:
    """Give document C's small map: random grey levels, wrapped and smoothed.

    Formula: centre/4 + sides/8 + corners/16 of 128 + 128 g(x, y), x and y from 1

    Parameters
    ----------
    size
        Samples along each side; 32 in the document.
    seed
        Which pattern: the document's random.
    numbers
        Where the numbers come from. "elias" is the document's hash, whose seeds are
        parts of one pattern (E09); "hashed" gives each seed a pattern of its own.

    Returns
    -------
    Shape (size, size) as [y, x], in (0, 256]. It repeats without a seam.

    Source: document C, SetNoise (N02, N06, N07); E09, E31.

    Examples
    --------
    >>> sheet_map(seed=7).shape
    (32, 32)
    """
    x, y = np.arange(1, size + 1), np.arange(1, size + 1)[:, np.newaxis]
    if numbers == "elias":
        g = elias2d(x, y, seed=seed)
    else:
        g = lattice_random(x, y, 0, seed=seed)
    h = wrap_halo(MIDDLE + MIDDLE * g)
    sides = h[:-2, 1:-1] + h[2:, 1:-1] + h[1:-1, :-2] + h[1:-1, 2:]
    corners = h[:-2, :-2] + h[:-2, 2:] + h[2:, :-2] + h[2:, 2:]
    return h[1:-1, 1:-1] / 4.0 + sides / 8.0 + corners / 16.0


@checked
def wrap_halo(values: Grey) -> Array:
    """Give a map with one more sample on each side, taken from the side opposite.

    Formula: out[j + 1, i + 1] = values[j mod H, i mod W]

    Parameters
    ----------
    values
        The map, shape (H, W), at least one sample along each side.

    Returns
    -------
    Shape (H + 2, W + 2): 34 by 34 in the document.

    Source: document C, Seamless cloud (N07).

    Examples
    --------
    >>> wrap_halo([[1.0, 2.0]])[0]
    array([2., 1., 2., 1.])
    """
    return np.pad(_some(values), 1, mode="wrap")


@checked
def wrapped_bilinear(
    values: Grey, x: Annotated[Array, Range()], y: Annotated[Array, Range()]
) -> Array:
    """Interpolate in a map that repeats.

    Formula: bot + Yfrac (top - bot), bot = m(X0, Y0) + Xfrac (m(X1, Y0) - m(X0, Y0)),
    top the same at Y1, all places modulo the map's size

    Parameters
    ----------
    values
        The map, shape (H, W) as [y, x], at least one sample along each side.
    x, y
        Places in samples, which broadcast. Any finite ones; the document's (int) casts
        hold for positive ones alone, floor holds for all.

    Returns
    -------
    The values there, of the broadcast shape.

    Source: document C, Interpolate (N14).

    Examples
    --------
    >>> float(wrapped_bilinear([[0.0, 8.0]], 1.25, 0.0))
    6.0
    """
    values = _some(values)
    x0, x1, tx = _neighbours(x, values.shape[1])
    y0, y1, ty = _neighbours(y, values.shape[0])
    bot = values[y0, x0] + tx * (values[y0, x1] - values[y0, x0])
    top = values[y1, x0] + tx * (values[y1, x1] - values[y1, x0])
    return bot + ty * (top - bot)


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
    height, width = values.shape
    total = np.zeros((size, size))
    for octave in range(octaves):
        along = np.arange(size) * (2.0**octave / size)  # in maps, 1 is a whole one
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
    c = np.maximum(values - (WHITE - cover), 0.0)
    return WHITE - WHITE * sharpness**c


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
    return exponential_filter(total, cover=cover, sharpness=sharpness)


def _some(values: Array) -> Array:
    """Refuse an empty map."""
    if not values.size:
        raise ValueError(
            "values: expected at least one sample along each side,"
            f" got shape {values.shape}"
        )
    return values


def _neighbours(places: Array, size: int) -> tuple[Cells, Cells, Array]:
    """Give the samples on both sides of places on a circle, and the place between."""
    reduced = np.fmod(places, float(size))
    floor = np.floor(reduced)
    cells = floor.astype(np.int64)
    return np.mod(cells, size), np.mod(cells + 1, size), reduced - floor
