"""The ring of cells beyond the neighbours, for those few samples that need it (E32)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.noise.lattice import Cells
from refcloud.noise.worley_cells import Reals, _offsets, _places, _wrapped

BATCH = 1 << 11  # samples at a time: each is compared with the 98 boxes of a ring


@dataclass(frozen=True)
class Doubtful:
    """Samples to which a point beyond the neighbours may be nearer."""

    place: NDArray[np.intp]  # where they stand in the result, shape (..., N)
    found: Reals  # squares of F1 (and F2) so far, shape (1 or 2, N)
    cells: Cells  # their cells, shape (n, N)
    t: Reals  # their places in their cells, shape (n, N)


def _doubtful(
    found: Sequence[Reals], cells: Sequence[Cells], t: Sequence[Reals], first: int
) -> Doubtful:
    """Find the doubtful ones among samples; first is the place of the first."""
    # No face of the neighbours is nearer than one cell: most samples end here.
    far = np.flatnonzero(found[-1] > 1)
    near = np.array([place[far] for place in t])
    doubt = found[-1][far] > _face_squared(near)
    far = far[doubt]
    return Doubtful(
        far + first,
        np.array([f[far] for f in found]),
        np.array([c[far] for c in cells]),
        near[:, doubt],
    )


def _face_squared(t: Reals) -> Reals:
    """Give the squared distance to the neighbours' outer faces, places axis first."""
    face = 1 + np.minimum(t, 1 - t).min(axis=0)
    return face * face


def _joined(doubtful: list[Doubtful]) -> Doubtful:
    place, found, cells, t = (
        np.concatenate([getattr(d, name) for d in doubtful], axis=-1)
        for name in ("place", "found", "cells", "t")
    )
    return Doubtful(place, found, cells, t)


def _meet_ring(far: Doubtful, seed: int, period: int | None) -> None:
    """Let the points of the ring take their places among the nearest."""
    for first in range(0, far.t.shape[1], BATCH):
        some = (slice(None), slice(first, first + BATCH))
        _meet_batch(list(far.found[some]), far.cells[some], far.t[some], seed, period)


def _meet_batch(
    nearest: list[Reals], cells: Cells, t: Reals, seed: int, period: int | None
) -> None:
    n, one = len(t), t.dtype.type(1)
    steps = np.array(_offsets(n, 2, beyond=1))
    # How far the cells -2 to 2 steps off are along each axis, squared.
    gaps = np.array([one + t, t, 0 * t, one - t, one + (one - t)]) ** 2
    gap = sum(gaps[steps[:, axis] + 2, axis] for axis in range(n))
    which, sample = np.nonzero(gap < nearest[-1])
    away = steps[which].T
    near = [_wrapped(cells[axis, sample] + away[axis], period) for axis in range(n)]
    q = _places([c.astype(np.uint64) for c in near], seed).astype(t.dtype, copy=False)
    q = [c + away[i].astype(t.dtype) - t[i, sample] for i, c in enumerate(q)]
    squared = _squared_length(q)
    # The smallest of each sample takes its place first, then the second smallest.
    order = np.lexsort((squared, sample))
    sample, squared = sample[order], squared[order]
    rank = np.arange(sample.size) - np.searchsorted(sample, sample)
    for place in range(len(nearest)):
        chosen = rank == place
        better = [f[sample[chosen]] for f in nearest]
        _keep(better, squared[chosen], second=len(nearest) == 2)
        for f, b in zip(nearest, better, strict=True):
            f[sample[chosen]] = b


def _squared_length(q: list[Reals]) -> Reals:
    """Square and add along the axes, x last, in place."""
    for component in q:
        component *= component
    total = q[-1]
    for component in q[-2::-1]:
        total += component
    return total


def _keep(found: list[Reals], squared: Reals, second: bool) -> None:
    """Let a distance take its place among the smallest one or two."""
    if not found:
        found.append(squared)
    elif not second:
        np.minimum(found[0], squared, out=found[0])
    elif len(found) == 1:
        found.append(np.maximum(found[0], squared))
        np.minimum(found[0], squared, out=found[0])
    else:
        larger = np.maximum(found[0], squared)
        np.minimum(found[0], squared, out=found[0])
        np.minimum(found[1], larger, out=found[1])
