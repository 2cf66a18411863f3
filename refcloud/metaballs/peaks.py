"""Where a residual looks like a ball: correlation with balls of several radii."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from refcloud.conventions import Array
from refcloud.metaballs.kernels import Kernel, profile_of
from refcloud.metaballs.pairs import Numbers

# No score is above the residual's length; the transforms' rounding is 1e-16 of it.
ROUNDING = 1e-12
# Two new balls are kept at least this share of their radii's sum apart.
APART = 0.5
AXES = (0, 1, 2)
SMOOTH = (2, 3, 5)  # a transform whose length has other factors takes longer


@dataclass(frozen=True)
class Peaks:
    """Balls that a residual asks for, those that lower its squares most first.

    Attributes
    ----------
    cells
        The voxels that they stand on, shape (M, 3) as x, y, z.
    radii
        In mean cell edges, shape (M,).
    heights
        Those of least squares for each ball alone, shape (M,).
    """

    cells: Numbers
    radii: Array
    heights: Array


class Correlator:
    """Correlates residuals of one shape with balls of several radii.

    The transforms of the balls are made once: each residual takes one transform, and
    one back for each radius.
    """

    def __init__(
        self,
        shape: tuple[int, int, int],
        edges: Array,
        radii: Array,
        kernel: Kernel,
    ) -> None:
        self.radii, self.edges = radii, edges
        self.shape = shape
        self.padded = padded_shape(shape, edges, float(radii.max()))
        balls = [ball_spectrum(self.padded, edges, float(R), kernel) for R in radii]
        self.spectra = [spectrum for spectrum, _ in balls]
        self.powers = [power for _, power in balls]

    def peaks(self, residual: Array, count: int) -> Peaks:
        """Find at most `count` balls that lower the residual's squares most.

        Formula: (r . k)^2 / k . k with r . k > 0, local maxima kept apart
        """
        box = tuple(slice(0, n) for n in self.shape)
        spectrum = np.fft.rfftn(residual, self.padded, AXES)
        best = np.zeros(self.shape)
        which = np.zeros(self.shape, dtype=np.intp)
        for i, (ball, power) in enumerate(zip(self.spectra, self.powers, strict=True)):
            product = np.fft.irfftn(spectrum * ball, self.padded, AXES)[box]
            score = np.maximum(product, 0.0) / np.sqrt(power)
            better = score > best
            best[better], which[better] = score[better], i
        least = ROUNDING * float(np.sqrt(np.square(residual).sum()))
        flat = np.flatnonzero((best > least) & (best >= neighbours_most(best)))
        scores = best.ravel()[flat]
        order = np.argsort(-scores, kind="stable")  # ties by place
        flat, scores = flat[order], scores[order]
        z, y, x = np.unravel_index(flat, self.shape)
        cells = np.stack([x, y, z], axis=1)
        size = which.ravel()[flat]
        kept = apart(cells * self.edges, self.radii[size], count)
        heights = scores / np.sqrt(np.array(self.powers))[size]
        return Peaks(cells[kept], self.radii[size][kept], heights[kept])


def smooth_size(least: int) -> int:
    """Give the next number without prime factors above 5."""
    size = max(least, 1)
    while True:
        left = size
        for factor in SMOOTH:
            while left % factor == 0:
                left //= factor
        if left == 1:
            return size
        size += 1


def padded_shape(
    shape: tuple[int, ...], edges: Array, reach: float
) -> tuple[int, int, int]:
    """Give the sizes of a periodic box in which a grid has room for a reach."""
    room = np.ceil(reach / edges[::-1]).astype(int)
    deep, tall, wide = (
        smooth_size(n + int(m)) for n, m in zip(shape, room, strict=True)
    )
    return deep, tall, wide


def ball_spectrum(
    shape: tuple[int, int, int], edges: Array, radius: float, kernel: Kernel
) -> tuple[Array, float]:
    """Transform a ball around the first voxel of a periodic box; give its squares' sum.

    The ball is even, so that its transform is real.
    """
    squares = []
    for n, edge in zip(shape, edges[::-1], strict=True):
        away = np.minimum(np.arange(n), n - np.arange(n))
        squares.append((away * edge / radius) ** 2)
    ball = profile_of(
        squares[0][:, None, None] + squares[1][:, None] + squares[2], kernel
    )
    return np.fft.rfftn(ball).real, float(np.square(ball).sum())


def neighbours_most(values: Array) -> Array:
    """Give the largest of each value and its 26 neighbours, axis by axis."""
    for axis in range(3):
        lines = np.moveaxis(values, axis, 0)
        most = lines.copy()
        np.maximum(most[1:], lines[:-1], out=most[1:])
        np.maximum(most[:-1], lines[1:], out=most[:-1])
        values = np.moveaxis(most, 0, axis)
    return values


def apart(places: Array, radii: Array, count: int) -> Numbers:
    """Keep places in their order, except those too near to one kept before."""
    kept: list[int] = []
    free = np.ones(len(places), dtype=bool)
    for i in range(len(places)):
        if not free[i]:
            continue
        kept.append(i)
        if len(kept) == count:
            break
        away = np.square(places[i:] - places[i]).sum(axis=1)
        free[i:] &= away >= np.square(APART * (radii[i:] + radii[i]))
    return np.array(kept, dtype=np.intp)
