"""Meshes: corners that triangles share, and the shapes that skies are drawn on.

Triangles are counterclockwise as seen from outside a sphere, from above a plane; under
a dome one looks at their backs. The first two attributes of every shape made here are
texture coordinates s and t in [0, 1].
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import check, checked, complaint
from refcloud.conventions import Array, Positive, Range, Shape

Indices = NDArray[np.int64]
MOST_TRIANGLES = 16_000_000  # 3 GB while they are drawn
WORLD = Range(-1e100, 1e100, "scene units")  # squares of such places are numbers
Count = Annotated[int, Range(3, 4000)]
Rings = Annotated[int, Range(1, 4000)]
Radius = Annotated[float, Positive]


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles over a list of corners.

    Attributes
    ----------
    points
        Where the corners are, shape (V, 3), scene units.
    faces
        Indices of the corners of each triangle, shape (T, 3), whole numbers.
    attributes
        K numbers that each corner carries and a triangle interpolates, shape (V, K):
        texture coordinates, a normal, a place, whatever `shade` wants; K may be 0.
    """

    points: Annotated[Array, Shape("V", 3), WORLD]
    faces: Indices
    attributes: Annotated[Array, Shape("V", "K"), WORLD] = field(
        default_factory=lambda: np.zeros((0, 0))
    )

    def __post_init__(self) -> None:
        points = check("points", self.points, Annotated[Array, Shape("V", 3), WORLD])
        count, given = len(points), np.asarray(self.attributes)
        given = np.zeros((count, 0)) if given.shape == (0, 0) else given
        kind = Annotated[Array, Shape(count, "K"), WORLD]
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "attributes", check("attributes", given, kind))
        object.__setattr__(self, "faces", _checked_faces(self.faces, count))


def separate(triangles: Array) -> Mesh:
    """Give triangles that share no corners, shape (T, 3, 3), as a mesh."""
    count = 3 * len(triangles)
    return Mesh(triangles.reshape(-1, 3), np.arange(count).reshape(-1, 3))


def _checked_faces(faces: object, count: int) -> Indices:
    """Refuse faces that are not triples of corners, or far too many."""
    array = np.asarray(faces)
    if array.size == 0:
        array = np.zeros((0, 3), np.int64)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iu":
        got = f"an array of {array.dtype} with shape {array.shape}"
        raise ValueError(complaint("faces", "whole numbers of shape (T, 3)", got))
    if len(array) > MOST_TRIANGLES:
        expected = f"at most {MOST_TRIANGLES} triangles"
        raise ValueError(complaint("faces", expected, f"{len(array)}"))
    if array.size and not (array.min() >= 0 and array.max() < count):
        expected = f"indices of corners, 0 to {count - 1}"
        raise ValueError(
            complaint("faces", expected, f"{array.min()} to {array.max()}")
        )
    array = array.astype(np.int64)
    array.flags.writeable = False
    return array


@checked
def sphere_mesh(columns: Count = 64, rows: Rings = 32, *, radius: Radius = 1.0) -> Mesh:
    """Make a sphere of longitudes and latitudes about the origin.

    Formula: (r sin theta sin phi, r cos theta, r sin theta cos phi), s = phi / 2 pi,
    t = 1 - theta / pi

    Parameters
    ----------
    columns
        Steps around; a column of corners is doubled where s = 1 meets s = 0.
    rows
        Steps from pole to pole; at the poles each step has its own corner, whose s
        is that of the middle of the step.
    radius
        Of the sphere, scene units.

    Returns
    -------
    2 columns (rows - 1) triangles; +y is up.

    Source: paper S, sky sphere (F14, F15); OpenGL's orientation of triangles.

    Examples
    --------
    >>> ball = sphere_mesh(8, 4)
    >>> len(ball.faces), len(ball.points)
    (48, 45)
    """
    if rows < 2:
        raise ValueError(complaint("rows", "at least 2 from pole to pole", f"{rows}"))
    return _turned(columns, rows, math.pi, radius)


@checked
def dome_mesh(columns: Count = 64, rows: Rings = 16, *, radius: Radius = 1.0) -> Mesh:
    """Make the upper half of a sphere, with the texture laid flat over it.

    Formula: (r sin theta sin phi, r cos theta, r sin theta cos phi), (s, t) =
    1/2 + theta / pi (sin phi, -cos phi)

    Parameters
    ----------
    columns
        Steps around.
    rows
        Steps from the zenith to the horizon.
    radius
        Of the sphere, scene units.

    Returns
    -------
    columns (2 rows - 1) triangles. The texture's middle is at the zenith and its
    inscribed circle the horizon: only there is it stretched, by pi / 2 around.

    Source: paper S, half-sphere grid (F16).

    Examples
    --------
    >>> sky = dome_mesh(8, 4)
    >>> len(sky.faces), sky.points[0], sky.attributes[0]
    (56, array([0., 1., 0.]), array([0.5, 0.5]))
    """
    mesh = _turned(columns, rows, 0.5 * math.pi, radius)
    phi = 2.0 * math.pi * mesh.attributes[:, 0]
    theta = math.pi * (1.0 - mesh.attributes[:, 1])
    around = np.stack([np.sin(phi), -np.cos(phi)], axis=-1)
    flat = 0.5 + (theta / math.pi)[:, None] * around
    return Mesh(mesh.points, mesh.faces, flat)


def _turned(columns: int, rows: int, deepest: float, radius: float) -> Mesh:
    """Make the part of a sphere from the upper pole down to an angle."""
    j, i = np.mgrid[0 : rows + 1, 0 : columns + 1].astype(np.float64)
    whole = deepest == math.pi
    middle = np.minimum(i[0] + 0.5, columns - 0.5)  # of each step around a pole
    i[0] = middle
    if whole:
        i[-1] = middle
    theta = deepest * j / rows
    # Exactly the same places where the sphere closes, and at its poles and horizon.
    turn = 2.0 * math.pi * (i % columns) / columns
    sine = np.where((j == 0) | ((j == rows) & whole), 0.0, np.sin(theta))
    height = np.where((j == rows) & (not whole), 0.0, np.cos(theta))
    points = radius * np.stack(
        [sine * np.sin(turn), height, sine * np.cos(turn)], axis=-1
    )
    coords = np.stack([i / columns, 1.0 - theta / math.pi], axis=-1)
    faces = np.stack(_cells(rows + 1, columns + 1), axis=1)
    faces = faces.reshape(rows, columns, 2, 3)
    kept = np.ones((rows, columns, 2), bool)
    kept[0, :, 0] = False  # at a pole one of a cell's two triangles has no area
    kept[-1, :, 1] = not whole
    return Mesh(points.reshape(-1, 3), faces[kept], coords.reshape(-1, 2))


@checked
def plane_mesh(
    columns: Rings = 16,
    rows: Rings = 16,
    *,
    width: Radius = 2.0,
    depth: Radius = 2.0,
    height: Annotated[float, WORLD] = 0.0,
) -> Mesh:
    """Make a level rectangle of cells about the y axis.

    Formula: (width (s - 1/2), height, depth (1/2 - t)), s = i / columns, t = j / rows

    Parameters
    ----------
    columns, rows
        Cells along x and along z.
    width, depth
        Extent along x and along z, scene units.
    height
        Its y, scene units.

    Returns
    -------
    2 columns rows triangles, whose fronts look up; t runs toward -z.

    Source: paper S, flat sky plane (F17).

    Examples
    --------
    >>> plane_mesh(1, 1).points[0], plane_mesh(1, 1).attributes[-1]
    (array([-1.,  0.,  1.]), array([1., 1.]))
    """
    j, i = np.mgrid[0 : rows + 1, 0 : columns + 1].astype(np.float64)
    s, t = i / columns, j / rows
    level = np.full_like(s, height)
    points = np.stack([width * (s - 0.5), level, depth * (0.5 - t)], axis=-1)
    coords = np.stack([s, t], axis=-1)
    upper, lower = (f[:, ::-1] for f in _cells(rows + 1, columns + 1))
    faces = np.concatenate([upper, lower], axis=1).reshape(-1, 3)
    return Mesh(points.reshape(-1, 3), faces, coords.reshape(-1, 2))


def _cells(rows: int, columns: int) -> tuple[Indices, Indices]:
    """Give two triangles for each cell of a grid of corners, row by row."""
    corner = np.arange(rows * columns).reshape(rows, columns)
    a, b = corner[:-1, :-1].ravel(), corner[:-1, 1:].ravel()
    c, d = corner[1:, :-1].ravel(), corner[1:, 1:].ravel()
    return np.stack([a, c, b], axis=-1), np.stack([b, c, d], axis=-1)
