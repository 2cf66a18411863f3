"""Slices resampled by tents: which part of a slice an image sees, and its values there.

Linear interpolation at places u is a product with the tent matrix
max(0, 1 - |u_i - j|): two numbers in each of its columns, the shares of the two cells
on both sides of a place. Along the slices' rows that is done by matrix products; along
their columns the two rows are fetched and mixed, since whole rows lie in one piece.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array

Image = NDArray[Any]  # float32
Cells = tuple[int, int]  # the first, and the one after the last


class Places(NamedTuple):
    """Places along an axis of n slices, by the cells on both sides of them."""

    cell: NDArray[np.intp]  # (n, R), counted from the first of the cells in use
    beyond: Image  # (n, R), how far beyond it, in cells
    used: int  # cells


def places_of(at: Array, cells: Cells) -> Places:
    """Find the cells beside places (n, R); beyond the last ones their value goes on."""
    first, end = cells
    at = np.clip(at - first, 0.0, end - first - 1.0)
    cell = np.minimum(at.astype(np.intp), max(end - first - 2, 0))
    return Places(cell, (at - cell).astype(np.float32), end - first)


def tents(places: Places) -> Image:
    """Write the tent matrices of n slices, shape (n, cells, R)."""
    n, R = places.cell.shape
    weights = np.zeros((n, places.used, R), np.float32)
    k, i = np.arange(n)[:, None], np.arange(R)
    weights[k, places.cell, i] = 1.0 - places.beyond
    if places.used > 1:
        weights[k, places.cell + 1, i] = places.beyond
    return weights


def resampled(values: Image, v: Places, matrix: Image) -> Image:
    """Interpolate n slices at the places v and u: B_v^T values B_u.

    Parameters
    ----------
    values
        Shape (..., n, V, U), in one piece.
    v
        Places along v.
    matrix
        Tents of the places along u, shape (n, U, R_u).

    Returns
    -------
    Shape (..., n, R_v, R_u).
    """
    *more, n, V, U = values.shape
    rows = values.reshape(-1, U)
    first = V * np.arange(rows.shape[0] // V).reshape(-1, n, 1)
    number = (first + v.cell).reshape(-1)
    near = rows.take(number, axis=0)
    if V > 1:
        far = rows.take(number + 1, axis=0)
        far -= near
        far.reshape(-1, *v.cell.shape, U)[...] *= v.beyond[:, :, None]
        near += far
    return near.reshape(*more, *v.cell.shape, U) @ matrix


def between(slabs: NDArray[Any], w: Array) -> Image:
    """Give slices at planes w: themselves, or what lies between the two beside."""
    last = len(slabs) - 1
    place = np.clip(w, 0.0, last)
    near = np.floor(place).astype(np.intp)
    share = place - near
    if not share.any():
        return slabs[near[0] : near[-1] + 1].astype(np.float32, order="C")
    far = np.minimum(near + 1, last)
    weight = share[:, None, None]
    mixed = (1.0 - weight) * slabs[near] + weight * slabs[far]
    return mixed.astype(np.float32, order="C")


def without_bias(lit: Image, axes: tuple[int, ...] = (1, 2)) -> Image:
    """Take from each sample a twelfth of its second differences along some axes.

    Linear interpolation of f is off by x (1 - x) f'' / 2 at a share x between samples,
    on average f'' / 12: light that curves upward comes out too bright. What is left has
    a mean of 0. No light is made negative, or more than the sun's.

    Parameters
    ----------
    lit
        Light in [0, 1], shape (n, V, U).
    axes
        Along which it will be interpolated; v and u within a slice.

    Returns
    -------
    The same shape.
    """
    better = lit.copy()
    for axis in axes:
        first, middle, last = ([slice(None)] * 3 for _ in range(3))
        first[axis], middle[axis], last[axis] = slice(-2), slice(1, -1), slice(2, None)
        second = lit[tuple(first)] + lit[tuple(last)]
        second -= 2.0 * lit[tuple(middle)]
        second *= np.float32(1.0 / 12.0)
        better[tuple(middle)] -= second
    return np.clip(better, 0.0, 1.0, out=better)
