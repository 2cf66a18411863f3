"""Which rays of a march are integrated exactly, to check the others by."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.march.box import slabs
from refcloud.march.quadrature import columns
from refcloud.march.task import Task
from refcloud.noise import uniform

CHECKED = 256  # rays of the hashed sample
AT_ONCE = 2 * CHECKED  # rays that are looked at for it together
# Rays that are looked at for it at most; of fewer, each one. A small cloud in a large
# picture is met by few of them: then all that meet it are checked.
DRAWN = 64 * CHECKED
EDGES = 48  # rays where a picture is steepest
LEVEL = 1e-6  # steps below it are taken together
FOLLOWED = 64  # rays whose neighbours are looked at, in all rounds together


def chosen_rays(task: Task) -> NDArray[np.intp]:
    """Choose rays that meet density, by a hash of their number."""
    count = len(task.origins)
    drawn = np.arange(count)
    if count > DRAWN:
        hashed = uniform(np.arange(DRAWN), seed=0) * count
        drawn = np.unique(hashed.astype(np.intp))
    grid = task.grid
    lower = grid.lower + (grid.first + 0.5) * grid.size
    upper = grid.lower + (grid.last + 0.5) * grid.size
    t0, t1 = slabs(task.origins[drawn], task.directions[drawn], lower, upper, 0.0)
    drawn = drawn[t1 > t0]
    drawn = drawn[np.argsort(uniform(drawn, seed=0), kind="stable")]
    chosen = drawn[:0]
    for start in range(0, len(drawn), AT_ONCE):
        some = drawn[start : start + AT_ONCE]
        held = columns(grid, task.origins[some], task.directions[some])
        chosen = np.concatenate([chosen, some[held > 0.0]])
        if len(chosen) >= CHECKED:
            break
    return np.sort(chosen[:CHECKED])


def edge_rays(picture: Array) -> NDArray[np.intp]:
    """Choose the rays where a picture is steepest: errors sit at edges.

    Parameters
    ----------
    picture
        What a march found along each ray, shape (H, W), neighbours beside each other.

    Returns
    -------
    Numbers of rays, ascending: those with the largest steps to a neighbour.
    """
    steep = np.zeros_like(picture)
    for axis in (0, 1):
        step = np.abs(np.diff(picture, axis=axis))
        near, far = [slice(None)] * 2, [slice(None)] * 2
        near[axis], far[axis] = slice(None, -1), slice(1, None)
        for side in (tuple(near), tuple(far)):
            steep[side] = np.maximum(steep[side], step)
    steep = steep.ravel()
    # Only those above a level are sorted, which is lowered until they are enough: a
    # partition of as many zeros as lie beside a cloud takes fifty times as long.
    level = 0.5 * float(steep.max(initial=0.0))
    most = np.flatnonzero(steep > level)
    while len(most) < EDGES and level > 0.0:
        level = 0.5 * level if level > LEVEL else 0.0
        most = np.flatnonzero(steep > level)
    order = np.argsort(-steep[most], kind="stable")[:EDGES]
    return np.sort(most[order])


def strides(met: int, checked: int) -> list[int]:
    """Give how far to look around the worst rays, round after round.

    Formula: half the distance between checked rays, sqrt(met / checked) / 2, then half
    of that, and so on; next neighbours twice

    Parameters
    ----------
    met, checked
        How many rays meet density, and how many of them are checked.
    """
    stride, found = round(0.5 * float(np.sqrt(met / max(checked, 1)))), []
    while stride > 1:
        found.append(stride)
        stride = (stride + 1) // 2
    return [*found, 1, 1]


def rays_around(
    which: NDArray[np.intp], rows: tuple[int, int], stride: int
) -> NDArray[np.intp]:
    """Give the eight rays around each of some, `stride` rows and columns away.

    Parameters
    ----------
    which
        Numbers of rays.
    rows
        How many rows and columns of rays there are.
    stride
        How far away.

    Returns
    -------
    Numbers of rays, ascending, each once.
    """
    away = np.array([-stride, 0, stride])
    row, column = np.divmod(which[:, None, None], rows[1])
    row, column = np.broadcast_arrays(row + away[:, None], column + away)
    inside = (row >= 0) & (row < rows[0]) & (column >= 0) & (column < rows[1])
    around = np.unique((row * rows[1] + column)[inside])
    return np.setdiff1d(around, which, assume_unique=True)
