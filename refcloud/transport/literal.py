"""The sheared accumulator with one index for each thing: `sheared_depths` to read.

Every step of `refcloud.transport.sheared` stands here on a whole accumulator that never
moves: column c of an axis is c, counted from `FIRST`, and each slice is placed into all
of it. That is many times the work, for the same numbers.
"""

from __future__ import annotations

import math

import numpy as np

from refcloud.conventions import Array
from refcloud.transport.sheared import Pair, border_is_filled
from refcloud.transport.windows import (
    border_factor,
    catmull_rom,
    own_share,
    steps_inside,
)

FIRST = -2  # the leftmost column that the first slice reads


def sheared_depths_literal(
    slabs: Array, slopes: Pair, *, length: float, scale: int
) -> Array:
    """Integrate a field from each sample toward the sun, unchecked.

    Parameters
    ----------
    slabs
        Shape (K, V, U), slice 0 nearest the sun.
    slopes
        Cells that a ray moves up v and up u, one slice toward the sun; in [0, 1].
    length
        Of a ray between slices.
    scale
        Samples per cell along each axis, s.

    Returns
    -------
    Shape (s K, s V, s U).
    """
    K, *cells = slabs.shape
    s, filled = scale, border_is_filled(slabs)
    c_v, c_u = (
        np.arange(FIRST, s * n + math.ceil(s * K * slope) + 3)
        for n, slope in zip(cells, slopes, strict=True)
    )
    passed = np.zeros((len(c_v), len(c_u)))
    out = np.empty((s * K, s * cells[0], s * cells[1]))
    for m in range(s * K):
        step = 0.5 if m == 0 else 1.0  # the box begins half a step before slice 0
        middle = m - 0.5 * step
        # 1. Mix: the slice in the middle of the step.
        mixed = along(slabs, np.array([(middle + 0.5) / s - 0.5]), 0)[0]
        # 2. Place: where the columns meet it; a step that leaves the box counts less.
        at_v, at_u = (
            (c - middle * slope + 0.5) / s - 0.5
            for c, slope in zip((c_v, c_u), slopes, strict=True)
        )
        value = along(along(mixed, at_v, 0), at_u, 1)
        share_v, share_u = (
            inside(at, n, slope * step, s) if filled else np.ones(len(at))
            for at, n, slope in zip((at_v, at_u), cells, slopes, strict=True)
        )
        passed += step * length / s * np.minimum(share_v[:, None], share_u) * value
        # 3. Read: the columns beside c = j + m slope, along v and along u.
        columns = lengthened(passed, (c_v, c_u), m, slopes, cells, s)
        columns = columns if filled else passed
        for axis, (n, slope) in enumerate(zip(cells, slopes, strict=True)):
            weights = catmull_rom(m * slope - math.floor(m * slope))
            first = np.arange(s * n) + math.floor(m * slope) - 1 - FIRST
            columns = sum(
                weight * np.take(columns, first + k, axis)
                for k, weight in enumerate(weights)
            )
        out[m] = np.maximum(columns, 0.0)
    return out


def along(values: Array, at: Array, axis: int) -> Array:
    """Interpolate linearly along an axis; beyond its ends the last value goes on."""
    n = values.shape[axis]
    place = np.clip(at, 0.0, n - 1.0)
    near = np.floor(place).astype(np.intp)
    far = np.minimum(near + 1, n - 1)
    share = (place - near).reshape([-1 if a == axis else 1 for a in range(values.ndim)])
    return (1.0 - share) * values.take(near, axis) + share * values.take(far, axis)


def inside(at: Array, n: int, moved: float, scale: int) -> Array:
    """Give the share of a step inside the box, of columns at cells in its middle."""
    samples = scale * (n - 0.5 - at)  # from the side that faces the sun
    if moved == 0.0:
        return (samples > 0.0).astype(np.float64)
    return np.clip(0.5 + samples / moved, 0.0, 1.0)


def lengthened(
    passed: Array,
    c: tuple[Array, Array],
    m: int,
    slopes: Pair,
    cells: list[int],
    scale: int,
) -> Array:
    """Carry columns on beyond the sides that face the sun, along u and then along v."""
    columns = passed.copy()
    for axis in (1, 0):
        slope, other = slopes[axis], 1 - axis
        lines = np.moveaxis(columns, axis, 0)
        last = scale * cells[axis] - 1 + math.floor(m * slope) - FIRST
        steps = steps_inside(c[other], m, slopes[other], scale * cells[other])
        own = own_share(m * slope)
        factor = (1.0 - own) * border_factor(m * slope, slope, steps)
        lines[last + 1] = own * lines[last + 1] + factor * lines[last]
        lines[last + 2] = 2.0 * lines[last + 1] - lines[last]
    return columns
