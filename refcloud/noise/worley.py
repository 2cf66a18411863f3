"""Worley noise: the distance to the nearest of random points, one in each cell."""

from __future__ import annotations

import itertools
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked, complaint
from refcloud.conventions import Array, MayBeNotFinite, Seed, Shape
from refcloud.noise.worley_cells import (
    DType,
    Feature,
    Period,
    Scale,
    Search,
    _scaled,
    worley_points,
)
from refcloud.noise.worley_search import _scattered


@checked
def worley(
    points: Annotated[Array, Shape("...", "n"), MayBeNotFinite],
    *,
    seed: Seed = 0,
    period: Period | None = None,
    feature: Feature = "F1",
    search: Search = "exact",
    normalize: Scale = "none",
    dtype: DType = "float64",
) -> NDArray[Any]:
    """Give Worley noise at scattered points, in the plane or in space.

    Formula: F1(p) = the smallest, F2(p) = the second smallest |p - q| of all q, where
    each cell holds one point q = cell + uniform(cell, axis, seed)

    Parameters
    ----------
    points
        Shape (..., 2) or (..., 3), in cells. Any finite place; NaN or infinity gives
        NaN.
    seed
        Which pattern.
    period
        After how many cells the pattern repeats, along every axis. None does not
        repeat (but at 2^32, as all noise here).
    feature
        Distance to the nearest point, "F1", or to the second nearest, "F2". Of a
        pattern that repeats, each copy of a point counts.
    search
        Which cells are looked at. "exact" as many as it needs; "neighbours" the own
        cell and those around it, up to sqrt(n) - 1 too far (E32).
    normalize
        What becomes of the distance. "none" leaves it, in cells; "bound" divides by the
        largest possible one, "inverted" takes that from 1; "clip" cuts at one cell.
    dtype
        Type of the arithmetic and the result: "float64" or "float32".

    Returns
    -------
    Shape (...,).

    Raises
    ------
    ValueError
        The points have neither two nor three coordinates.

    Source: document D (N26-N29); E32, E33.

    Examples
    --------
    >>> worley(np.zeros((4, 5, 3)), seed=7, period=8).shape
    (4, 5)
    """
    n = points.shape[-1]
    if n not in (2, 3):
        raise ValueError(
            complaint("points", "two or three coordinates", f"shape {points.shape}")
        )
    flat = points.reshape(-1, n)
    found = _scattered(
        flat, seed, period, feature == "F2", search == "exact", np.dtype(dtype)
    )
    return _scaled(found, feature, n, normalize).reshape(points.shape[:-1])[()]


def _literal(points: Array, seed: int, period: int | None, feature: Feature) -> Array:
    """Give Worley noise as its formula says it: every cell that can count, at once."""
    cells = np.floor(points).astype(np.int64)
    squares = []
    for step in itertools.product(range(-2, 3), repeat=points.shape[-1]):
        near = cells + step
        places = worley_points(*np.moveaxis(near, -1, 0), seed=seed, period=period)
        squares.append(np.sum((near + places - points) ** 2, axis=-1))
    return np.sqrt(np.sort(squares, axis=0)[0 if feature == "F1" else 1])
