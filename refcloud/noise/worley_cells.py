"""The cells of Worley noise: the one point in each, and how far it can be.

The point of a cell is a hash of the cell and the seed, so the pattern has no edge and
no memory, and it repeats where the cell is taken modulo a period.
"""

from __future__ import annotations

import itertools
import math
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked, complaint
from refcloud.conventions import Array, Range, Seed
from refcloud.noise.hashing import uniform
from refcloud.noise.lattice import PERIOD, Cells, _cells

Feature = Literal["F1", "F2"]
Search = Literal["exact", "neighbours"]
Scale = Literal["none", "bound", "inverted", "clip"]
DType = Literal["float64", "float32"]
Period = Annotated[int, Range(1, 2**32)]
Reals = NDArray[Any]  # float64 or float32, as the caller asks

WHOLE = int(PERIOD)  # cells after which every hash repeats

# The square of the largest distance (in cells) by feature and number of axes. F1: the
# own cell's point can lie in the opposite corner. F2: in space the same corner, where
# eight cells meet; in the plane the middle of a cell whose side neighbours' points lie
# in their farthest corners, at 3/2 and 1/2.
BOUND_SQUARED = {("F1", 2): 2.0, ("F1", 3): 3.0, ("F2", 2): 2.5, ("F2", 3): 3.0}


@checked
def worley_points(*cells: Any, seed: Seed = 0, period: Period | None = None) -> Array:
    """Give the random point of each cell, where it lies in its cell.

    Formula: uniform(cell, axis, seed) for each axis

    Parameters
    ----------
    cells
        Whole numbers along x, y and perhaps z, which broadcast. Taken modulo the
        period.
    seed
        Which pattern.
    period
        After how many cells the pattern repeats, along every axis. None is 2^32.

    Returns
    -------
    Shape (..., 2) or (..., 3), in [0, 1); the point itself is cell + this.

    Raises
    ------
    TypeError
        A cell is not whole.

    Source: document D (N27, N29).

    Examples
    --------
    >>> bool((worley_points(-1, 3, period=8) == worley_points(7, 11, period=8)).all())
    True
    """
    if len(cells) not in (2, 3):
        raise TypeError(complaint("cells", "two or three", f"{len(cells)}"))
    whole = [np.asarray(c) for c in cells]
    for c in whole:
        if c.dtype.kind not in "iu":
            raise TypeError(complaint("cells", "whole numbers", f"{c.dtype}"))
    most = WHOLE if period is None else period
    wide = [c.astype(np.int64 if c.dtype.kind == "i" else np.uint64) for c in whole]
    words = np.broadcast_arrays(*(np.mod(c, c.dtype.type(most)) for c in wide))
    return np.moveaxis(_places(list(words), seed), 0, -1)


@checked
def worley_bound(dimensions: Annotated[int, Range(2, 3)], feature: Feature) -> float:
    """Give the largest distance that Worley noise can take, in cells.

    Formula: F1: sqrt(n), the diagonal of a cell; F2: sqrt(5/2) in the plane, sqrt(3)
    in space

    Parameters
    ----------
    dimensions
        Number of axes: 2 or 3.
    feature
        Nearest point, "F1", or second nearest, "F2".

    Returns
    -------
    The bound, which no distance reaches and some come as near to as one likes.

    Source: document D says "max distance" of the picture; E33.

    Examples
    --------
    >>> worley_bound(3, "F1") == 3**0.5
    True
    """
    return math.sqrt(BOUND_SQUARED[feature, dimensions])


def _places(cells: list[NDArray[Any]], seed: int) -> Array:
    """Give where the points of reduced cells lie in them, axis first."""
    rank = max(c.ndim for c in cells)
    axes = np.arange(len(cells)).reshape(-1, *(1,) * rank)
    return uniform(*cells, axes, seed=seed)


def _wrapped(cells: Cells, period: int | None) -> Cells:
    """Take cells modulo the period: what their hash sees."""
    return np.mod(cells, WHOLE if period is None else period)


def _split(coordinates: Array, period: int | None) -> tuple[Cells, Array]:
    """Split finite coordinates into cell and place in it, exactly."""
    most = float(WHOLE if period is None else period)
    if coordinates.size and max(-coordinates.min(), coordinates.max()) >= most:
        coordinates = np.fmod(coordinates, most)  # exact, and keeps the sign
    return _cells(coordinates)


def _offsets(n: int, reach: int, beyond: int = -1) -> list[tuple[int, ...]]:
    """List the steps to cells within reach along each axis, and beyond another."""
    steps = itertools.product(range(-reach, reach + 1), repeat=n)
    return [step for step in steps if max(map(abs, step)) > beyond]


def _scaled(found: NDArray[Any], feature: str, n: int, normalize: str) -> NDArray[Any]:
    if normalize == "none":
        return found
    if normalize == "clip":
        return np.minimum(found, found.dtype.type(1))
    bound = found.dtype.type(math.sqrt(BOUND_SQUARED[feature, n]))
    # Rounding may pass the bound by a last bit; a share may not pass 1.
    share = np.minimum(found / bound, found.dtype.type(1))
    return 1 - share if normalize == "inverted" else share
