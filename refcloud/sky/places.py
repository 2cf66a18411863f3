"""Where the rays of a picture meet a surface: one ray per pixel, found once.

A shader needs to know, for every pixel, which point of the surface it shows, where that
lies in the texture and how far it is. None of that changes while the eye stands still:
an animation hands the places of one frame to the next, and only looks its clouds up
anew. Drawing the surface's mesh by triangles finds the same, but for its facets: what
OpenGL does, where the attributes of three corners are interpolated to each pixel.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Annotated, Literal

import numpy as np

from refcloud.camera import AnyCamera, Camera, rays
from refcloud.checking import checked
from refcloud.conventions import Array, Range, Skipped
from refcloud.raster import Fragments, State, draw_triangles, framebuffer
from refcloud.sky.meshes import surface_mesh
from refcloud.sky.surfaces import (
    Dome,
    Plane,
    Surface,
    dome_coordinates,
    plane_coordinates,
    sphere_coordinates,
)

Way = Literal["rays", "triangles"]
FARTHEST = 1e9  # scene units: how far triangles of parallel rays count


@dataclass(frozen=True, eq=False)
class Places:
    """What a picture sees of a surface, for the pixels that see it at all.

    Attributes
    ----------
    camera, surface
        Whose places they are.
    seen
        Shape (H, W), booleans: which pixels show the surface. The other arrays hold
        those pixels alone, row by row.
    points
        Shape (N, 3), scene units.
    coordinates
        u and v in the surface's texture, shape (N, 2).
    distance
        From the eye, shape (N,), scene units.
    way, fineness
        How they were found.
    skipped
        One row where the places were handed on from an earlier picture.
    """

    camera: AnyCamera
    surface: Surface
    seen: np.ndarray
    points: Array
    coordinates: Array
    distance: Array
    way: Way = "rays"
    fineness: int = 0
    skipped: tuple[Skipped, ...] = ()


@checked
def places(
    camera: AnyCamera,
    surface: Surface,
    *,
    way: Way = "rays",
    fineness: Annotated[int, Range(3, 2000, "cells")] = 64,
    earlier: Places | None = None,
) -> Places:
    """Find what every pixel of a picture sees of a surface.

    Formula: origin + t direction, the smallest t > 0 at which the surface is met; or
    the corners' own points and coordinates, interpolated over each triangle

    Parameters
    ----------
    camera
        The eye, in or outside of a sphere.
    surface
        A plane, a sphere or a dome.
    way
        A ray for each pixel, or triangles.
    fineness
        Cells along each side of the mesh that is drawn as triangles.
    earlier
        The places of an earlier picture: handed on where eye, surface and way are the
        same, and then reported in `skipped`.

    Returns
    -------
    The places.

    Source: document S, section 5.2 (F10, F14 to F17).

    Examples
    --------
    >>> from refcloud.camera import Camera
    >>> up = Camera([0, 0, 0], [0, 1, 0], width=1, height=1)
    >>> places(up, Plane(height=3.0)).distance
    array([3.])
    """
    if earlier is not None and _same(earlier, camera, surface, way, fineness):
        return handed_on(earlier)
    if way == "triangles":
        return _drawn(camera, surface, fineness)
    origins, directions = rays(camera)
    t = distance_to(surface, origins.reshape(-1, 3), directions.reshape(-1, 3))
    seen = np.isfinite(t)
    # A long row of products, not of pixels that wait for their neighbours.
    far = t[seen]
    at = origins.reshape(-1, 3)[seen] + far[:, None] * directions.reshape(-1, 3)[seen]
    shape = camera.height, camera.width
    found = coordinates_on(surface, at)
    return Places(camera, surface, seen.reshape(shape), at, found, far)


def handed_on(earlier: Places) -> Places:
    """Give an earlier picture's places, with a row that says so."""
    count = earlier.seen.size
    row = Skipped("sky", "pixels' rays and coordinates, known already,", count, count)
    held = {f.name: getattr(earlier, f.name) for f in fields(earlier)}
    return Places(**{**held, "skipped": (row,)})


def distance_to(surface: Surface, origins: Array, directions: Array) -> Array:
    """Give how far rays go until they meet a surface, infinity where they never do.

    Parameters
    ----------
    surface
        A plane, a sphere or a dome.
    origins, directions
        Shape (N, 3); directions are unit vectors.

    Returns
    -------
    Shape (N,), above 0.
    """
    if isinstance(surface, Plane):
        rise, climb = surface.height - origins[:, 1], directions[:, 1]
        t = np.divide(rise, climb, out=np.full_like(rise, np.inf), where=climb != 0.0)
        t[t <= 0.0] = np.inf
        with np.errstate(invalid="ignore", over="ignore"):
            across = origins[:, [0, 2]] + t[:, None] * directions[:, [0, 2]]
            near = (np.abs(across) <= surface.reach).all(axis=1)
        return np.where(near, t, np.inf)
    offset = origins - surface.center
    b = np.einsum("ij,ij->i", offset, directions)
    # |offset|^2 - b^2 by the part across the ray: it does not cancel far away.
    across = offset - b[:, None] * directions
    half = surface.radius**2 - np.einsum("ij,ij->i", across, across)
    hit = half >= 0.0
    root = np.sqrt(np.where(hit, half, 0.0))
    found = np.full(len(b), np.inf)
    for t in (-b + root, -b - root):  # the nearer one last
        counts = hit & (t > 0.0)
        if isinstance(surface, Dome):
            counts &= offset[:, 1] + t * directions[:, 1] >= 0.0
        found[counts] = t[counts]
    return found


def coordinates_on(surface: Surface, points: Array) -> Array:
    """Give where points of a surface lie in its texture, shape (..., 2)."""
    if isinstance(surface, Plane):
        return plane_coordinates(points, surface)
    if isinstance(surface, Dome):
        return dome_coordinates(points, surface)
    return sphere_coordinates(points, surface)


def _drawn(camera: AnyCamera, surface: Surface, fineness: int) -> Places:
    """Find places by drawing the surface's mesh: a shader that writes them down."""
    height, width = camera.height, camera.width
    held = np.zeros((height, width, 5))  # u, v, x, y, z
    seen = np.zeros((height, width), bool)

    def write(fragments: Fragments) -> Array:
        at = fragments.row, fragments.column
        held[at] = fragments.values.T
        seen[at] = True
        return np.ones((len(fragments.row), 4))

    buffer = framebuffer(width, height, depth=1.0)
    far = None if isinstance(camera, Camera) else FARTHEST
    mesh = surface_mesh(surface, fineness)
    draw_triangles(buffer, camera, mesh, write, state=State(depth_func="LESS"), far=far)
    found = held[seen]
    points = found[:, 2:]
    start = np.broadcast_to(rays(camera)[0], (height, width, 3))[seen]
    distance = np.sqrt(np.square(points - start).sum(axis=1))
    uv = found[:, :2]
    return Places(camera, surface, seen, points, uv, distance, "triangles", fineness)


def _same(
    earlier: Places, camera: AnyCamera, surface: Surface, way: Way, fineness: int
) -> bool:
    """Tell whether eye and surface are those of an earlier picture."""
    if way != earlier.way or (way == "triangles" and fineness != earlier.fineness):
        return False
    pairs = ((earlier.camera, camera), (earlier.surface, surface))
    return all(
        type(a) is type(b)
        and all(
            np.array_equal(getattr(a, f.name), getattr(b, f.name)) for f in fields(a)
        )
        for a, b in pairs
    )
