"""Document C's small map of grey levels, which repeats without a seam.

Values are 128 + 128 g, which is in (0, 256]: its text says 0 to 255 (E31). A border of
samples from the opposite side lets the smoothing wrap; the document calls it mirroring.
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
Grey = Annotated[Array, Shape("H", "W")]

MIDDLE = 128.0  # grey level of a random number 0, and the distance of 1 from it


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
    values = _some(values)
    height, width = values.shape
    across = values.take(range(-1, width + 1), axis=1, mode="wrap")
    return across.take(range(-1, height + 1), axis=0, mode="wrap")


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
