"""Runs: spans of triangles, and what is linear along them.

On the screen a number that is linear over a triangle in space is a quotient: both it
divided by depth and 1 / depth are linear there. So a span starts at its first pixel's
numerator and denominator and goes on in equal steps. The start comes from the corners
by barycentric weights, quotients of whole numbers from 0 to 1: from anywhere outside of
a thin triangle its steep planes would lead back to it with few digits left.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.raster.spans import HALF, Spans, batches
from refcloud.raster.window import SUBPIXEL, Places

Indices = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Planes:
    """Numbers that are linear on the screen, for each of T triangles.

    Attributes
    ----------
    origin
        The first corner's x and y in sub-pixels, shape (2, T).
    sides
        From there to the second and the third corner: x, y, x, y, shape (4, T).
    area
        Twice the triangle's, square sub-pixels, shape (T,).
    value
        At the first corner, shape (1 + K, T): first 1 / depth, or depth where rays are
        parallel, then the attributes, divided by depth for a pinhole.
    rises
        From there to the second and the third corner, each of shape (1 + K, T).
    along_x, along_y
        Change from pixel to pixel, shape (1 + K, T).
    least
        The least 1 / depth or depth of all corners, below which no rounding must lead.
    """

    origin: Places
    sides: Places
    area: Array
    value: Array
    rises: tuple[Array, Array]
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
    area = (x1 * y2 - x2 * y1).astype(np.float64)
    scale = SUBPIXEL / area
    first = values[:, 0]
    rise1, rise2 = values[:, 1] - first, values[:, 2] - first
    along_x = (rise1 * y2 - rise2 * y1) * scale
    along_y = (rise2 * x1 - rise1 * x2) * scale
    least = float(values[0].min(initial=np.inf))
    origin, sides = np.stack([x[0], y[0]]), np.stack([x1, y1, x2, y2])
    rises = rise1, rise2
    return Planes(origin, sides, area, first, rises, along_x, along_y, least)


def held(numbers: Array, low: float, high: float = np.inf) -> Array:
    """Hold numbers within limits in place: to look costs less than to write."""
    if numbers.min(initial=low) < low:
        np.maximum(numbers, low, out=numbers)
    if numbers.max(initial=low) > high:
        np.minimum(numbers, high, out=numbers)
    return numbers


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
            depth = (share * near) * first
            np.subtract(share, depth, out=depth)
        elif far is None:
            depth = np.zeros_like(first)  # never tested
        else:
            depth = (first - near) * (1.0 / (far - near))
        return held(depth, 0.0, 1.0)


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
    within
        The run that this one is a part of, and which spans of it; None for a whole one.
    """

    spans: Spans
    planes: Planes
    source: Indices
    front: NDArray[np.bool_]
    view: View
    within: tuple[Run, slice] | None = None

    def parts(self, most: int) -> Iterator[Run]:
        """Split it so that each part has at most so many pixels, or one span."""
        for some in batches(self.spans.count, most):
            yield dataclasses.replace(
                self, spans=self.spans.some(some), within=(self, some)
            )

    @functools.cached_property
    def start(self) -> Array:
        """Give the planes in the middle of each span's first pixel, (1 + K, R)."""
        if self.within is not None:
            whole, some = self.within
            return whole.start[:, some]
        planes, spans = self.planes, self.spans
        x, y = (
            SUBPIXEL * place + HALF - origin.take(spans.triangle)
            for place, origin in zip(
                (spans.first, spans.row), planes.origin, strict=True
            )
        )
        x1, y1, x2, y2 = planes.sides.take(spans.triangle, axis=1)
        area = planes.area.take(spans.triangle)
        start = planes.value.take(spans.triangle, axis=1)
        shares = (x * y2 - y * x2) / area, (y * x1 - x * y1) / area
        for share, rise in zip(shares, planes.rises, strict=True):
            start += share * rise.take(spans.triangle, axis=1)
        return start

    @functools.cached_property
    def step(self) -> Array:
        """Give their change from column to column, shape (1 + K, R)."""
        if self.within is not None:
            whole, some = self.within
            return whole.step[:, some]
        return self.planes.along_x.take(self.spans.triangle, axis=1)

    def each(self, of_span: NDArray[Any]) -> Any:
        """Give the spans' numbers, shape (..., R), for each pixel, shape (..., n)."""
        return np.repeat(of_span, self.spans.count, axis=-1)
