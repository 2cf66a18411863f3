"""Where rays meet an axis-aligned box."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Shape, Vector
from refcloud.refusal import complaint


@checked
def ray_box(
    origins: Annotated[Array, Shape("...", 3)],
    directions: Annotated[Array, Shape("...", 3)],
    *,
    lower: Vector,
    upper: Vector,
) -> tuple[Array, Array]:
    """Find the part of each ray that lies in a closed box.

    Formula: t0 = max(0, nearer faces), t1 = min(farther faces), over x, y and z; both
    0 where the ray misses

    Parameters
    ----------
    origins, directions
        Shape (..., 3) each; they broadcast to one shape. A point of the ray is
        origin + t direction, t at least 0.
    lower, upper
        Corners of the box, shape (3,), scene units.

    Returns
    -------
    t0 and t1, shape (...,), in lengths of the direction. An eye inside has t0 = 0; a
    ray in a face's plane lies in the box.

    Raises
    ------
    ValueError
        A direction is zero.

    Source: document D (R01).

    Examples
    --------
    >>> ray_box([-3, 0, 0], [[1, 0, 0], [0, 1, 0]], lower=[-1] * 3, upper=[1] * 3)
    (array([2., 0.]), array([4., 0.]))
    """
    refuse_still(directions)
    return slabs(origins, directions, lower, upper, 0.0)


def refuse_still(directions: Array) -> None:
    """Refuse rays that go nowhere."""
    still = int((~directions.any(axis=-1)).sum())
    if still:
        got = f"{still} zero of {directions.size // 3}"
        raise ValueError(complaint("directions", "vectors that are not zero", got))


def slabs(
    origins: Array, directions: Array, lower: Array, upper: Array, first: Array | float
) -> tuple[Array, Array]:
    """Intersect the three slabs, unchecked; rays begin at t = first.

    Parameters
    ----------
    origins, directions, lower, upper
        As `ray_box`.
    first
        The least t, a number or shape (...,).

    Returns
    -------
    t0 and t1; both `first` where the ray misses.
    """
    shape = np.broadcast_shapes(origins.shape, directions.shape, lower.shape)[:-1]
    near, far = np.full(shape, -np.inf), np.full(shape, np.inf)
    for axis in range(3):
        o, d = origins[..., axis], directions[..., axis]
        moving = d != 0.0
        # A ray along the slab is in it everywhere or nowhere: no division, no 0 / 0.
        speed = np.where(moving, d, 1.0)
        with np.errstate(over="ignore"):  # a face out of reach is at infinity
            a, b = (lower[axis] - o) / speed, (upper[axis] - o) / speed
        if not moving.all():
            within = (o >= lower[axis]) & (o <= upper[axis])
            a = np.where(moving, a, np.where(within, -np.inf, np.inf))
            b = np.where(moving, b, np.where(within, np.inf, -np.inf))
            near = np.maximum(near, np.where(moving, np.minimum(a, b), a))
            far = np.minimum(far, np.where(moving, np.maximum(a, b), b))
        else:
            near = np.maximum(near, np.minimum(a, b))
            far = np.minimum(far, np.maximum(a, b))
    t0 = np.maximum(near, first)
    hits = far > t0
    return np.where(hits, t0, first), np.where(hits, far, first)
