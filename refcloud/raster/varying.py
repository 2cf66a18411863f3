"""What a shader is given: the fragments of triangles and what they interpolate.

On the screen a number that is linear over a triangle in space is a quotient: both it
divided by depth and 1 / depth are linear there. So a span starts at its first pixel's
numerator and denominator and goes on in equal steps.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.raster.spans import HALF
from refcloud.raster.window import SUBPIXEL, Places

Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Planes:
    """Numbers that are linear on the screen, for each of T triangles.

    Attributes
    ----------
    origin
        The first corner's x and y in sub-pixels, shape (2, T).
    value
        There, shape (1 + K, T): first 1 / depth, or depth where rays are parallel, then
        the attributes, divided by depth for a pinhole.
    along_x, along_y
        Change from pixel to pixel, shape (1 + K, T).
    """

    origin: Places
    value: Array
    along_x: Array
    along_y: Array


def planes_through(x: Places, y: Places, values: Array) -> Planes:
    """Lay planes through the corners' values.

    Parameters
    ----------
    x, y
        Corners in sub-pixels, shape (3, T), of an area that is not 0.
    values
        Shape (1 + K, 3, T).

    Returns
    -------
    The planes.
    """
    x1, x2, y1, y2 = x[1] - x[0], x[2] - x[0], y[1] - y[0], y[2] - y[0]
    scale = SUBPIXEL / (x1 * y2 - x2 * y1).astype(np.float64)
    first = values[:, 0]
    rise1, rise2 = values[:, 1] - first, values[:, 2] - first
    along_x = (rise1 * y2 - rise2 * y1) * scale
    along_y = (rise2 * x1 - rise1 * x2) * scale
    return Planes(np.stack([x[0], y[0]]), first, along_x, along_y)


@dataclass(frozen=True, eq=False)
class View:
    """How depths are kept: a pinhole or not, near, far, and the triangles' planes."""

    pinhole: bool
    near: float
    far: float | None
    planes: Planes

    @functools.cached_property
    def least(self) -> float:
        """Give the least of the first numbers, below which rounding must not lead."""
        value = self.planes.value[0]
        return float(value.min(initial=1.0))

    def depth(self, first: Array) -> Array:
        """Give what the depth test compares, in [0, 1]."""
        near, far = self.near, self.far
        if self.pinhole:
            depth = 1.0 - near * first
            depth = depth if far is None else depth * (far / (far - near))
        elif far is None:
            depth = np.zeros_like(first)  # never tested
        else:
            depth = (first - near) / (far - near)
        return np.clip(depth, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Fragments:
    """Pixels of triangles on their way to the framebuffer; what `shade` is called with.

    Attributes
    ----------
    row, column
        Of each pixel, shape (n,).
    triangle
        Which of the mesh's faces it belongs to, shape (n,).
    front
        Whether that turns its front to the eye, shape (n,).
    depth
        What the depth test compares, shape (n,), in [0, 1].
    view, piece
        Where the numbers below come from: planes, and which of them.
    """

    row: Indices
    column: Indices
    triangle: Indices
    front: NDArray[np.bool_]
    depth: Array
    view: View
    piece: Indices

    def of(self, some: Indices) -> Fragments:
        """Give some of them."""
        return Fragments(
            self.row[some],
            self.column[some],
            self.triangle[some],
            self.front[some],
            self.depth[some],
            self.view,
            self.piece[some],
        )

    @functools.cached_property
    def away(self) -> Array:
        """Give the depth along the view axis, scene units, shape (n,)."""
        first = self._linear[0]
        return 1.0 / first if self.view.pinhole else first

    @functools.cached_property
    def values(self) -> Array:
        """Give the attributes, perspective-correct, shape (K, n)."""
        rest = self._linear[1:]
        return rest * self.away if self.view.pinhole else rest

    @property
    def along_x(self) -> Array:
        """Give their exact change from a pixel to the next in its row, shape (K, n)."""
        return self._change(self.view.planes.along_x)

    @property
    def along_y(self) -> Array:
        """Give their exact change from a row to the next below, shape (K, n)."""
        return self._change(self.view.planes.along_y)

    @functools.cached_property
    def _linear(self) -> Array:
        return linear_at(self.view, self.piece, self.row, self.column, slice(None))

    def _change(self, slope: Array) -> Array:
        """Differentiate the quotient: (a / q)' = (a' - (a / q) q') / q."""
        here = slope[:, self.piece]
        if not self.view.pinhole:
            return here[1:]
        return (here[1:] - self.values * here[0]) * self.away


def fragments_at(
    view: View,
    piece: Indices,
    row: Indices,
    column: Indices,
    triangle: Indices,
    front: NDArray[np.bool_],
) -> Fragments:
    """Make fragments of pixels: all but their attributes, which may never be wanted.

    Parameters
    ----------
    view
        The planes.
    piece
        Which of them, shape (n,).
    row, column, triangle, front
        As `Fragments`.

    Returns
    -------
    The fragments.
    """
    depth = view.depth(linear_at(view, piece, row, column, slice(1))[0])
    return Fragments(row, column, triangle, front, depth, view, piece)


def linear_at(
    view: View, piece: Indices, row: Indices, column: Indices, which: slice
) -> Array:
    """Evaluate planes at pixels' centres.

    Parameters
    ----------
    view
        The planes.
    piece, row, column
        Of each pixel, shape (n,).
    which
        Of the numbers.

    Returns
    -------
    Shape (k, n).
    """
    planes = view.planes
    from_x = (column * SUBPIXEL + HALF - planes.origin[0, piece]) / SUBPIXEL
    from_y = (row * SUBPIXEL + HALF - planes.origin[1, piece]) / SUBPIXEL
    found = planes.value[which][:, piece]
    found += planes.along_x[which][:, piece] * from_x
    found += planes.along_y[which][:, piece] * from_y
    if which.start in (None, 0):
        np.maximum(found[0], view.least, out=found[0])
    return found
