"""What a shader is given: the fragments of triangles and what they interpolate."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.raster.runs import Run, held

Indices = NDArray[np.int64]


def fragments_of(run: Run, tolerance: float, alone: bool) -> Fragments:
    """Give all the pixels of a run's spans, in their order.

    Parameters
    ----------
    run
        The spans, at least one.
    tolerance, alone
        As of `Fragments`.

    Returns
    -------
    The fragments.
    """
    count = run.spans.count.astype(np.int32)
    ends = np.cumsum(count, dtype=np.int32)
    before = np.arange(ends[-1], dtype=np.int32)
    before -= run.each(ends - count)
    return Fragments(run, before.astype(np.float64), tolerance, alone)


@dataclass(frozen=True, eq=False)
class Fragments:
    """Pixels of triangles on their way to the framebuffer; what `shade` is called with.

    Attributes
    ----------
    run
        What they are pixels of.
    before
        How many pixels of its stretch lie before each, shape (n,).
    tolerance
        By how much colours may be off, units of displayed white.
    alone
        Whether each has its pixel for itself, and they lie in the pixels' order.
    some
        Which stretch of the run each is a pixel of, shape (n,); None for all pixels of
        all stretches, one after the other.
    """

    run: Run
    before: Array
    tolerance: float
    alone: bool
    some: Indices | None = None

    def __len__(self) -> int:
        """Count them."""
        return len(self.before)

    def of(self, some: Indices | slice) -> Fragments:
        """Give some of them."""
        if isinstance(some, slice) and some == slice(0, len(self)):
            return self
        how = self.tolerance, self.alone, self._span[some]
        part = Fragments(self.run, self.before[some], *how)
        for known in ("_first", "column"):  # where they have been asked for
            if known in self.__dict__:
                part.__dict__[known] = self.__dict__[known][some]
        return part

    @functools.cached_property
    def column(self) -> Indices:
        """Give the column of each pixel, shape (n,)."""
        return self._each(self.run.spans.first) + self.before.astype(np.int64)

    @property
    def row(self) -> Indices:
        """Give the row of each pixel, shape (n,)."""
        return self._each(self.run.spans.row)

    def pixel(self, width: int) -> Indices | slice:
        """Give row times width plus column of each; a slice where they are one."""
        spans = self.run.spans
        begin = spans.row * width + spans.first
        if self.alone and self.some is None:
            start, stop = int(begin[0]), int(begin[-1] + spans.count[-1])
            if stop - start == len(self):
                return slice(start, stop)
        return self._each(begin) + self.before.astype(np.int64)

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
        found = np.empty((len(self.run.start) - 1, len(self)))
        for k, row in enumerate(found, start=1):
            self._linear(k, row)
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
    def _first(self) -> Array:
        return held(self._linear(0), self.run.planes.least)

    def _linear(self, k: int, out: Array | None = None) -> Array:
        """Evaluate a plane at the pixels' centres."""
        found = np.multiply(self._each(self.run.step[k]), self.before, out=out)
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
