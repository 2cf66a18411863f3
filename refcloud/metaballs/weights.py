"""What each voxel counts in the clustering: dense ones and those near the rim more."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Positive, Range, Shape

# Weights grow with this power of density: heights alone cannot set right what the
# clustering has done, and most is to be fitted where the cloud is dense.
POWER = 1.5
# Beside the rim's weight a voxel of almost no density counts as a fifth of the densest:
# balls that are refined keep an outline that thin voxels draw.
FLOOR = 0.2
# Depths above this many rim depths weigh as the inside: exp(-12) is 6e-6.
DEEP = 12.0


@checked
def depth(
    density: Annotated[Array, Shape("D", "H", "W"), Range(0.0)],
    edges: Annotated[Array, Shape(3), Positive],
    *,
    most: Annotated[float, Positive] = 64.0,
) -> Array:
    """Give each voxel's distance to the centre of the nearest empty one.

    Formula: exact Euclidean distance, as minima over one axis after the other

    Parameters
    ----------
    density
        Shape (D, H, W) as ``[z, y, x]``. Outside the grid all voxels are empty.
    edges
        Edges of a voxel along x, y, z; the distance has their unit.
    most
        Largest distance that is told apart.

    Returns
    -------
    Shape (D, H, W), 0 where empty, never above ``most``.

    Source: not in the papers.

    Examples
    --------
    >>> depth(np.ones((1, 3, 3)), [1.0, 1.0, 1.0])[0, 1]
    array([1., 1., 1.])
    """
    squares = np.where(np.pad(density, 1) > 0.0, most * most, 0.0)
    for axis, edge in enumerate(edges[::-1]):
        lines = np.moveaxis(squares, axis, 0)
        before = lines.copy()
        largest = float(before.max())
        # The parabola of a neighbour k voxels away can lower nothing once it is higher.
        for k in range(1, len(lines)):
            step = (k * float(edge)) ** 2
            if step >= largest:
                break
            np.minimum(lines[k:], before[:-k] + step, out=lines[k:])
            np.minimum(lines[:-k], before[k:] + step, out=lines[:-k])
    return np.sqrt(squares[1:-1, 1:-1, 1:-1])


def voxel_weights(density: Array, edges: Array, rim: float, rim_depth: float) -> Array:
    """Weigh occupied voxels by density and nearness to the rim, shape (K,).

    Formula: (density / largest)^1.5, or with a rim
    (0.2 + density / largest) (1 + rim exp(-depth / rim_depth))
    """
    inside = density > 0.0
    shares = density[inside] / density.max(initial=0.0, where=inside)
    if rim == 0.0:
        return shares**POWER
    most = max(DEEP * rim_depth, float(edges.max()))
    near = np.exp(-depth(density, edges, most=most)[inside] / rim_depth)
    return (FLOOR + shares) * (1.0 + rim * near)
