"""The ring of cells beyond the neighbours, for those few samples that need it (E32)."""

from __future__ import annotations

import numpy as np

from refcloud.noise.lattice import Cells
from refcloud.noise.worley_cells import Reals, _offsets, _places, _wrapped

BATCH = 1 << 11  # samples at a time: each is compared with the 98 boxes of a ring


def _look_further(
    found: list[Reals], cells: Cells, t: Reals, seed: int, period: int | None
) -> None:
    """Meet the ring of cells beyond the neighbours where a point there may be nearer.

    Squares are those of F1 (and F2); cells and places are axis first, shape (n, N).
    """
    # No face of the neighbours is nearer than one cell: most samples end here.
    (far,) = np.nonzero(found[-1] > 1)
    face = 1 + np.minimum(t[:, far], 1 - t[:, far]).min(axis=0)
    far = far[found[-1][far] > face * face]
    for first in range(0, far.size, BATCH):
        some = far[first : first + BATCH]
        nearest = [f[some] for f in found]
        _meet_ring(nearest, cells[:, some], t[:, some], seed, period)
        for f, n in zip(found, nearest, strict=True):
            f[some] = n


def _meet_ring(
    nearest: list[Reals], cells: Cells, t: Reals, seed: int, period: int | None
) -> None:
    """Let the points of the ring take their places among the nearest."""
    n, one = len(t), t.dtype.type(1)
    steps = np.array(_offsets(n, 2, beyond=1))
    # How far the cells -2 to 2 steps off are along each axis, squared.
    gaps = np.array([one + t, t, 0 * t, one - t, one + (one - t)]) ** 2
    gap = sum(gaps[steps[:, axis] + 2, axis] for axis in range(n))
    which, sample = np.nonzero(gap < nearest[-1])
    away = steps[which].T
    near = [_wrapped(cells[axis, sample] + away[axis], period) for axis in range(n)]
    q = _places([c.astype(np.uint64) for c in near], seed).astype(t.dtype, copy=False)
    q = list(q + (away - t[:, sample]).astype(t.dtype, copy=False))
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
