"""What a shader is given: the fragments of triangles and what they interpolate.

On the screen a number that is linear over a triangle in space is a quotient: both it
divided by depth and 1 / depth are linear there. So a span starts at its first pixel's
numerator and denominator and goes on in equal steps.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.raster.spans import HALF, Spans
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
    least
        The least 1 / depth or depth of all corners, below which no rounding must lead.
    """

    origin: Places
    value: Array
    along_x: Array
    along_y: Array
    least: float


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
    least = float(values[0].min(initial=np.inf))
    return Planes(np.stack([x[0], y[0]]), first, along_x, along_y, least)


@dataclass(frozen=True, eq=False)
class View:
    """How depths are kept: a pinhole or not, near and far."""

    pinhole: bool
    near: float
    far: float | None

    def depth(self, first: Array) -> Array:
        """Give what the depth test compares, in [0, 1], from 1 / depth or depth."""
        near, far = self.near, self.far
        if self.pinhole:
            share = 1.0 if far is None else far / (far - near)
            depth = share - (share * near) * first
        elif far is None:
            depth = np.zeros_like(first)  # never tested
        else:
            depth = (first - near) * (1.0 / (far - near))
        np.maximum(depth, 0.0, out=depth)
        return np.minimum(depth, 1.0, out=depth)


@dataclass(frozen=True, eq=False)
class Run:
    """Spans, and what is linear along them.

    Attributes
    ----------
    spans
        Of R stretches of pixels.
    planes
        What is linear over the triangles.
    source, front
        Which of the mesh's faces each triangle is, and which side of it is seen.
    view
        How depths are kept.
    """

    spans: Spans
    planes: Planes
    source: Indices
    front: NDArray[np.bool_]
    view: View

    @functools.cached_property
    def start(self) -> Array:
        """Give the planes in the middle of column 0 of each span's row, (1 + K, R)."""
        planes, piece = self.planes, self.spans.triangle
        x, y = (
            (HALF - origin.take(piece)).astype(np.float64) / SUBPIXEL
            for origin in planes.origin
        )
        y += self.spans.row
        start = self.step * x
        start += planes.along_y.take(piece, axis=1) * y
        start += planes.value.take(piece, axis=1)
        return start

    @functools.cached_property
    def step(self) -> Array:
        """Give their change from column to column, shape (1 + K, R)."""
        return self.planes.along_x.take(self.spans.triangle, axis=1)

    def each(self, of_span: NDArray[Any]) -> Any:
        """Give the spans' numbers, shape (..., R), for each pixel, shape (..., n)."""
        return np.repeat(of_span, self.spans.count, axis=-1)

    def fragments(self, tolerance: float, alone: bool) -> Fragments:
        """Give all the pixels of the spans, in their order."""
        count = self.spans.count
        begin = self.spans.first - (np.cumsum(count) - count)
        column = self.each(begin)
        column += np.arange(len(column))
        return Fragments(self, column, tolerance, alone)


@dataclass(frozen=True, eq=False)
class Fragments:
    """Pixels of triangles on their way to the framebuffer; what `shade` is called with.

    Attributes
    ----------
    run
        What they are pixels of.
    column
        Of each pixel, shape (n,).
    tolerance
        By how much colours may be off, units of displayed white.
    alone
        Whether each has its pixel for itself, and they lie in the pixels' order.
    some
        Which stretch of the run each is a pixel of, shape (n,); None for all pixels of
        all stretches, one after the other.
    """

    run: Run
    column: Indices
    tolerance: float
    alone: bool
    some: Indices | None = None

    def of(self, some: Indices | slice) -> Fragments:
        """Give some of them."""
        if isinstance(some, slice) and some == slice(0, len(self.column)):
            return self
        how = self.tolerance, self.alone, self._span[some]
        part = Fragments(self.run, self.column[some], *how)
        for known in ("_first", "_across"):  # where the depth test has asked for them
            if known in self.__dict__:
                part.__dict__[known] = self.__dict__[known][some]
        return part

    @property
    def row(self) -> Indices:
        """Give the row of each pixel, shape (n,)."""
        return self._each(self.run.spans.row)

    def pixel(self, width: int) -> Indices | slice:
        """Give row times width plus column of each; a slice where they are one."""
        ends = self.run.spans.row[[0, -1]] * width + self.column[[0, -1]]
        if self.alone and ends[1] - ends[0] == len(self.column) - 1:
            return slice(int(ends[0]), int(ends[1]) + 1)
        found = self._each(self.run.spans.row * width)
        found += self.column
        return found

    @property
    def triangle(self) -> Indices:
        """Tell which of the mesh's faces each belongs to, shape (n,)."""
        return self._each(self.run.source[self.run.spans.triangle])

    @property
    def front(self) -> NDArray[np.bool_]:
        """Tell whether that turns its front to the eye, shape (n,)."""
        return self._each(self.run.front[self.run.spans.triangle])

    @functools.cached_property
    def depth(self) -> Array:
        """Give what the depth test compares, shape (n,), in [0, 1]."""
        return self.run.view.depth(self._first)

    @functools.cached_property
    def away(self) -> Array:
        """Give the depth along the view axis, scene units, shape (n,)."""
        return 1.0 / self._first if self.run.view.pinhole else self._first

    @functools.cached_property
    def values(self) -> Array:
        """Give the attributes, perspective-correct, shape (K, n)."""
        found = np.empty((len(self.run.start) - 1, len(self.column)))
        for k, row in enumerate(found, start=1):
            row[:] = self._linear(k)
            if self.run.view.pinhole:
                row *= self.away
        return found

    @property
    def along_x(self) -> Array:
        """Give their exact change from a pixel to the next in its row, shape (K, n)."""
        return self._change(self._each(self.run.step))

    @property
    def along_y(self) -> Array:
        """Give their exact change from a row to the next below, shape (K, n)."""
        along_y = self.run.planes.along_y.take(self.run.spans.triangle, axis=1)
        return self._change(self._each(along_y))

    @functools.cached_property
    def _span(self) -> Indices:
        return self._each(np.arange(len(self.run.spans.row)))

    @functools.cached_property
    def _across(self) -> Array:
        return self.column.astype(np.float64)

    @functools.cached_property
    def _first(self) -> Array:
        found = self._linear(0)
        return np.maximum(found, self.run.planes.least, out=found)

    def _linear(self, k: int) -> Array:
        """Evaluate a plane at the pixels' centres."""
        found = self._each(self.run.step[k])
        found *= self._across
        found += self._each(self.run.start[k])
        return found

    def _each(self, of_span: NDArray[Any]) -> Any:
        """Give the spans' numbers, shape (..., R), for each pixel, shape (..., n)."""
        if self.some is None:
            return self.run.each(of_span)
        return of_span.take(self.some, axis=-1)

    def _change(self, slope: Array) -> Array:
        """Differentiate the quotient: (a / q)' = (a' - (a / q) q') / q."""
        if not self.run.view.pinhole:
            return slope[1:]
        return (slope[1:] - self.values * slope[0]) * self.away
