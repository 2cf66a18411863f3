"""The meshes of skies' surfaces: what triangles interpolate over them.

Each corner carries u and v in the surface's texture, and its place. A half-sphere is a
square grid whose corners were moved onto it, as the document has it.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Range
from refcloud.raster import Mesh, plane_mesh, sphere_mesh
from refcloud.sky.surfaces import (
    Dome,
    Plane,
    Surface,
    dome_coordinates,
    dome_points,
    plane_coordinates,
)


@checked
def surface_mesh(
    surface: Surface, fineness: Annotated[int, Range(3, 2000, "cells")] = 64
) -> Mesh:
    """Give a surface as triangles, with u, v and the place as attributes.

    Formula: corners on the surface, of `plane_mesh`, `sphere_mesh` and `dome_points`

    Parameters
    ----------
    surface
        A plane, a sphere or a dome.
    fineness
        Cells along each side; a sphere has twice as many around.

    Returns
    -------
    The mesh; attributes of shape (V, 5): u, v, x, y, z.

    Source: document S, section 5.2 (F14 to F17).

    Examples
    --------
    >>> surface_mesh(Dome(), 4).attributes.shape
    (25, 5)
    """
    if isinstance(surface, Plane):
        side = 2.0 * surface.reach
        flat = plane_mesh(
            fineness, fineness, width=side, depth=side, height=surface.height
        )
        points, faces = flat.points, flat.faces
        uv = plane_coordinates(points, surface)
    elif isinstance(surface, Dome):
        square = plane_mesh(fineness, fineness)
        points = dome_points(surface.tiles * square.attributes, surface)
        faces = square.faces
        uv = dome_coordinates(points, surface)
    else:
        ball = sphere_mesh(2 * fineness, fineness, radius=surface.radius)
        points, faces = ball.points + surface.center, ball.faces
        # Not from the places: where its two sides meet, corners are there twice.
        uv = np.array([1.0, 0.0]) + ball.attributes * np.array([-1.0, 1.0])
    return Mesh(points, faces, np.concatenate([uv, points], axis=1))
