"""Mipmaps: a texture at half its size, again and again, down to one texel.

A texel of the next level is the mean of what it covers. Where a side is odd it covers
two texels and parts of a third, so that every level has the texture's mean.
"""

from __future__ import annotations

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array

WHITE = 255.0  # the largest code of 8 bits


@checked
def mip_levels(texels: Array) -> tuple[Array, ...]:
    """Make every level of a texture.

    Formula: sides max(1, floor(n / 2)); m texels of n = 2 m: the mean of two; of
    n = 2 m + 1: ((m - i) a + m b + (i + 1) c) / n of the texels 2 i, 2 i + 1, 2 i + 2

    Parameters
    ----------
    texels
        Shape (H, W, C) or (D, H, W, C).

    Returns
    -------
    The levels from 0, the texture itself, to the one of a single texel.

    Source: OpenGL 4.6, section 8.14.3 (mipmapping) and 8.14.4 (glGenerateMipmap, whose
    filter it leaves open); document C (F06).

    Examples
    --------
    >>> [level.ravel().tolist() for level in mip_levels([[[0.0], [1.0], [5.0]]])]
    [[0.0, 1.0, 5.0], [2.0]]
    """
    levels = [texels]
    while max(levels[-1].shape[:-1]) > 1:
        level = levels[-1]
        for axis in range(level.ndim - 1):
            level = _halved(level, axis)
        levels.append(level)
    return tuple(levels)


def _halved(texels: Array, axis: int) -> Array:
    """Halve one side; a side of 1 stays."""
    size = texels.shape[axis]
    half = size // 2
    if half == 0:
        return texels
    along = np.moveaxis(texels, axis, 0)
    a, b = along[0 : 2 * half : 2], along[1 : 2 * half : 2]
    if size == 2 * half:
        mean = 0.5 * (a + b)
    else:
        i = np.arange(half, dtype=np.float64).reshape(-1, *(1,) * (texels.ndim - 1))
        c = along[2 : 2 * half + 1 : 2]
        mean = ((half - i) * a + half * b + (i + 1.0) * c) / size
    return np.moveaxis(mean, 0, axis)
