"""The surfaces that a sky is drawn on, and how a picture is laid over each of them.

A plane at one height, a sphere, and a grid with its vertices on a half-sphere: where a
point of each lies in its texture. The sphere's picture is pinched at the
poles, where a whole row of texels is one point. The half-sphere's coordinates are angle
from the zenith and azimuth as polar coordinates of the plane: along a ray from the
zenith lengths are kept, across it they grow to pi / 2 at the rim, and only there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from refcloud.checking import check_fields, checked
from refcloud.conventions import Array, Positive, Range, Shape, Vector

Points = Annotated[Array, Shape("...", 3), Range()]
HALF_TURN, QUARTER_TURN = math.pi, 0.5 * math.pi


@dataclass(frozen=True)
class Plane:
    """A flat sky, or a flat ground.

    Attributes
    ----------
    height
        y of the plane, scene units.
    tile
        Length that a texture covers once, scene units.
    reach
        Where the plane ends on each side of x = z = 0, scene units.
    """

    height: Annotated[float, Range(-1e6, 1e6, "scene units")] = 1.0
    tile: Annotated[float, Positive] = 4.0
    reach: Annotated[float, Range(0.0, 1e9, "scene units", open_lower=True)] = 1e3

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class Sphere:
    """A whole sphere, around the eye or seen from outside.

    Attributes
    ----------
    center
        Its middle, shape (3,), scene units.
    radius
        Scene units.
    """

    center: Vector = field(default_factory=lambda: np.zeros(3))
    radius: Annotated[float, Range(1e-6, 1e9, "scene units")] = 10.0

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class Dome:
    """The upper half of a sphere, a square grid drawn onto it.

    Attributes
    ----------
    center
        Middle of its rim, shape (3,), scene units.
    radius
        Scene units.
    tiles
        How often a texture repeats from one side of the rim to the other.
    """

    center: Vector = field(default_factory=lambda: np.zeros(3))
    radius: Annotated[float, Range(1e-6, 1e9, "scene units")] = 10.0
    tiles: Annotated[float, Positive] = 2.0

    def __post_init__(self) -> None:
        check_fields(self)


Surface = Plane | Sphere | Dome


@checked
def plane_coordinates(points: Points, plane: Plane) -> Array:
    """Give where points of a plane lie in its texture.

    Formula: u = x / tile, v = z / tile

    Parameters
    ----------
    points
        On the plane, shape (..., 3), scene units.
    plane
        The plane.

    Returns
    -------
    u and v, shape (..., 2); a texture covers [0, 1] and repeats.

    Source: document S, section 5.2 (F17).

    Examples
    --------
    >>> plane_coordinates([2.0, 1.0, -4.0], Plane(tile=4.0))
    array([ 0.5, -1. ])
    """
    return points[..., [0, 2]] / plane.tile


@checked
def sphere_coordinates(points: Points, sphere: Sphere) -> Array:
    """Give where points of a sphere lie in a picture wrapped around it.

    Formula: u = 1/2 + atan2(x, -z) / (2 pi), v = 1/2 + asin(y / r) / pi

    Parameters
    ----------
    points
        On the sphere, shape (..., 3), scene units.
    sphere
        The sphere.

    Returns
    -------
    u and v, shape (..., 2), in [0, 1]: u is 1/2 toward -z, v is 0 at the lower pole and
    1 at the upper one.

    Source: document S, section 5.2 (F14).

    Examples
    --------
    >>> sphere_coordinates([[0, 0, -2], [2, 0, 0], [0, 2, 0]], Sphere(radius=2.0))
    array([[0.5 , 0.5 ],
           [0.75, 0.5 ],
           [0.5 , 1.  ]])
    """
    x, y, z = np.moveaxis(points - sphere.center, -1, 0)
    # The angle by both legs: near the poles the arc sine loses half of the digits.
    v = 0.5 + np.arctan2(y, np.hypot(x, z)) / HALF_TURN
    # No x and no z is a pole; it has one direction, not that of a signed zero.
    u = np.where((x == 0.0) & (z == 0.0), 0.0, np.arctan2(x, -z)) / (2.0 * HALF_TURN)
    return np.stack([0.5 + u, v], axis=-1)


@checked
def sphere_points(
    coordinates: Annotated[Array, Shape("...", 2)], sphere: Sphere
) -> Array:
    """Give the points of a sphere at places of a picture wrapped around it.

    Formula: the inverse of `sphere_coordinates`

    Parameters
    ----------
    coordinates
        u and v, shape (..., 2).
    sphere
        The sphere.

    Returns
    -------
    Points, shape (..., 3), scene units.

    Source: document S, section 5.2 (F14).

    Examples
    --------
    >>> sphere_points([0.5, 0.5], Sphere(radius=2.0)).round(9) + 0.0
    array([ 0.,  0., -2.])
    """
    around = 2.0 * HALF_TURN * (coordinates[..., 0] - 0.5)
    up = HALF_TURN * (coordinates[..., 1] - 0.5)
    level = np.cos(up)
    ways = [np.sin(around) * level, np.sin(up), -np.cos(around) * level]
    return sphere.center + sphere.radius * np.stack(ways, axis=-1)


@checked
def dome_coordinates(points: Points, dome: Dome) -> Array:
    """Give where points of a half-sphere lie in the grid's texture.

    Formula: (u, v) = tiles (1/2 + theta / pi (x, z) / hypot(x, z)), theta the angle
    from the zenith

    Parameters
    ----------
    points
        On the half-sphere, shape (..., 3), scene units.
    dome
        The half-sphere.

    Returns
    -------
    u and v, shape (..., 2), in [0, tiles].

    Source: document S, section 5.2 (F16).

    Examples
    --------
    >>> dome_coordinates([[0, 3, 0], [3, 0, 0]], Dome(radius=3.0, tiles=2.0))
    array([[1., 1.],
           [2., 1.]])
    """
    x, y, z = np.moveaxis(points - dome.center, -1, 0)
    level = np.hypot(x, z)
    # theta / level tends to 1 / r at the zenith, where level is 0.
    turned = np.divide(
        np.arctan2(level, y), level, out=np.zeros_like(level), where=level > 0.0
    )
    flat = np.stack([x * turned, z * turned], axis=-1) / HALF_TURN
    return dome.tiles * (0.5 + flat)


@checked
def dome_points(coordinates: Annotated[Array, Shape("...", 2)], dome: Dome) -> Array:
    """Put places of a square grid onto a half-sphere.

    Formula: theta = pi max(|a|, |b|), in the direction of (a, b), for a = u / tiles -
    1/2 and b = v / tiles - 1/2: squares around the middle become circles

    Parameters
    ----------
    coordinates
        u and v of the square grid, shape (..., 2), in [0, tiles].
    dome
        The half-sphere.

    Returns
    -------
    Points, shape (..., 3), scene units; the square's border is the rim. Where they lie
    in the texture `dome_coordinates` says: (u, v) itself along the axes.

    Source: document S, section 5.2 (F16).

    Examples
    --------
    >>> dome_points([[1.0, 1.0], [2.0, 2.0]], Dome(radius=1.0)).round(3) + 0.0
    array([[0.   , 1.   , 0.   ],
           [0.707, 0.   , 0.707]])
    """
    a, b = np.moveaxis(coordinates / dome.tiles - 0.5, -1, 0)
    theta = np.minimum(HALF_TURN * np.maximum(np.abs(a), np.abs(b)), QUARTER_TURN)
    length = np.hypot(a, b)
    sine = np.sin(theta)
    along = np.divide(sine, length, out=np.zeros_like(length), where=length > 0.0)
    ways = np.stack([a * along, np.cos(theta), b * along], axis=-1)
    return dome.center + dome.radius * ways
