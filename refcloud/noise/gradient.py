"""Gradient noise: at every lattice point a slope, and between them a smooth blend.

A lattice point contributes the dot of its gradient and the offset from it, which is 0
at the point itself. The corners' contributions are weighted by the fade along each
axis. Range [-1, 1] by theorem (see `directions`), 0 at lattice points.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.conventions import Array, Range, Seed
from refcloud.noise.directions import PEAKS, SETS, Fade, Gradients, _named
from refcloud.noise.gradient_pairs import (
    Lattice,
    PairBox,
    _hashed_pairs,
    _pair_box,
    _paired,
)
from refcloud.noise.interpolate import _hermite_weight, _quintic_weight
from refcloud.noise.mixing import Hash, _axis_bits, _choice, _joined, lattice_bits
from refcloud.noise.scattered import (
    Dtype,
    Numbers,
    Places,
    _dimensions,
    _floored,
    _places,
    _Room,
    _scattered,
    _split,
)

Period = Annotated[int, Range(1, 2**31)]

FADES = {"quintic": _quintic_weight, "hermite": _hermite_weight}
FADE_SLOPES = {
    "quintic": lambda t: 30.0 * (t * (1.0 - t)) ** 2,
    "hermite": lambda t: 6.0 * t * (1.0 - t),
}


@checked
def gradient(
    points: Places,
    *,
    seed: Seed = 0,
    fade: Fade = "quintic",
    gradients: Gradients | None = None,
    period: Period | None = None,
    hash: Hash = "mixed",
    dtype: Dtype = "float64",
) -> Numbers:
    """Give gradient noise (classic Perlin) at scattered points.

    Formula: n(p) = sum over the cell's corners c of w(p - c) g(c) . (p - c), scaled

    Parameters
    ----------
    points
        Shape (..., 2), (..., 3) or (..., 4), in lattice cells. NaN or infinity gives
        NaN.
    seed
        Which pattern. Patterns of two seeds have nothing in common.
    fade
        How corners are blended. "quintic" has continuous curvature, "hermite" a
        continuous slope (N11, N12).
    gradients
        Which set of gradients. None is "directions8" in the plane, "edges12" in space
        and "edges32" in four dimensions; "diagonals4" and "corners8" are the others
        (N21).
    period
        After how many cells the pattern repeats along each axis. None is 2^32.
    hash
        How a lattice point chooses its gradient. "table" is the shuffled table, with
        its period of 256 cells (N03).
    dtype
        Precision of the arithmetic and the result; places are split in float64.

    Returns
    -------
    Shape (...,), in [-1, 1], 0 at lattice points.

    Raises
    ------
    ValueError
        The gradient set does not fit the number of coordinates.

    Source: document S (N20, N21); E14.

    Examples
    --------
    >>> gradient(np.zeros((4, 2, 3)), seed=7).shape
    (4, 2)
    """
    count = _dimensions(points, (2, 3, 4))
    how = How(seed, fade, _named(gradients, count), period, hash, dtype)
    if count == 4:  # 32 gradients make 1024 pairs: no byte holds their number
        return _scattered(points, lambda axes: _by_corners(axes, how), dtype, period)
    box, room = _pair_box(points, how.lattice()), _Room()
    return _scattered(
        points,
        lambda axes: _gradient(axes, how, box, room),
        dtype,
        period,
        inside=bool(box),
    )


@checked
def gradient_derivative(
    points: Places,
    *,
    seed: Seed = 0,
    fade: Fade = "quintic",
    gradients: Gradients | None = None,
    period: Period | None = None,
    hash: Hash = "mixed",
    dtype: Dtype = "float64",
) -> tuple[Numbers, Numbers]:
    """Give gradient noise and its derivative, from one visit of the corners.

    Formula: dn/dx_k = sum over c of dw/dx_k g . (p - c) + w g_k, scaled

    Parameters
    ----------
    points
        Shape (..., 2), (..., 3) or (..., 4), in lattice cells. NaN or infinity gives
        NaN.
    seed
        Which pattern.
    fade
        How corners are blended.
    gradients
        Which set of gradients. None is the usual one of the dimension.
    period
        After how many cells the pattern repeats along each axis. None is 2^32.
    hash
        How a lattice point chooses its gradient.
    dtype
        Precision of the arithmetic and the result.

    Returns
    -------
    The noise, shape (...,), and its derivative per cell, shape (..., N).

    Source: document S (N20, N23).

    Examples
    --------
    >>> noise, slope = gradient_derivative(np.zeros((4, 2)), seed=7)
    >>> noise.shape, slope.shape
    ((4,), (4, 2))
    """
    count = _dimensions(points, (2, 3, 4))
    how = How(seed, fade, _named(gradients, count), period, hash, dtype)
    both = _scattered(
        points, lambda axes: _derivative(axes, how), dtype, period, 1 + count
    )
    return both[..., 0], both[..., 1:]


@dataclass(frozen=True)
class How:
    """How gradient noise is made."""

    seed: int
    fade: Fade
    gradients: Gradients
    period: int | None
    hash: Hash
    dtype: Dtype

    def rows(self) -> Array:
        """Give the gradients, scaled, one row per axis."""
        return SETS[self.gradients].T / PEAKS[self.gradients][self.fade]

    def lattice(self) -> Lattice:
        """Give which gradient each lattice point has."""
        return Lattice(len(SETS[self.gradients]), self.seed, self.hash, self.period)


def _literal(points: Array, seed: int, fade: Fade, name: Gradients) -> Array:
    """Give gradient noise as its formula says it: corner by corner, whole at once."""
    cells = np.floor(points)
    total = np.zeros(points.shape[:-1])
    for corner in itertools.product((0, 1), repeat=points.shape[-1]):
        offset = points - cells - corner  # (..., N)
        lattice = np.moveaxis((cells + corner).astype(np.int64), -1, 0)
        slope = SETS[name][_choice(lattice_bits(*lattice, seed=seed), len(SETS[name]))]
        weight = np.prod(1.0 - FADES[fade](np.abs(offset)), axis=-1)
        total += weight * np.sum(slope * offset, axis=-1)
    return total / PEAKS[name][fade]


def _gradient(
    columns: Array, how: How, box: PairBox | None = None, room: _Room | None = None
) -> Numbers:
    """Give gradient noise at finite points, coordinates in rows, shape (N, n).

    The next call with the same room overwrites the result.
    """
    room = room or _Room()
    cells = _floored(columns, room)
    if box is None:
        pairs = _hashed_pairs(cells, how.lattice())
    else:
        pairs = box.at(cells, room)
    places = _places(columns, cells, how.dtype, room)
    return _paired(places, FADES[how.fade](places), pairs, how.rows(), room)


def _by_corners(columns: Array, how: How) -> Numbers:
    """Give gradient noise of any dimension: dots at the corners, blended by axes."""
    slopes, offsets, fades = _corners(columns, how)
    dot = slopes[0]
    dot *= offsets[0]
    for g, offset in zip(slopes[1:], offsets[1:], strict=True):
        g *= offset
        dot += g
    for fade in fades[::-1]:
        dot = _blended(dot, fade)
    return dot


def _derivative(columns: Array, how: How) -> list[Numbers]:
    """Give gradient noise and its derivative along each axis."""
    slopes, offsets, fades = _corners(columns, how)
    dot = sum(g * offset for g, offset in zip(slopes, offsets, strict=True))
    results = [dot, *slopes]
    for fade in fades[::-1]:
        results = [_blended(values, fade) for values in results]
    # The fade itself changes along axis k: blend the ends' difference by the others.
    for k, offset in enumerate(offsets):
        change = np.diff(dot, axis=k).squeeze(k)
        for fade in np.delete(fades, k, axis=0)[::-1]:
            change = _blended(change, fade)
        steps = FADE_SLOPES[how.fade](offset.reshape(2, -1)[0])
        results[1 + k] = results[1 + k] + steps * change
    return results


def _ends(cell: NDArray[np.int64], period: int | None) -> NDArray[Any]:
    """Give the lattice coordinates of both ends of cells, (2, n), modulo the period."""
    if period is None:
        low = cell.astype(np.uint32)
        return np.stack((low, low + np.uint32(1)))
    return np.mod(np.stack((cell, cell + 1)), period)


def _blended(values: Numbers, fade: Numbers) -> Numbers:
    """Blend the two ends of the last axis of corners, (..., 2, n) to (..., n)."""
    low = values[..., 0, :]
    change = values[..., 1, :] - low
    change *= fade
    change += low
    return change


def _corners(columns: Array, how: How) -> tuple[list[Numbers], list[Numbers], Numbers]:
    """Give the corners' gradients and offsets, and how far each axis is blended.

    Gradients are one array (2, ..., 2, n) per axis; an offset along an axis is that of
    its two ends, and broadcasts against them; the fades are (N, n).
    """
    cells, places = _split(columns, how.dtype)
    ends = np.array([[0], [1]])
    words, offsets = [], []
    for k, (cell, t) in enumerate(zip(cells, places, strict=True)):
        shape = [2 if axis == k else 1 for axis in range(len(cells))]
        both = _ends(cell, how.period)
        words.append(_axis_bits(both, k, how.seed, how.hash).reshape(*shape, -1))
        offsets.append((t - ends.astype(how.dtype)).reshape(*shape, -1))
    rows = np.ascontiguousarray(how.rows(), how.dtype)
    pick = _choice(_joined(words, how.seed, how.hash), rows.shape[1])
    slopes = [row.take(pick, mode="wrap") for row in rows]
    return slopes, offsets, FADES[how.fade](places)
