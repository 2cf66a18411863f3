"""Meshes, one corner at a time.

Each function is the twin of the one of the same name in `refcloud.raster`.
"""

from __future__ import annotations

import math

from refcloud.plain.camera import Point
from refcloud.plain.triangles import Mesh


def sphere_corner(
    i: int, j: int, columns: int, rows: int, reach: float, radius: float
) -> tuple[Point, float, float]:
    """Give the place of one corner of a sphere's part, phi / 2 pi and theta / pi."""
    theta, turn = reach * j / rows, 2.0 * math.pi * (i % columns) / columns
    pole = j == 0 or (j == rows and reach == math.pi)
    across = 0.0 if pole else radius * math.sin(theta)
    level = 0.0 if (j == rows and reach < math.pi) else radius * math.cos(theta)
    s = min(i + 0.5, columns - 0.5) / columns if pole else i / columns
    return (across * math.sin(turn), level, across * math.cos(turn)), s, theta / math.pi


def grid_faces(
    rows: int, columns: int, poles: tuple[bool, bool]
) -> list[tuple[int, int, int]]:
    """List two triangles for each cell, one where the cell ends in a pole."""
    faces, wide = [], columns + 1
    for j in range(rows):
        for i in range(columns):
            a, c = j * wide + i, (j + 1) * wide + i
            if not (poles[0] and j == 0):
                faces.append((a, c, a + 1))
            if not (poles[1] and j == rows - 1):
                faces.append((a + 1, c, c + 1))
    return faces


def sphere_mesh(columns: int, rows: int, radius: float) -> Mesh:
    """Make a sphere of longitudes and latitudes."""
    grid = [(i, j) for j in range(rows + 1) for i in range(columns + 1)]
    corners = [sphere_corner(i, j, columns, rows, math.pi, radius) for i, j in grid]
    coords = [(s, 1.0 - t) for _, s, t in corners]
    faces = grid_faces(rows, columns, (True, True))
    return Mesh([place for place, _, _ in corners], faces, coords)


def dome_mesh(columns: int, rows: int, radius: float) -> Mesh:
    """Make the upper half of a sphere, with the texture laid flat over it."""
    half, grid = (
        0.5 * math.pi,
        [(i, j) for j in range(rows + 1) for i in range(columns + 1)],
    )
    corners = [sphere_corner(i, j, columns, rows, half, radius) for i, j in grid]
    coords = [
        (0.5 + t * math.sin(2.0 * math.pi * s), 0.5 - t * math.cos(2.0 * math.pi * s))
        for _, s, t in corners
    ]
    faces = grid_faces(rows, columns, (True, False))
    return Mesh([place for place, _, _ in corners], faces, coords)


def plane_mesh(
    columns: int, rows: int, width: float, depth: float, height: float
) -> Mesh:
    """Make a level rectangle of cells."""
    grid = [(i, j) for j in range(rows + 1) for i in range(columns + 1)]
    coords = [(i / columns, j / rows) for i, j in grid]
    points = [(width * (s - 0.5), height, depth * (0.5 - t)) for s, t in coords]
    faces = [(c, b, a) for a, b, c in grid_faces(rows, columns, (False, False))]
    return Mesh(points, faces, coords)
