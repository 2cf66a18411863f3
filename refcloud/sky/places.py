"""Where the rays of a picture meet a surface: one ray per pixel, found once.

A shader needs to know, for every pixel, which point of the surface it shows, where that
lies in the texture and how far it is. None of that changes while the eye stands still:
an animation hands the places of one frame to the next, and only looks its clouds up
anew. `places_by_triangles` finds the same by drawing the surface's mesh.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from refcloud.camera import AnyCamera, rays
from refcloud.checking import checked
from refcloud.conventions import Array, Skipped
from refcloud.sky.surfaces import (
    Dome,
    Plane,
    Surface,
    dome_coordinates,
    plane_coordinates,
    sphere_coordinates,
)


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
    skipped
        One row where the places were handed on from an earlier picture.
    """

    camera: AnyCamera
    surface: Surface
    seen: np.ndarray
    points: Array
    coordinates: Array
    distance: Array
    skipped: tuple[Skipped, ...] = ()


@checked
def places(
    camera: AnyCamera, surface: Surface, *, earlier: Places | None = None
) -> Places:
    """Find what every pixel of a picture sees of a surface.

    Formula: origin + t direction, the smallest t > 0 at which the surface is met

    Parameters
    ----------
    camera
        The eye, in or outside of a sphere.
    surface
        A plane, a sphere or a dome.
    earlier
        The places of an earlier picture: handed on where eye and surface are the same,
        and then reported in `skipped`.

    Returns
    -------
    The places.

    Source: document S, section 5.2 (F14 to F17).

    Examples
    --------
    >>> from refcloud.camera import Camera
    >>> up = Camera([0, 0, 0], [0, 1, 0], width=1, height=1)
    >>> places(up, Plane(height=3.0)).distance
    array([3.])
    """
    if earlier is not None and _same(earlier, camera, surface):
        return handed_on(earlier)
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


def _same(earlier: Places, camera: AnyCamera, surface: Surface) -> bool:
    """Tell whether eye and surface are those of an earlier picture."""
    pairs = ((earlier.camera, camera), (earlier.surface, surface))
    return all(
        type(a) is type(b)
        and all(
            np.array_equal(getattr(a, f.name), getattr(b, f.name)) for f in fields(a)
        )
        for a, b in pairs
    )
