"""Worley noise as document D first drew it: points anywhere in one picture.

Nothing is hashed by cell here, so every pixel meets every point, and the distances are
divided by the largest one that the picture happens to hold: the same place changes its
value with each point that is added anywhere (E32). `worley_grid` has neither fault.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Range, Seed
from refcloud.noise.hashing import uniform

WHITE = 255.0  # the value of the pixel that is farthest from all points
Side = Annotated[int, Range(1, 1 << 13, "pixels")]


@checked
def worley_drawn(
    width: Side,
    height: Side,
    *,
    count: Annotated[int, Range(1, 1 << 16)] = 64,
    seed: Seed = 0,
    inverted: bool = False,
) -> Array:
    """Give document D's first picture of Worley noise.

    Formula: 255 d / max d, or 255 - 255 d / max d, with d a pixel's distance to the
    nearest point

    Parameters
    ----------
    width, height
        Size of the picture.
    count
        How many points are scattered over it.
    seed
        Which points.
    inverted
        Whether the points are white, as in the document's figure, instead of black.

    Returns
    -------
    Shape (height, width), in [0, 255]: 0 and 255 as near as the pixels come to them.

    Source: document D, 2D Worley noise (N26); E32.

    Examples
    --------
    >>> float(worley_drawn(32, 16, count=9, seed=7).max())
    255.0
    """
    index = np.arange(count)
    px, py = uniform(index, 0, seed=seed) * width, uniform(index, 1, seed=seed) * height
    x, y = np.arange(width) + 0.5, np.arange(height) + 0.5
    squared = np.full((height, width), np.inf)
    for i in range(count):
        dy = (y - py[i]) ** 2
        np.minimum(squared, (x - px[i]) ** 2 + dy[:, np.newaxis], out=squared)
    distance = np.sqrt(squared)
    farthest = float(distance.max())
    # A picture of one pixel may have its point in the middle: no distance at all.
    share = distance / farthest if farthest > 0.0 else distance
    return WHITE * (1.0 - share) if inverted else WHITE * share
