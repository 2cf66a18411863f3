"""Worley noise on a grid: whole planes of samples meet one neighbour cell at a time.

All cells that hold as many samples along each axis are laid side by side, on the last
axis of every array. For each of the 9 or 27 neighbours the squares of the distances
along x, y and z are few (samples per cell, not samples), and one sum and one minimum of
long rows are all that each sample costs. Those few samples whose nearest point may lie
beyond the neighbours are looked at again, one by one.
"""

from __future__ import annotations

import itertools
import math
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Seed, Shape
from refcloud.noise.worley_cells import (
    DType,
    Feature,
    Period,
    Reals,
    Scale,
    Search,
    _offsets,
    _scaled,
    _wrapped,
    worley_points,
)
from refcloud.noise.worley_ring import Doubtful, _face_squared, _joined, _meet_ring
from refcloud.noise.worley_runs import _blocks, _Runs, _runs
from refcloud.noise.worley_search import _lattice

TABLE = 1 << 15  # cells of a block times samples along an axis: tables of 10 to 20 MB
TILE = 1 << 16  # samples in one step: sum and minimum stay in a core's cache


@checked
def worley_grid(
    x: Annotated[Array, Shape("W")],
    y: Annotated[Array, Shape("H")],
    z: Annotated[Array, Shape("D")] | None = None,
    *,
    seed: Seed = 0,
    period: Period | None = None,
    feature: Feature = "F1",
    search: Search = "exact",
    normalize: Scale = "none",
    dtype: DType = "float64",
) -> Reals:
    """Give Worley noise on a grid: `worley` at every place, many times faster.

    Formula: F[k, j, i] = the smallest or second smallest of dx[i]^2 + dy[j]^2 + dz[k]^2
    over the points of the cells around, square root of it

    Parameters
    ----------
    x, y, z
        Coordinates along each axis, in cells. Any order, any spacing, finite: the
        number of samples and the size of the cells have nothing to do with each other.
        Without z the noise is that of the plane.
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
    Shape (D, H, W) as [z, y, x], or (H, W) as [y, x].

    Source: document D (N26-N29); E32, E33.

    Examples
    --------
    >>> worley_grid(np.arange(4) / 2, np.arange(3) / 2, seed=7, period=2).shape
    (3, 4)
    """
    axes = [_runs(c, period) for c in ((x, y) if z is None else (x, y, z))]
    shape = tuple(axis.size for axis in reversed(axes))
    out: Reals = np.empty(shape, dtype)
    if out.size:
        most = max(1, TABLE // max(axis.samples for axis in axes))
        doubtful: list[Doubtful] = []
        for block in _blocks(axes, most):
            doubtful += _fill(out, block, seed, period, feature == "F2")
            if search == "neighbours":
                doubtful.clear()
        if doubtful:
            far = _joined(doubtful)
            _meet_ring(far, seed, period)
            out[tuple(far.place[::-1])] = np.sqrt(far.found[-1])
    return _scaled(out, feature, len(axes), normalize)


def _literal(
    axes: list[Array], seed: int, period: int | None, feature: Feature
) -> Array:
    """Give Worley noise of a grid: a sum of squares for every cell that can count."""
    # Along x, y (and z) the places stand on the last axis, the one before, and so on.
    lines = [axis.reshape(-1, *[1] * k) for k, axis in enumerate(axes)]
    squares = []
    for step in itertools.product(range(-2, 3), repeat=len(axes)):
        near = [
            np.floor(line).astype(np.int64) + s
            for line, s in zip(lines, step, strict=True)
        ]
        places = worley_points(*near, seed=seed, period=period)
        apart = [c + places[..., k] - lines[k] for k, c in enumerate(near)]
        squares.append(np.sum(np.square(apart), axis=0))
    return np.sqrt(np.sort(squares, axis=0)[0 if feature == "F1" else 1])


def _fill(
    out: Reals, axes: list[_Runs], seed: int, period: int | None, second: bool
) -> list[Doubtful]:
    """Fill a block of the output from the neighbours, and list what may be nearer."""
    squares = _squares(axes, seed, period, out.dtype)
    across, along = squares[1], squares[0]
    rows, length, cells = across.shape[1], along.shape[1], along.shape[2]
    found = [np.empty((rows, length, cells), out.dtype) for _ in range(1 + second)]
    step = max(1, TILE // (length * cells))
    doubtful = []
    for plane in range(axes[2].samples if len(axes) == 3 else 1):
        if len(axes) == 3:
            across = squares[1] + squares[2][:, plane, np.newaxis]
        for first in range(0, rows, step):
            part = slice(first, first + step)
            _sweep([f[part] for f in found], along, across[:, part])
        doubtful.append(_doubtful_of(found, axes, plane))
        _write(out, np.sqrt(found[-1]), axes, plane)
    return doubtful


def _squares(
    axes: list[_Runs], seed: int, period: int | None, dtype: np.dtype
) -> list[Reals]:
    """Give the squared distances along each axis, as (neighbour, sample, cell).

    Cells are all combinations of the axes' runs, x fastest.
    """
    n = len(axes)
    # Hash the points of the block's cells and their neighbours, each once.
    around = [axis.cells + np.array([[-1], [0], [1]]) for axis in axes]
    lines = [np.unique(near) for near in around]
    points = _lattice([_wrapped(line, period) for line in lines], seed, dtype)
    where = [np.searchsorted(*pair) for pair in zip(lines, around, strict=True)]
    cells = math.prod(len(axis.cells) for axis in axes)
    steps = _offsets(n, 1)
    squares = [np.empty((len(steps), a.samples, cells), dtype) for a in axes]
    for i, step in enumerate(steps):
        wanted = np.ix_(*(where[axis][step[axis] + 1] for axis in reversed(range(n))))
        for axis, s in enumerate(step):
            point = points[axis][wanted]
            place = (
                axes[axis]
                .places.astype(dtype)
                .reshape(
                    -1, *(len(a.cells) if a is axes[axis] else 1 for a in axes[::-1])
                )
            )
            distance = (point + dtype.type(s) - place).reshape(-1, cells)
            np.multiply(distance, distance, out=squares[axis][i])
    return squares


def _sweep(found: list[Reals], along: Reals, across: Reals) -> None:
    """Keep the smallest (and second smallest) sum of squares over the neighbours."""
    first = found[0]
    sums, larger = np.empty_like(first), np.empty_like(first)
    for f in found:
        f.fill(np.inf)
    for i in range(len(along)):
        np.add(along[i], across[i][:, np.newaxis], out=sums)
        if len(found) == 2:
            np.maximum(first, sums, out=larger)
            np.minimum(found[1], larger, out=found[1])
        np.minimum(first, sums, out=first)


def _doubtful_of(found: list[Reals], axes: list[_Runs], plane: int) -> Doubtful:
    """Find the doubtful samples of a plane, as `refcloud.noise.worley_ring` does."""
    y, x, cell = np.nonzero(found[-1] > 1)
    sample = [x, y, np.full_like(x, plane)]
    runs = np.unravel_index(cell, [len(a.cells) for a in axes[::-1]])[::-1]
    t = np.array([a.places[s, r] for a, s, r in zip(axes, sample, runs, strict=False)])
    t = t.astype(found[0].dtype, copy=False)
    far = found[-1][y, x, cell] > _face_squared(t)
    chosen = [(a, s[far], r[far]) for a, s, r in zip(axes, sample, runs, strict=False)]
    return Doubtful(
        np.array([a.index[s, r] for a, s, r in chosen]),
        np.array([f[y[far], x[far], cell[far]] for f in found]),
        np.array([a.cells[r] for a, _, r in chosen]),
        t[:, far],
    )


def _write(out: Reals, plane: Reals, axes: list[_Runs], k: int) -> None:
    """Write a plane of samples, (sample y, sample x, cell), where it belongs."""
    x, y = axes[:2]
    shape = (y.samples, x.samples, -1, len(y.cells), len(x.cells))
    values = plane.reshape(shape).transpose(2, 3, 0, 4, 1)  # layer, then y, then x
    layers = axes[2].index[k] if len(axes) == 3 else np.zeros(1, np.intp)
    target = out if len(axes) == 3 else out[np.newaxis]
    wy, wx = y.target(), x.target()
    if isinstance(wy, slice) and isinstance(wx, slice):
        for layer, value in zip(layers, values, strict=True):
            target[layer, wy, wx].reshape(value.shape)[...] = value
    else:
        rows, columns = (
            np.arange(w.start, w.stop) if isinstance(w, slice) else w for w in (wy, wx)
        )
        flat = values.reshape(len(layers), rows.size, columns.size)
        target[np.ix_(layers, rows, columns)] = flat
