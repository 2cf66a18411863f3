"""Ellipsoids as quadrics, and the cloud density that the paper maps into them.

Q is 1 at the centre, 0 on the surface and negative outside. The printed eq 10 has no
noise in it although the text maps the noise into the ellipsoid; the reading here
multiplies Q by the noise and keeps what reaches the threshold (E15).
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Positive, Range, Shape, Vector
from refcloud.refusal import complaint

# The inverse square of a radius must stay a finite number.
SMALLEST_RADIUS = 1e-150


@checked
def quadric(
    center: Vector,
    radii: Annotated[Array, Shape(3), Positive],
    *,
    turn: Annotated[float, Range(-math.tau, math.tau, "radians")] = 0.0,
    tilt: Annotated[float, Range(-math.tau, math.tau, "radians")] = 0.0,
    roll: Annotated[float, Range(-math.tau, math.tau, "radians")] = 0.0,
) -> Array:
    """Give the coefficients q0 ... q9 of an ellipsoid's size, place and rotation.

    Formula: Q(p) = 1 - |diag(1 / radii) M^T (p - center)|^2, M = Ry(turn) Rx(tilt)
    Rz(roll), expanded to q1 x^2 + q2 y^2 + q3 z^2 + q4 xy + q5 yz + q6 xz + q7 x +
    q8 y + q9 z + q0

    Parameters
    ----------
    center
        Shape (3,), scene units.
    radii
        Half axes before rotation, shape (3,), scene units, above 0.
    turn, tilt, roll
        Rotation about y, then x, then z of the turned frame, radians.

    Returns
    -------
    Shape (10,), q0 first.

    Raises
    ------
    ValueError
        A radius is so small that its inverse square is not finite, or the center so
        many radii away that a coefficient is not.

    Source: paper M, eq 8; E15.

    Examples
    --------
    >>> quadric([0, 0, 0], [1, 1, 2])[:4]
    array([ 1.  , -1.  , -1.  , -0.25])
    """
    if radii.min() < SMALLEST_RADIUS:
        raise ValueError(
            f"radii: expected at least {SMALLEST_RADIUS:g}, got {radii.min():g}"
        )
    frame = _rotation(turn, tilt, roll) / radii  # columns over the radii
    A = frame @ frame.T
    with np.errstate(over="ignore", invalid="ignore"):
        b = A @ center
        q = np.array(
            [
                1.0 - center @ b,
                *(-A[0, 0], -A[1, 1], -A[2, 2]),
                *(-2.0 * A[0, 1], -2.0 * A[1, 2], -2.0 * A[0, 2]),
                *(2.0 * b),
            ]
        )
    if not np.isfinite(q).all():
        expected = "a place whose square over that of the radii is a number"
        raise ValueError(complaint("center", expected, f"{np.abs(center).max():.4g}"))
    return q


def _rotation(turn: float, tilt: float, roll: float) -> Array:
    c, s = math.cos(turn), math.sin(turn)
    about_y = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    c, s = math.cos(tilt), math.sin(tilt)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
    c, s = math.cos(roll), math.sin(roll)
    about_z = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return about_y @ about_x @ about_z


@checked
def evaluate_quadric(
    q: Annotated[Array, Shape(10)], points: Annotated[Array, Shape("...", 3)]
) -> Array:
    """Evaluate a quadric at points.

    Formula: q1 x^2 + q2 y^2 + q3 z^2 + q4 xy + q5 yz + q6 xz + q7 x + q8 y + q9 z + q0

    Parameters
    ----------
    q
        Coefficients, shape (10,), q0 first.
    points
        Shape (..., 3), scene units.

    Returns
    -------
    Shape (...,): 1 at an ellipsoid's centre, 0 on its surface, negative outside.

    Raises
    ------
    ValueError
        A point is so far away that the value is not finite.

    Source: paper M, eq 8.

    Examples
    --------
    >>> evaluate_quadric(quadric([1, 0, 0], [2, 1, 1]), [[1.0, 0, 0], [3.0, 0, 0]])
    array([1., 0.])
    """
    x, y, z = np.moveaxis(points, -1, 0)
    with np.errstate(over="ignore", invalid="ignore"):
        Q = (
            x * (q[1] * x + q[4] * y + q[6] * z + q[7])
            + y * (q[2] * y + q[5] * z + q[8])
            + z * (q[3] * z + q[9])
            + q[0]
        )
    if not np.isfinite(Q).all():
        expected = "places at which the quadric's value is a number"
        raise ValueError(complaint("points", expected, "some farther away"))
    return Q


@checked
def modulate(
    Q: Annotated[Array, Shape("...")],
    noise: Annotated[Array, Shape("..."), Range(0.0)],
    *,
    threshold: Annotated[float, Range(0.0, 1.0, open_upper=True)] = 0.1,
    dynamics: Annotated[float, Range(0.0, 1.0, open_lower=True)] = 1.0,
) -> Array:
    """Map noise into ellipsoids: the density of the cloud.

    Formula: D = d Q P where 0 <= Q <= 1 and Q P >= t, else 0

    Parameters
    ----------
    Q
        Quadric's values, any shape; of several ellipsoids the largest.
    noise
        P, the sum of octaves of eq 1, the same shape, at least 0.
    threshold
        t, below which the cloud is empty, in [0, 1).
    dynamics
        d, the difference between the largest and smallest density, in (0, 1].

    Returns
    -------
    Density, the same shape, at least 0.

    Source: paper M, eq 9 and 10; E15.

    Examples
    --------
    >>> modulate([-0.5, 0.5, 1.0], [1.0, 0.1, 0.6], dynamics=0.5)
    array([0. , 0. , 0.3])
    """
    product = np.where((Q >= 0.0) & (Q <= 1.0), Q, 0.0) * noise
    return np.where(product >= threshold, dynamics * product, 0.0)
