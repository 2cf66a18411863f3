"""Fractal noise as a texture: drawn once, then looked up as often as a shader likes.

The document's two-stage rendering (R09): a first pass sums the octaves for every texel,
a second samples the texture. Octaves too fine for a texel are left out. The texture
repeats, so that a plane to the horizon needs one; with a time it also repeats after as
many units of time as it has cells.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Range, Seed, Shape, Skipped
from refcloud.noise import fbm_grid, wrapped_bilinear
from refcloud.noise.kinds import KindName
from refcloud.noise.octaves import Octaves, Persistence
from refcloud.noise.scattered import Dtype, Numbers

Size = Annotated[int, Range(1, 1 << 13, "texels")]
Cells = Annotated[int, Range(1, 1 << 12, "cells")]


@checked
def fractal_texture(
    size: Size,
    *,
    cells: Cells = 8,
    time: float | None = None,
    seed: Seed = 0,
    octaves: Octaves = 5,
    persistence: Persistence = 0.5,
    dtype: Dtype = "float64",
) -> tuple[Numbers, tuple[Skipped, ...]]:
    """Draw fractal noise to a square texture that repeats.

    Formula: fbm(cells (i + 1/2) / size, cells (j + 1/2) / size, time), period cells

    Parameters
    ----------
    size
        Texels along each side.
    cells
        Cells of the first octave along each side.
    time
        A third coordinate; None adds none. It repeats after `cells`.
    seed
        Which pattern.
    octaves
        How many octaves are summed, those left out that are finer than a texel.
    persistence
        Each octave's amplitude relative to the one before.
    dtype
        Precision of the arithmetic and the result.

    Returns
    -------
    Shape (size, size) as [v, u], in [-1, 1], and a row for octaves left out.

    Source: document S, section 5.1 (R09, N18, N24).

    Examples
    --------
    >>> fractal_texture(16, cells=2, time=0.5)[0].shape
    (16, 16)
    """
    line = texel_line(size, cells)
    return fbm_grid(
        line,
        line,
        time=time,
        seed=seed,
        octaves=octaves,
        persistence=persistence,
        period=cells,
        dtype=dtype,
        finest=cells / size,
    )


@checked
def fractal_volume(
    size: Annotated[int, Range(1, 512, "texels")],
    *,
    cells: Cells = 4,
    time: float | None = None,
    kind: KindName = "simplex",
    seed: Seed = 0,
    octaves: Octaves = 4,
    persistence: Persistence = 0.5,
    dtype: Dtype = "float64",
) -> tuple[Numbers, tuple[Skipped, ...]]:
    """Draw fractal noise to a texture in space, for a solid sphere within it.

    Formula: fbm at cells (i + 1/2) / size along each axis, and at a time

    Parameters
    ----------
    size
        Texels along each side.
    cells
        Cells of the first octave along each side.
    time
        A fourth coordinate; None adds none.
    kind
        Which noise; "simplex" takes space and time together, and does not repeat.
    seed
        Which pattern.
    octaves
        How many octaves are summed, those left out that are finer than a texel.
    persistence
        Each octave's amplitude relative to the one before.
    dtype
        Precision of the arithmetic and the result.

    Returns
    -------
    Shape (size, size, size) as [z, y, x], in [-1, 1], and a row for octaves left out.

    Raises
    ------
    ValueError
        The kind has no noise of so many coordinates.

    Source: document S, section 5.2 (F11, F15, N24).

    Examples
    --------
    >>> fractal_volume(8, cells=2, time=0.5)[0].shape
    (8, 8, 8)
    """
    line = texel_line(size, cells)
    return fbm_grid(
        line,
        line,
        line,
        kind=kind,
        time=time,
        seed=seed,
        octaves=octaves,
        persistence=persistence,
        dtype=dtype,
        finest=cells / size,
    )


def texel_line(size: int, cells: int) -> Array:
    """Give the middles of texels along a side, in cells."""
    return cells * (np.arange(size) + 0.5) / size


@checked
def looked_up(
    texture: Annotated[Array, Shape("H", "W"), Range()],
    coordinates: Annotated[Array, Shape("...", 2), Range()],
) -> Array:
    """Look values up in a texture that repeats, between texels linearly.

    Formula: the bilinear mean of the four texels around (u W - 1/2, v H - 1/2)

    Parameters
    ----------
    texture
        One channel, shape (H, W) as [v, u].
    coordinates
        u and v, shape (..., 2); the texture covers [0, 1].

    Returns
    -------
    Shape (...,).

    Source: document S, section 5.1 (R09): LINEAR and REPEAT of OpenGL.

    Examples
    --------
    >>> looked_up([[0.0, 1.0]], [[0.25, 0.5], [0.5, 0.5], [1.0, 0.5]])
    array([0. , 0.5, 0.5])
    """
    height, width = texture.shape
    u, v = coordinates[..., 0], coordinates[..., 1]
    return wrapped_bilinear(texture, u * width - 0.5, v * height - 0.5)
