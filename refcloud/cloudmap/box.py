"""The box that document D puts its cloud in: eight corners, twelve lines, six walls.

Two opposite corners say all. Corner k of the eight lies at the upper end of x where k
has bit 1, of y where it has bit 2, of z where it has bit 4: corner 0 is the rear left
lower one, corner 7 the front right upper one (+z points at the reader).
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked, complaint
from refcloud.conventions import Array, Positive, Shape, Vector

# Pairs of corners that differ along one axis.
LINES = np.array([(k, k | bit) for bit in (1, 2, 4) for k in range(8) if not k & bit])
# Corners of each wall, counterclockwise as seen from outside: -x +x -y +y -z +z.
WALLS = np.array(
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]]
)
HALVES = np.array([[0, 1, 2], [0, 2, 3]])  # a wall's two triangles, of its corners


def spanned(first: Array, second: Array) -> tuple[Array, Array]:
    """Give the lower and the upper corner of the box between two opposite ones.

    Parameters
    ----------
    first, second
        Any two opposite corners, shape (3,), scene units.

    Returns
    -------
    Lower and upper, shape (3,).

    Raises
    ------
    ValueError
        The box is flat.
    """
    lower, upper = np.minimum(first, second), np.maximum(first, second)
    if not np.all(upper > lower):
        raise ValueError(
            complaint(
                "second",
                "the opposite corner, apart from the first on every axis",
                f"{tuple(second.tolist())} opposite {tuple(first.tolist())}",
            )
        )
    return lower, upper


@checked
def box_corners(first: Vector, second: Vector) -> Array:
    """Give the eight corners of a box.

    Formula: corner k takes x, y, z from the upper end where k has bit 1, 2, 4

    Parameters
    ----------
    first, second
        Any two opposite corners, shape (3,), scene units.

    Returns
    -------
    Shape (8, 3), scene units.

    Raises
    ------
    ValueError
        The box is flat.

    Source: document D, Prior to Ray Tracing (F09).

    Examples
    --------
    >>> box_corners([0, 0, 0], [3, 2, 1])[[0, 1, 7]]
    array([[0., 0., 0.],
           [3., 0., 0.],
           [3., 2., 1.]])
    """
    ends = np.stack(spanned(first, second))
    bits = np.arange(8)[:, None] >> np.arange(3) & 1
    return ends[bits, np.arange(3)]


@checked
def box_lines(first: Vector, second: Vector) -> Array:
    """Give the twelve lines that outline a box.

    Formula: corners that differ along one axis, joined; those along x, then y, then z

    Parameters
    ----------
    first, second
        Any two opposite corners, shape (3,), scene units.

    Returns
    -------
    Two ends of each line, shape (12, 2, 3), scene units.

    Raises
    ------
    ValueError
        The box is flat.

    Source: document D, Prior to Ray Tracing (F07).

    Examples
    --------
    >>> box_lines([0, 0, 0], [3, 2, 1])[0]
    array([[0., 0., 0.],
           [3., 0., 0.]])
    """
    return box_corners(first, second)[LINES]


@checked
def box_triangles(first: Vector, second: Vector) -> Array:
    """Give the twelve triangles of a box's walls.

    Formula: each wall a b c d, counterclockwise from outside, as a b c and a c d

    Parameters
    ----------
    first, second
        Any two opposite corners, shape (3,), scene units.

    Returns
    -------
    Corners of each triangle, shape (12, 3, 3), scene units; walls in the order -x, +x,
    -y, +y, -z, +z.

    Raises
    ------
    ValueError
        The box is flat.

    Source: document D, Prior to Ray Tracing (F08).

    Examples
    --------
    >>> box_triangles([0, 0, 0], [3, 2, 1]).shape
    (12, 3, 3)
    """
    corners = box_corners(first, second)
    return corners[WALLS[:, HALVES]].reshape(12, 3, 3)


@checked
def resized_box(
    first: Vector, second: Vector, lengths: Annotated[Array, Shape(3), Positive]
) -> tuple[Array, Array]:
    """Give a box other lengths; its middle stays.

    Formula: middle -+ lengths / 2

    Parameters
    ----------
    first, second
        Any two opposite corners, shape (3,), scene units.
    lengths
        Along x, y and z, shape (3,), scene units, above 0.

    Returns
    -------
    The lower and the upper corner, shape (3,), scene units.

    Raises
    ------
    ValueError
        The box is flat, or comes out flat: too short to be told apart from its middle.

    Source: document D, Prior to Ray Tracing (F09: sliders length x, y, z).

    Examples
    --------
    >>> resized_box([0, 0, 0], [2, 2, 2], [4, 2, 1])
    (array([-1. ,  0. ,  0.5]), array([3. , 2. , 1.5]))
    """
    lower, upper = spanned(first, second)
    middle = 0.5 * lower + 0.5 * upper
    return spanned(middle - 0.5 * lengths, middle + 0.5 * lengths)
