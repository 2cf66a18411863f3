"""Which rays of a march are integrated exactly, to check the others by."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import AnyCamera
from refcloud.conventions import Array
from refcloud.march.quadrature import columns
from refcloud.march.task import Task
from refcloud.noise import uniform

CHECKED = 256  # rays of the hashed sample
AT_ONCE = 2 * CHECKED  # rays that are looked at for it together
DRAWN = 8 * CHECKED  # rays that are looked at for it at most; of fewer, each one
EDGES = 64  # rays where a picture is steepest


def chosen_rays(task: Task) -> NDArray[np.intp]:
    """Choose rays that meet density, by a hash of their number."""
    count = len(task.origins)
    drawn = np.arange(count)
    if count > DRAWN:
        hashed = uniform(np.arange(DRAWN), seed=0) * count
        drawn = np.unique(hashed.astype(np.intp))
    drawn = drawn[np.argsort(uniform(drawn, seed=0), kind="stable")]
    chosen = drawn[:0]
    for start in range(0, len(drawn), AT_ONCE):
        some = drawn[start : start + AT_ONCE]
        held = columns(task.grid, task.origins[some], task.directions[some])
        chosen = np.concatenate([chosen, some[held > 0.0]])
        if len(chosen) >= CHECKED:
            break
    return np.sort(chosen[:CHECKED])


def edge_rays(camera: AnyCamera, opacity: Array) -> NDArray[np.intp]:
    """Choose the rays where a picture is steepest: an image's errors sit at edges.

    Parameters
    ----------
    camera
        Whose rays they are.
    opacity
        What a march found along each ray, shape (N,).

    Returns
    -------
    Numbers of rays, ascending: those with the largest steps to a neighbour.
    """
    picture = opacity.reshape(camera.height, camera.width)
    steep = np.zeros_like(picture)
    for axis in (0, 1):
        step = np.abs(np.diff(picture, axis=axis))
        near, far = [slice(None)] * 2, [slice(None)] * 2
        near[axis], far[axis] = slice(None, -1), slice(1, None)
        for side in (tuple(near), tuple(far)):
            steep[side] = np.maximum(steep[side], step)
    order = np.argsort(-steep.ravel(), kind="stable")[:EDGES]
    return np.sort(order[steep.ravel()[order] > 0.0])
