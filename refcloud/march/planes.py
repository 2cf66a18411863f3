"""Volumes cut into slabs across one axis, so that all rays look up the same planes.

Trilinear interpolation between voxel centres is done once along one axis, for all rays
together: a slab holds the mean of the interpolated values over its thickness, which is
one matrix product. Along a ray two axes are left to interpolate.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array

Singles = NDArray[np.float32]
RIM = 2  # samples around a plane, so that no look-up falls outside


@dataclass(frozen=True)
class Planes:
    """Pairs of fields as slabs across one axis.

    Attributes
    ----------
    pairs
        Two fields as real and imaginary part, flat, for each pair of fields.
    count
        Number of fields; an odd one's partner is zero.
    scale
        Samples per cell.
    shape
        Number of slabs K, then samples V and U across them with their rim.
    """

    pairs: tuple[NDArray[np.complex64], ...]
    count: int
    scale: int
    shape: tuple[int, int, int]


def tent_means(edges: Array, count: int) -> Array:
    """Give the integrals of interpolated samples over slabs, as weights of the samples.

    Formula: row j times the samples is the integral, from edge j to edge j + 1, of the
    piecewise linear function through them, constant beyond the outermost

    Parameters
    ----------
    edges
        Ascending, shape (K + 1,); sample i lies at i.
    count
        Number of samples.

    Returns
    -------
    Shape (K, count).
    """
    # The primitive of each sample's tent, whose halves are parabolas.
    x = np.clip(edges, 0.0, count - 1.0)[:, None] - np.arange(count)
    rising, falling = np.maximum(x + 1.0, 0.0), np.maximum(1.0 - x, 0.0)
    primitive = np.where(x < 0.0, 0.5 * rising**2, 1.0 - 0.5 * falling**2)
    primitive[:, 0] += np.minimum(edges, 0.0)
    primitive[:, -1] += np.maximum(edges - (count - 1.0), 0.0)
    return np.diff(primitive, axis=0)


def planes(
    fields: Sequence[NDArray[Any]], edges: Array, *, scale: int, thickness: float
) -> Planes:
    """Average fields over slabs across their first axis.

    Parameters
    ----------
    fields
        As ``[w, v, u]``, one shape.
    edges
        Of the slabs along w, in cells, within the box, shape (K + 1,).
    scale
        Samples of the fields per cell.
    thickness
        Of a slab, in cells; the first and last may have less of it in the box.

    Returns
    -------
    The slabs; beyond the outermost samples they are continued.
    """
    count, V, U = fields[0].shape
    places = scale * edges + 0.5 * (scale - 1)
    means = (tent_means(places, count) / (scale * thickness)).astype(np.float32)
    shape = (len(means), V + 2 * RIM, U + 2 * RIM)
    pairs = [np.zeros(shape, np.complex64) for _ in fields[::2]]
    for number, field in enumerate(fields):
        slabs = np.ascontiguousarray(field, np.float32).reshape(count, -1)
        part = pairs[number // 2].imag if number % 2 else pairs[number // 2].real
        part[:, RIM:-RIM, RIM:-RIM] = (means @ slabs).reshape(-1, V, U)
        for k in range(RIM - 1, -1, -1):
            part[:, k], part[:, -1 - k] = part[:, k + 1], part[:, -2 - k]
        for k in range(RIM - 1, -1, -1):
            part[:, :, k], part[:, :, -1 - k] = part[:, :, k + 1], part[:, :, -2 - k]
    flat = tuple(pair.reshape(-1) for pair in pairs)
    return Planes(flat, len(fields), scale, shape)


def looked_up(
    volume: Planes, slab: NDArray[np.int32], u: Singles, v: Singles
) -> list[Singles]:
    """Interpolate every field of slabs at places, bilinearly.

    Parameters
    ----------
    volume
        The slabs.
    slab
        Which one, shape (M,).
    u, v
        Places in cells, counted with the rim, shape (M,).

    Returns
    -------
    An array of shape (M,) for each field.
    """
    _, V, U = volume.shape
    if volume.scale > 1:
        # The rim is RIM samples wide at each scale; sample i lies at (i + 1/2) / scale.
        scale = np.float32(volume.scale)
        moved = np.float32(0.5 * (volume.scale - 1) - RIM * (volume.scale - 1))
        u, v = u * scale + moved, v * scale + moved
    # int() truncates toward zero: the rim keeps what it sees positive.
    x = np.clip(u, np.float32(0.0), np.float32(U - 1.5))
    y = np.clip(v, np.float32(0.0), np.float32(V - 1.5))
    i, row = x.astype(np.int32), y.astype(np.int32)
    x -= i.astype(np.float32)
    y -= row.astype(np.float32)
    row += slab * np.int32(V)
    j = row.astype(np.intp)  # samples may be more than 32 bits count
    j *= U
    j += i
    found = []
    for pair in volume.pairs:
        a, b = pair.take(j), pair.take(j + 1)
        b -= a
        b *= x
        a += b
        c, b = pair.take(j + U), pair.take(j + (U + 1))
        b -= c
        b *= x
        c += b
        c -= a
        c *= y
        a += c
        found += [a.real, a.imag]
    return found[: volume.count]
