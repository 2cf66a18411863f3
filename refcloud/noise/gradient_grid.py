"""Gradient noise on a grid: hash each lattice point once, contract one axis at a time.

With the weights W of an axis and D = W times the offset from the line, the noise is
``Wz (Wy X + Dy Y) + Dz (Wy Z)``, where X = Dx gx, Y = Wx gy and Z = Wx gz are the
lattice's gradients blended along x: a few additions per sample in place of eight hashes
and eight dot products.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.conventions import Array, Seed, Shape
from refcloud.noise.bands import Axis, _ascending, _axis, _lines
from refcloud.noise.directions import Fade, Gradients, _named
from refcloud.noise.gradient import FADES, How, Period
from refcloud.noise.mixing import Hash, _choice, _joined, lattice_bits
from refcloud.noise.scattered import Dtype, Numbers
from refcloud.products import ONE_THREAD, product

MOST_BLENDED = 1 << 22  # values blended along x that are held at a time: 32 MB


@checked
def gradient_grid(
    x: Annotated[Array, Shape("W")],
    y: Annotated[Array, Shape("H")],
    z: Annotated[Array, Shape("D")] | None = None,
    *,
    seed: Seed = 0,
    fade: Fade = "quintic",
    gradients: Gradients | None = None,
    period: Period | None = None,
    hash: Hash = "mixed",
    dtype: Dtype = "float64",
) -> Numbers:
    """Give gradient noise on a grid: `gradient` at every place, many times faster.

    Formula: n = Wz (Wy (Dx gx) + Dy (Wx gy)) + Dz (Wy (Wx gz)), products of matrices

    Parameters
    ----------
    x, y, z
        Coordinates along each axis, in lattice cells. Any order, any spacing, finite.
        Without z the noise is that of the plane.
    seed
        Which pattern. Patterns of two seeds have nothing in common.
    fade
        How corners are blended. "quintic" has continuous curvature, "hermite" a
        continuous slope (N11, N12).
    gradients
        Which set of gradients. None is the usual one of the dimension (N21).
    period
        After how many cells the pattern repeats along each axis. None is 2^32.
    hash
        How a lattice point chooses its gradient.
    dtype
        Precision of the products and the result; weights are made in float64.

    Returns
    -------
    Shape (D, H, W) as [z, y, x], or (H, W) without z, in [-1, 1].

    Raises
    ------
    ValueError
        The gradient set does not fit the number of axes.

    Source: document S (N20, N21); E14.

    Examples
    --------
    >>> gradient_grid([0.5, 0.75], [1e9, -3.0, 0.0], [0.0], seed=7).shape
    (1, 3, 2)
    """
    axes = (x, y) if z is None else (x, y, z)
    how = How(seed, fade, _named(gradients, len(axes)), period, hash, dtype)
    out = np.empty([axis.size for axis in axes[::-1]], dtype)
    _fill(out, [Layer(axes, how)])
    return out


def _literal(x: Array, y: Array, z: Array, seed: int, rows: Array) -> Array:
    """Give gradient noise as five dense products along each axis, whole at once."""
    W, D, lines = [], [], []
    for axis in (x, y, z):
        lines.append(_lines(axis))
        offset = axis[:, np.newaxis] - lines[-1]  # (samples, lines)
        W.append(1.0 - FADES["quintic"](np.minimum(np.abs(offset), 1.0)))
        D.append(W[-1] * offset)
    bits = lattice_bits(lines[0], lines[1][:, None], lines[2][:, None, None], seed=seed)
    gx, gy, gz = rows[:, _choice(bits, rows.shape[1])]  # [z, y, x] each
    A = W[1] @ (gx @ D[0].T) + D[1] @ (gy @ W[0].T)
    B = W[1] @ (gz @ W[0].T)
    return np.tensordot(W[2], A, 1) + np.tensordot(D[2], B, 1)


@dataclass(frozen=True)
class Layer:
    """One noise of a sum: where its samples lie, how it is made, and its weight."""

    axes: tuple[Array, ...]
    how: How
    scale: float = 1.0

    def ascending(self) -> tuple[Layer, list[NDArray[np.intp] | None]]:
        """Give the layer with its axes reduced and sorted, and their orders."""
        found = [_ascending(c, self.how.period) for c in self.axes]
        places = tuple(place for place, _ in found)
        return Layer(places, self.how, self.scale), [order for _, order in found]

    def part(self, number: int, chosen: slice) -> Layer:
        """Keep some samples of an axis."""
        fewer = list(self.axes)
        fewer[number] = fewer[number][chosen]
        return Layer(tuple(fewer), self.how, self.scale)

    def most(self) -> int:
        """Count the lattice points, or the values blended along x where more."""
        lines = [_lines(places).size for places in self.axes]
        blended = len(lines) * self.axes[0].size * int(np.prod(lines[1:]))
        return max(blended, int(np.prod(lines)))


def _fill(out: Numbers, layers: list[Layer], absolute: bool = False) -> None:
    """Fill out with the sum of layers, or of their absolute values, axes in any order.

    All layers are summed tile by tile, while a tile is in the cache: the result goes
    through memory once.
    """
    if not out.size:
        return
    laid, orders = zip(*(layer.ascending() for layer in layers), strict=True)
    if all(order is None for each in orders for order in each):
        _fill_part(out, list(laid), absolute)
        return
    # Layers that are sorted differently do not share tiles.
    out[...] = 0.0
    for layer, each in zip(laid, orders, strict=True):
        part = np.empty_like(out)
        _fill_part(part, [layer], absolute)
        index = np.ix_(
            *(
                np.arange(n) if order is None else np.argsort(order)
                for n, order in zip(out.shape, each[::-1], strict=True)
            )
        )
        out += part[index]


def _fill_part(out: Numbers, layers: list[Layer], absolute: bool) -> None:
    """Fill a part of a grid, halved until what is blended along x is small enough."""
    if max(layer.most() for layer in layers) > MOST_BLENDED and out.size > 1:
        longest = int(np.argmax(out.shape))
        half = out.shape[longest] // 2
        for chosen in (slice(None, half), slice(half, None)):
            where = (slice(None),) * longest + (chosen,)
            fewer = [layer.part(out.ndim - 1 - longest, chosen) for layer in layers]
            _fill_part(out[where], fewer, absolute)
        return
    laid = [
        [_axis(p, k, layer.how) for k, p in enumerate(layer.axes)] for layer in layers
    ]
    levels = [
        _blended_along_x(axes, layer.how, layer.scale)
        for axes, layer in zip(laid, layers, strict=True)
    ]
    for rows, tile in enumerate(laid[0][1].tiles):
        made = (
            _values(level, axes, rows) for level, axes in zip(levels, laid, strict=True)
        )
        for same in zip(*made, strict=True):
            planes, total = same[0]
            if absolute:
                np.abs(total, out=total)
            for _, values in same[1:]:
                total += np.abs(values, out=values) if absolute else values
            out[(planes, tile.samples) if out.ndim == 3 else tile.samples] = total


def _blended_along_x(
    axes: list[Axis], how: How, scale: float
) -> tuple[Numbers, Numbers]:
    """Give X and Y of every lattice row, (Lz, 2 Ly, W), and Z of it, (Lz, Ly, W)."""
    words = [axis.bits.reshape(-1, *[1] * number) for number, axis in enumerate(axes)]
    pick = _choice(_joined(words, how.seed, how.hash), how.rows().shape[1])
    pick = pick.reshape(-1, pick.shape[-1])  # one row of the lattice along x each
    rows = (how.rows() * scale).astype(how.dtype)
    xy = np.empty((len(pick), 2, axes[0].size), how.dtype)
    z = np.empty((len(pick) if len(axes) == 3 else 0, axes[0].size), how.dtype)
    for k, out in enumerate((xy[:, 0], xy[:, 1], z)[: len(axes)]):
        slopes = rows[k].take(pick, mode="wrap")
        for tile in axes[0].tiles:
            # Only along x itself does the offset count.
            weights = (tile.weights if k else tile.slopes).T
            step = max(1, ONE_THREAD // weights.size)
            for first in range(0, len(pick), step):
                part = slice(first, first + step)
                np.matmul(
                    slopes[part, tile.lines], weights, out=out[part, tile.samples]
                )
    high = axes[1].bits.size
    return xy.reshape(-1, 2 * high, axes[0].size), z.reshape(-1, high, axes[0].size)


def _values(
    level: tuple[Numbers, Numbers], axes: list[Axis], rows: int
) -> Iterator[tuple[slice, Numbers]]:
    """Blend along y for one tile of rows, then along z: planes, and their noise."""
    xy, z = level
    tile = axes[1].tiles[rows]
    height, width = len(tile.weights), xy.shape[-1]
    pairs = slice(2 * tile.lines.start, 2 * tile.lines.stop)
    blended = np.empty((len(xy), 2, height, width), xy.dtype)
    product(tile.both, xy[:, pairs], blended[:, 0])
    if len(axes) == 2:
        yield slice(None), blended[0, 0]
        return
    product(tile.weights, z[:, tile.lines], blended[:, 1])
    blended = blended.reshape(-1, height * width)
    for planes in axes[2].tiles:
        values = np.empty((len(planes.weights), height * width), xy.dtype)
        pairs = slice(2 * planes.lines.start, 2 * planes.lines.stop)
        product(planes.both, blended[pairs], values)
        yield planes.samples, values.reshape(-1, height, width)
