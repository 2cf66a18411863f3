"""Moving a cloud of balls in the world."""

from __future__ import annotations

import dataclasses
import math
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Positive, Range, Vector
from refcloud.metaballs.balls import Metaballs


@checked
def placed(
    balls: Metaballs,
    offset: Vector,
    *,
    turn: Annotated[float, Range(-math.tau, math.tau, "radians")] = 0.0,
    scale: Annotated[float, Positive] = 1.0,
) -> Metaballs:
    """Turn a cloud about the y axis, scale it, and move it.

    Formula: c' = scale Ry(turn) c + offset, R' = scale R, density' = density / scale,
    which keeps every optical depth

    Parameters
    ----------
    balls
        The cloud.
    offset
        Added last, shape (3,), scene units.
    turn
        Angle about +y, radians; positive takes +z toward +x.
    scale
        Factor on all lengths, above 0.

    Returns
    -------
    The moved cloud.

    Source: paper M, section 4 (the cloud's place in the scene).

    Examples
    --------
    >>> balls = Metaballs([[0.0, 0.0, 1.0]], [1.0], [1.0])
    >>> placed(balls, [0, 5, 0], turn=np.pi / 2, scale=2.0).centers.round(9)
    array([[2., 5., 0.]])
    """
    c, s = math.cos(turn), math.sin(turn)
    rotation = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    centers: Array = scale * (balls.centers @ rotation.T) + offset
    return dataclasses.replace(
        balls,
        centers=centers,
        radii=balls.radii * scale,
        densities=balls.densities / scale,
    )
