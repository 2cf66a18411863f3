"""The one order in which balls are drawn."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.conventions import Array, Shape
from refcloud.metaballs import Metaballs


@checked
def depth_order(
    balls: Metaballs, depth: Annotated[Array, Shape("N")]
) -> NDArray[np.intp]:
    """Sort balls near to far.

    Formula: by depth along the view axis; ties by x, y, z, R and density, so that the
    order of the input never shows

    Parameters
    ----------
    balls
        The cloud, N balls.
    depth
        Depth of each centre along the view axis, shape (N,).

    Returns
    -------
    Indices, shape (N,), nearest first.

    Source: paper M, sections 4.1 and 4.2; E26.

    Examples
    --------
    >>> balls = Metaballs(np.eye(3), [1.0, 1.0, 1.0], [1.0, 1.0, 1.0])
    >>> depth_order(balls, [2.0, 1.0, 2.0])
    array([1, 2, 0])
    """
    order = np.argsort(depth)
    ranked = depth[order]
    if (ranked[1:] > ranked[:-1]).all():  # no ties: the only order, found sooner
        return order
    x, y, z = balls.centers.T
    return np.lexsort((balls.densities, balls.radii, z, y, x, depth))
