"""Which layers of a picture meet in a pixel: those alone share a tolerance there.

A layer that does not reach a pixel leaves it as it is, and so does every saving in it.
What a pixel is off by is then the sum over the layers that do reach it, each seen
through those in front, which let 1 pass at most. Pixels are looked at in tiles; a tile
counts as reached where any of it may be.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import AnyCamera, project
from refcloud.conventions import Array
from refcloud.raster.tile_lists import SIDE, Discs, ranges_of

Reached = NDArray[np.bool_]  # tiles, by row and column


def reached_by_discs(discs: Discs, width: int, height: int) -> Reached:
    """Tell which tiles hold pixels of the discs' bounding squares.

    Parameters
    ----------
    discs
        Any number of them.
    width, height
        Size of the picture, pixels.
    """
    ranges = ranges_of(discs, width, height)
    some = ranges.tiles() > 0
    left, right, top, bottom = (
        ends[some] for ends in (ranges.left, ranges.right, ranges.top, ranges.bottom)
    )
    # A square counts 1 from its corner on, and what lies past it takes that back.
    count = np.zeros((-(-height // SIDE) + 1, -(-width // SIDE) + 1), np.int64)
    for row, column, more in (
        (top, left, 1),
        (bottom, right, 1),
        (top, right, -1),
        (bottom, left, -1),
    ):
        np.add.at(count, (row, column), more)
    return count.cumsum(axis=0).cumsum(axis=1)[:-1, :-1] > 0


def reached_by_box(lower: Array, upper: Array, camera: AnyCamera) -> Reached:
    """Tell which tiles may show a box: all of them where it reaches behind the eye.

    Parameters
    ----------
    lower, upper
        Its corners, shape (3,), scene units.
    camera
        The eye.
    """
    reached = np.zeros((-(-camera.height // SIDE), -(-camera.width // SIDE)), bool)
    corners = np.array(list(itertools.product(*zip(lower, upper, strict=True))))
    x, y, depth, scale = project(camera, corners)
    if min(depth.min(), scale.min()) <= 0.0:
        reached[:] = True
        return reached
    # A box before the eye lies within what its corners span; a pixel more for rounding.
    ends = []
    for place, size in ((x, camera.width), (y, camera.height)):
        low, high = (
            np.clip(place.min() - 1.0, 0.0, size),
            np.clip(place.max() + 1.0, 0.0, size),
        )
        ends.append(slice(int(low // SIDE), int(-(-high // SIDE))))
    reached[ends[1], ends[0]] = True
    return reached


def together(layers: Sequence[Reached]) -> Reached:
    """Give each set of layers that meet in some tile, shape (sets, layers).

    Parameters
    ----------
    layers
        The tiles that each reaches, of one shape.
    """
    return np.unique(np.stack([each.ravel() for each in layers], axis=1), axis=0)


def most_together(sets: Reached) -> int:
    """Give how many layers meet at most; at least 1."""
    return max(int(sets.sum(axis=1).max(initial=0)), 1)


def shares_of(layers: Sequence[Reached]) -> list[float]:
    """Split a tolerance: in no tile the layers that meet have more than all of it.

    A layer of many tiles has more to save. Shares go with the square root of their
    number: with the number itself small layers would be left none for float32.

    Parameters
    ----------
    layers
        The tiles that each reaches, of one shape.

    Returns
    -------
    A share for each, above 0.
    """
    weights = np.sqrt([max(int(np.count_nonzero(each)), 1) for each in layers])
    sets = together(layers)
    sums = sets @ weights
    return [
        float(weight / max(sums[theirs].max(initial=0.0), weight))
        for weight, theirs in zip(weights, sets.T, strict=True)
    ]
