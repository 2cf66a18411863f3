"""Scattered points some at a time: what is not finite gives NaN and spoils no other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array, MayBeNotFinite, Shape
from refcloud.refusal import complaint

Dtype = Literal["float64", "float32"]
Places = Annotated[Array, Shape("...", "N"), MayBeNotFinite]
Numbers = NDArray[Any]  # float64 or float32, as the caller asked

# Points at a time, twice as many in float32: their corners stay in the cache, and a
# hundred calls of numpy, at half a microsecond, cost a point 2 to 3 ns.
CHUNK = 1 << 14
PERIOD = 2.0**32  # lattice coordinates wrap here, for every hash


class _Room:
    """Arrays that chunk after chunk is worked out in.

    Memory that is fresh for each chunk costs as much as the work: the system clears
    its pages. A room serves one call: its hashed lines are those of one seed and hash.
    """

    def __init__(self) -> None:
        self.arrays: dict[str, Numbers] = {}
        # Hashed lattice lines of each axis, and how each differs from the next.
        self.lines: list[tuple[NDArray[Any], NDArray[Any]]] = []
        self.ends: tuple[Array, Array]

    def take(self, name: str, shape: tuple[int, ...], dtype: Any) -> Numbers:
        """Give the array of that name, its numbers as they were left."""
        array = self.arrays.get(name)
        if array is None or array.shape != shape or array.dtype != dtype:
            array = self.arrays[name] = np.empty(shape, dtype)
        return array


def _dimensions(points: Array, allowed: tuple[int, ...]) -> int:
    """Give how many coordinates a place has, refused where the noise has no such."""
    count = points.shape[-1]
    if count not in allowed:
        shapes = " or ".join(f"(..., {n})" for n in allowed)
        expected = f"an array of shape {shapes}"
        raise ValueError(complaint("points", expected, f"shape {points.shape}"))
    return count


def _scattered(
    points: Array,
    noise: Callable[[Array], Any],
    dtype: Dtype,
    period: int | None = None,
    results: int = 1,
    inside: bool = False,
) -> Numbers:
    """Apply noise to the finite points; shape (..., results), or (...,) for one.

    The noise gets the coordinates in rows, shape (N, n), taken modulo the period, and
    gives one result or a row of results. `inside` says that all are known to be finite
    and within the period: then the noise gets the points themselves, to read.
    """
    flat = points.reshape(-1, points.shape[-1])
    out = np.empty((results, len(flat)), dtype)
    most = PERIOD if period is None else float(period)
    step = _chunk(dtype)
    for first in range(0, len(flat), step):
        part = slice(first, first + step)
        chunk = flat[part]
        if inside:
            out[:, part] = noise(chunk.T)
            continue
        # A comparison with NaN does not hold.
        if max(-chunk.min(), chunk.max()) < most:
            out[:, part] = noise(chunk.T.copy())
            continue
        rows = np.isfinite(chunk).all(axis=1)
        out[:, part] = np.nan
        if rows.any():
            out[:, part][:, rows] = noise(np.fmod(chunk[rows].T, most))
    if results == 1:
        return out[0].reshape(points.shape[:-1])[()]
    return np.ascontiguousarray(out.T).reshape(*points.shape[:-1], results)


def _chunk(dtype: Dtype) -> int:
    """Give how many points are worked on at a time."""
    return 2 * CHUNK if dtype == "float32" else CHUNK


def _bounds(points: Array, period: int | None) -> Iterator[NDArray[np.int64]]:
    """Give the lowest and highest cells along each axis, (N, 2), of points in a period.

    First those of a cube around all, which is quick to find, then those of a tight box;
    none where any point is not finite or lies beyond the period.
    """
    if not points.size:
        return
    low, high = points.min(), points.max()
    if not max(-low, high) < (PERIOD if period is None else float(period)):
        return
    columns = points.reshape(-1, points.shape[-1]).T
    yield np.floor([[low, high]] * len(columns)).astype(np.int64)
    ends = [(column.min(), column.max()) for column in columns]
    yield np.floor(ends).astype(np.int64)


def _split(
    reduced: Array, dtype: Dtype = "float64"
) -> tuple[NDArray[np.int64], Numbers]:
    """Split coordinates into the cell and the place in it: floor, as a cast mirrors.

    The place is found in float64, and rounded to the dtype after that (E14).
    """
    floor = np.floor(reduced)
    return floor.astype(np.int64), (reduced - floor).astype(dtype, copy=False)


def _floored(columns: Array, room: _Room) -> Array:
    """Give the cells of coordinates (N, n), still floats, in the coordinates' order."""
    if columns.flags.c_contiguous:
        return np.floor(columns, out=room.take("rows", columns.shape, float))
    return np.floor(columns, out=room.take("cells", columns.T.shape, float).T)


def _places(columns: Array, cells: Array, dtype: Dtype, room: _Room) -> Numbers:
    """Give the places of coordinates (N, n) in their cells, which are overwritten.

    Passes follow the memory of the coordinates; rounding the places lays them in rows.
    """
    places = room.take("places", columns.shape, dtype)
    places[...] = np.subtract(columns, cells, out=cells)
    return places


def _index(cells: Array, low: list[int], steps: NDArray[np.int64]) -> NDArray[np.intp]:
    """Give the place of cells (N, n) in a flat box that starts at low.

    A coordinate is below 2^32, and a step along it at most half the box, 2^20: whole
    numbers whose sum is below 2^53 are exact as float64, where they multiply faster.
    """
    index = steps.astype(np.float64) @ cells
    if start := sum(int(s) * c for s, c in zip(steps, low, strict=True)):
        index -= start
    return index.astype(np.intp)


def _wrapped(cells: NDArray[np.int64], period: int | None) -> NDArray[np.int64]:
    """Repeat lattice coordinates after the period, where there is one."""
    return cells if period is None else np.mod(cells, period)
