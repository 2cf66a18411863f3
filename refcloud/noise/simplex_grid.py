"""Simplex noise on a grid: a few rows at a time, since it has no separable form.

Grids of space with a whole number of samples per unit go the way of `simplex_phases`.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Seed, Shape
from refcloud.noise.directions import Radius
from refcloud.noise.mixing import Hash
from refcloud.noise.scattered import Dtype, Numbers, _chunk, _Room
from refcloud.noise.simplex import WRAP, _simplex
from refcloud.noise.simplex import _literal as _pointwise
from refcloud.noise.simplex_corners import PEAKS
from refcloud.noise.simplex_phases import _on_blocks, _regular
from refcloud.refusal import complaint


@checked
def simplex_grid(
    x: Annotated[Array, Shape("W")],
    y: Annotated[Array, Shape("H")],
    z: Annotated[Array, Shape("D")] | None = None,
    w: Annotated[Array, Shape("T")] | None = None,
    *,
    seed: Seed = 0,
    radius: Radius = "continuous",
    hash: Hash = "mixed",
    dtype: Dtype = "float64",
) -> Numbers:
    """Give simplex noise on a grid: `simplex` at every place.

    Formula: n[..., j, i] = n(x_i, y_j, ...)

    Parameters
    ----------
    x, y
        Coordinates along the first two axes. Any order, any spacing, finite.
    z
        Coordinates along a third axis. Without it the noise is that of the plane.
    w
        Coordinates along a fourth axis, for instance time (N24).
    seed
        Which pattern.
    radius
        How far a corner reaches. "continuous" is r^2 = 1/2, "usual" is r^2 = 0.6, which
        jumps between simplices (E30).
    hash
        How a lattice point chooses its gradient.
    dtype
        Precision of the arithmetic and the result; offsets are found in float64.

    Returns
    -------
    Shape (T, D, H, W) as [w, z, y, x], (D, H, W) or (H, W), in [-1, 1].

    Raises
    ------
    ValueError
        There is w without z.

    Source: document S (N22, N24); E30.

    Examples
    --------
    >>> simplex_grid([0.5, 0.75], [1e9, -3.0, 0.0], [0.0], seed=7).shape
    (1, 3, 2)
    """
    if z is None and w is not None:
        raise ValueError(complaint("z", "a third axis, as there is a fourth", "none"))
    axes = [np.fmod(axis, WRAP) for axis in (x, y, z, w) if axis is not None]
    shape = [axis.size for axis in axes[::-1]]
    if radius == "continuous" and (cut := _regular(axes)) is not None:
        whole = _on_blocks(cut, seed, hash, PEAKS[3, radius], dtype)
        depth, height, width = shape
        return np.ascontiguousarray(whole[:depth, :height, :width])
    return _by_rows(axes, seed, radius, hash, dtype).reshape(shape)


def _literal(axes: list[Array], seed: int, radius: Radius) -> Array:
    """Give simplex noise of every place of a grid, as its formula says it."""
    mesh = np.meshgrid(*axes[::-1], indexing="ij")
    return _pointwise(np.stack(mesh[::-1], axis=-1), seed, radius)


def _by_rows(
    axes: list[Array], seed: int, radius: Radius, hash: Hash, dtype: Dtype
) -> Numbers:
    """Give simplex noise on any grid, shape (rows, W), a few rows at a time."""
    x, *others = axes
    shape = [axis.size for axis in others[::-1]]
    out = np.empty((int(np.prod(shape)), x.size), dtype)
    step, room = max(1, _chunk(dtype) // max(1, x.size)), _Room()
    for first in range(0, len(out) if x.size else 0, step):
        rows = np.arange(first, min(first + step, len(out)))
        places = np.unravel_index(rows, shape)[::-1]  # of y, z, w
        columns = [
            axis[place][:, np.newaxis]
            for axis, place in zip(others, places, strict=True)
        ]
        lines = [x[np.newaxis], *columns]
        part = slice(first, first + rows.size)
        out[part] = _simplex(lines, seed, radius, hash, dtype, room)
    return out
