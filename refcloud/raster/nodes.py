"""A tile of wide, smooth balls from few places: Chebyshev nodes and their polynomial.

Where every ball is much wider than the distance between nodes, the picture inside a
tile is nearly a polynomial: n x n nodes give all of its pixels. How nearly shows in the
polynomial itself: the terms of a smooth picture fall with their degree, so the size of
the last ones tells what the missing ones are worth.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from refcloud.conventions import Array
from refcloud.raster.quadratics import Floats
from refcloud.raster.tile_lists import SIDE

LAST = 3  # degrees whose terms estimate the error: a kink may hide from one or two
# Largest error of a tile's pixels over the sum of its last terms. Of errors over 0.0005
# the worst seen is 1.16, in 174,000 such tiles of scenes of all sorts; 0.17 is common.
PER_TAIL = 1.2
# A ball's opacity rises within radius / sqrt(tau) from its rim, or within its radius.
# Where that is less than this many spacings, the nodes could miss what the pixels show.
LEAST_RISE = 4.0


@dataclass(frozen=True, eq=False)
class Nodes:
    """n x n Chebyshev nodes of a tile, and matrices that act on values there.

    Attributes
    ----------
    n
        Nodes along an edge.
    places
        x and y from the tile's middle, pixels, shape (n^2,), row after row.
    coefficients
        Values along a line of nodes to those of T_0 to T_{n-1}, shape (n, n).
    spread
        Values at nodes to values at pixels, shape (n^2, 256).
    tail
        Values at nodes to the coefficients of the last degrees, shape (n^2, K).
    """

    n: int
    places: tuple[Array, Array]
    coefficients: Floats
    spread: Floats
    tail: Floats

    @property
    def spacing(self) -> float:
        """Give the mean distance between nodes, pixels."""
        return SIDE / self.n

    @property
    def one_sided(self) -> float:
        """Give the most that errors from 0 to 1 at all nodes make at a pixel."""
        return one_sided(self.spread)

    def error_of(self, values: Floats) -> Floats:
        """Estimate how far pixels made of these nodes are off.

        Parameters
        ----------
        values
            Shape (T, C, n^2).

        Returns
        -------
        Largest over the channels, shape (T,).
        """
        last = np.matmul(values, self.tail.astype(values.dtype))
        return PER_TAIL * np.abs(last, out=last).sum(axis=2).max(axis=1)

    def spread_to(self, along: Array) -> Floats:
        """Give the matrix from values at nodes to those on a grid, (n^2, m^2).

        Parameters
        ----------
        along
            Where the grid's lines are, from the tile's middle, pixels, shape (m,).
        """
        angle = np.arccos(along / (SIDE / 2))
        to_lines = np.cos(angle[:, None] * np.arange(self.n)) @ self.coefficients
        return np.kron(to_lines, to_lines).T

    def at_pixels(self, values: Floats) -> Floats:
        """Evaluate the polynomial at the pixels' centres: (T, C, n^2) to (T, C, 256).

        One small product for each tile: the same bits whatever the number of threads.
        """
        return np.matmul(values, self.spread.astype(values.dtype))


def one_sided(spread: Floats) -> float:
    """Give the most that errors from 0 to 1 at all nodes make at a place.

    Parameters
    ----------
    spread
        Values at nodes to values at places, shape (n^2, S).
    """
    more = np.maximum(spread, 0.0).sum(axis=0).max()
    less = np.minimum(spread, 0.0).sum(axis=0).min()
    return float(max(more, -less))


@functools.cache
def nodes(n: int) -> Nodes:
    """Set up n x n nodes, for balls as large as a picture has them.

    Parameters
    ----------
    n
        Nodes along a tile's edge, above `LAST`.

    Returns
    -------
    The nodes.
    """
    # 1. The nodes are the zeros of T_n, from edge to edge of the tile.
    angle = (2.0 * np.arange(n) + 1.0) * np.pi / (2.0 * n)
    at = np.cos(angle) * (SIDE / 2)
    # 2. Values to coefficients of T_0 ... T_{n-1}, by the cosines' orthogonality.
    degree = np.arange(n)
    coefficients = np.cos(degree[:, None] * angle) * (2.0 / n)  # (degree, node)
    coefficients[0] /= 2.0
    # 3. And from coefficients to the pixels' centres.
    pixel = np.arccos(np.arange(0.5 - SIDE / 2, SIDE / 2) / (SIDE / 2))
    to_pixels = np.cos(pixel[:, None] * degree) @ coefficients  # (16, n)
    both = np.kron(coefficients, coefficients)  # y and x: (n^2 coefficients, n^2)
    largest = np.maximum(np.repeat(degree, n), np.tile(degree, n))
    return Nodes(
        n,
        (np.tile(at, n), np.repeat(at, n)),
        coefficients,
        np.ascontiguousarray(np.kron(to_pixels, to_pixels).T),
        np.ascontiguousarray(both[largest >= n - LAST].T),
    )
