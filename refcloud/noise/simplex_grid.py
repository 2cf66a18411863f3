"""Simplex noise on a grid: a few rows at a time, since it has no separable form."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Seed, Shape
from refcloud.noise.directions import Radius
from refcloud.noise.mixing import Hash
from refcloud.noise.scattered import CHUNK, Dtype, Numbers
from refcloud.noise.simplex import WRAP, _simplex
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
    out = np.empty(shape, dtype).reshape(-1, x.size)
    step = max(1, CHUNK // max(1, x.size))
    for first in range(0, len(out) if x.size else 0, step):
        rows = np.arange(first, min(first + step, len(out)))
        places = np.unravel_index(rows, shape[:-1])[::-1]  # of y, z, w
        columns = np.empty((len(axes), rows.size, x.size))
        columns[0] = axes[0]
        for column, axis, place in zip(columns[1:], axes[1:], places, strict=True):
            column[:] = axis[place][:, np.newaxis]
        noise = _simplex(columns.reshape(len(axes), -1), seed, radius, hash, dtype)
        out[rows] = noise.reshape(rows.size, -1)
    return out.reshape(shape)
