"""The density of a set of metaballs: at points, and on a grid."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Shape
from refcloud.metaballs.balls import Metaballs
from refcloud.metaballs.kernels import profile_of

CHUNK = 1 << 18  # point-ball pairs at a time: 2 MB of float64 for each temporary


@checked
def field(balls: Metaballs, points: Annotated[Array, Shape("...", 3)]) -> Array:
    """Sum the densities of all balls at points.

    Formula: rho(P) = sum of density_i f(R_i, |P - c_i|)

    Parameters
    ----------
    balls
        The cloud.
    points
        Shape (..., 3) as x, y, z, scene units.

    Returns
    -------
    The density, shape (...).

    Source: paper M, eq 13.

    Examples
    --------
    >>> field(Metaballs([[0, 0, 0]], [2.0], [3.0]), [[0, 0, 0], [1, 0, 0]])
    array([3. , 1.5])
    """
    flat = points.reshape(-1, 3)
    total = np.zeros(len(flat))
    rows = max(1, CHUNK // max(1, len(balls)))
    for start in range(0, len(flat), rows):
        part = flat[start : start + rows]
        q = np.zeros((len(part), len(balls)))  # (rows, N)
        with np.errstate(over="ignore"):  # far away is outside, however far
            for axis in range(3):
                away = part[:, axis, None] - balls.centers[:, axis]
                q += (away / balls.radii) ** 2
        shares = profile_of(q, balls.kernel)
        total[start : start + rows] = np.einsum("ij,j->i", shares, balls.densities)
    return total.reshape(points.shape[:-1])


@checked
def field_grid(
    balls: Metaballs,
    x: Annotated[Array, Shape("W")],
    *,
    y: Annotated[Array, Shape("H")],
    z: Annotated[Array, Shape("D")],
) -> Array:
    """Sum the densities of all balls on a rectilinear grid.

    Formula: as `field`; each ball is added inside its own box of samples.

    Parameters
    ----------
    balls
        The cloud.
    x
        Coordinates of the samples along x, ascending, shape (W,), scene units.
    y
        Coordinates of the samples along y, ascending, shape (H,), scene units.
    z
        Coordinates of the samples along z, ascending, shape (D,), scene units.

    Returns
    -------
    The density as ``[z, y, x]``, shape (D, H, W).

    Raises
    ------
    ValueError
        Coordinates do not ascend.

    Source: paper M, eq 13.

    Examples
    --------
    >>> field_grid(Metaballs([[0, 0, 0]], [2.0], [3.0]), [0.0, 1.0], y=[0.0], z=[0.0])
    array([[[3. , 1.5]]])
    """
    axes = (x, y, z)
    for name, axis in zip("xyz", axes, strict=True):
        if np.any(axis[1:] <= axis[:-1]):
            raise ValueError(f"{name}: expected ascending coordinates, got others")
    total = np.zeros((len(z), len(y), len(x)))
    reach = balls.radii[:, None]
    with np.errstate(over="ignore"):
        lower, upper = balls.centers - reach, balls.centers + reach  # (N, 3)
    # The box of each ball as first and last sample along each axis, shape (N,).
    first = [np.searchsorted(a, lower[:, i]) for i, a in enumerate(axes)]
    last = [np.searchsorted(a, upper[:, i], "right") for i, a in enumerate(axes)]
    for ball in range(len(balls)):
        box = [slice(f[ball], t[ball]) for f, t in zip(first, last, strict=True)]
        center, radius = balls.centers[ball], balls.radii[ball]
        qx, qy, qz = (
            ((axis[part] - c) / radius) ** 2
            for axis, part, c in zip(axes, box, center, strict=True)
        )
        q = qz[:, None, None] + qy[:, None] + qx
        total[box[2], box[1], box[0]] += balls.densities[ball] * profile_of(
            q, balls.kernel
        )
    return total
