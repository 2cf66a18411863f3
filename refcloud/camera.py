"""Pinhole and orthographic cameras: projection, depth keys and rays.

A camera looks along -z of its own frame. Pixel (column i, row j) has its centre at
(i + 1/2, j + 1/2); row 0 is the top. Depth is measured along the view axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from refcloud.checking import check_fields, checked, complaint
from refcloud.conventions import (
    MOST_PIXELS,
    Array,
    Positive,
    Range,
    Shape,
    Vector,
    unit_vector,
)

__all__ = ["Camera", "OrthographicCamera", "axes", "frame", "project", "rays"]

NARROWEST = 1e-9  # radians: below it neighbouring pixels share one direction
FARTHEST = 1e150  # pixels and units; a product of two of them is still a number
Side = Annotated[int, Range(1, MOST_PIXELS, "pixels")]
Angle = Annotated[float, Range(NARROWEST, math.pi, "radians", open_upper=True)]
WORLD_UP = (0.0, 1.0, 0.0)
FOV_Y = 0.533  # 40 degrees across a 4:3 picture
FROM_BELOW = (0.0, -0.28, 1.0)  # where `frame` stands, seen from the box
NEAREST = 1e-6  # of a place's coordinates: what float64 still tells apart from it
PARALLEL = 1e-12  # squared sine below which `up` gives no direction


def refuse_large(width: int, height: int) -> None:
    """Refuse a picture of over 8.3 megapixels, before anything is made for it."""
    if width * height > MOST_PIXELS:
        expected = f"at most {MOST_PIXELS / 1e6:g} megapixels with the height"
        got, advice = f"{width} x {height}", "make the picture smaller"
        raise ValueError(complaint("width", expected, got, advice))


def _check_view(camera: Camera | OrthographicCamera) -> None:
    check_fields(camera)
    refuse_large(camera.width, camera.height)
    with np.errstate(over="ignore"):  # what is too far is refused below
        gap = camera.target - camera.eye
    if not np.isfinite(gap).all() or not gap.any():
        raise ValueError(
            "target: expected another place than the eye, got the same or one too far"
        )
    unit_vector(camera.up, "up")


@dataclass(frozen=True)
class Camera:
    """A pinhole camera.

    Attributes
    ----------
    eye, target
        Where it stands and what it looks at, shape (3,), scene units.
    up
        What is upward in the picture, shape (3,); along the view another axis serves.
    fov_y
        Vertical field of view, radians, in [1e-9, pi).
    width, height
        Size of the picture, pixels; at most 8.3 megapixels together.
    """

    eye: Vector
    target: Vector
    up: Vector = field(default_factory=lambda: np.array(WORLD_UP))
    fov_y: Angle = FOV_Y
    width: Side = 1024
    height: Side = 768

    def __post_init__(self) -> None:
        _check_view(self)


@dataclass(frozen=True)
class OrthographicCamera:
    """A camera whose rays are parallel.

    Attributes
    ----------
    eye, target
        A place on the view axis and another in front of it, shape (3,), scene units.
    up
        What is upward in the picture, shape (3,).
    height_of_view
        Height of what the picture shows, scene units, above 0.
    width, height
        Size of the picture, pixels; at most 8.3 megapixels together.
    """

    eye: Vector
    target: Vector
    up: Vector = field(default_factory=lambda: np.array(WORLD_UP))
    height_of_view: Annotated[float, Positive] = 2.0
    width: Side = 1024
    height: Side = 768

    def __post_init__(self) -> None:
        _check_view(self)


AnyCamera = Camera | OrthographicCamera


@checked
def axes(camera: AnyCamera) -> Array:
    """Give the camera's frame.

    Formula: back = eye - target, right = up x back, up = back x right, all of length 1

    Parameters
    ----------
    camera
        Pinhole or orthographic.

    Returns
    -------
    Shape (3, 3); the rows are right, up and back, unit vectors.

    Source: the look-at frame of OpenGL; E28: `up` gives way only along the view.

    Examples
    --------
    >>> axes(Camera([0, 0, 5], [0, 0, 0]))
    array([[1., 0., 0.],
           [0., 1., 0.],
           [0., 0., 1.]])
    """
    back = unit_vector(camera.eye - camera.target)
    right = _cross(unit_vector(camera.up), back)
    if right @ right < PARALLEL:
        # Looking along `up`: the world axis that the view is farthest from serves.
        right = _cross(np.eye(3)[np.argmin(np.abs(back))], back)
    right = unit_vector(right)
    return np.array([right, _cross(back, right), back])


def _cross(a: Array, b: Array) -> Array:
    """Give the cross product of two vectors."""
    (x, y, z), (u, v, w) = a.tolist(), b.tolist()
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u])


@checked
def project(
    camera: AnyCamera, points: Annotated[Array, Shape("N", 3)]
) -> tuple[Array, Array, Array, Array]:
    """Find where points show in the picture, how deep, and at what scale.

    Formula: x = W/2 + s p.right, y = H/2 - s p.up, with p from the eye, and
    s = H / (2 tan(fov_y / 2) depth), or H / height_of_view

    Parameters
    ----------
    camera
        Pinhole or orthographic.
    points
        Shape (N, 3), scene units.

    Returns
    -------
    x, y of shape (N,), pixels; depth of shape (N,), scene units along the view;
    scale of shape (N,), pixels per scene unit, 0 where a pinhole's point is not in
    front of the eye (x and y are then the picture's middle).

    Source: OpenGL's perspective and viewport transforms.

    Examples
    --------
    >>> camera = Camera([0, 0, 4], [0, 0, 0], fov_y=np.pi / 2, width=8, height=8)
    >>> [round(float(v[0]), 9) for v in project(camera, [[1.0, 0.0, 0.0]])]
    [5.0, 4.0, 4.0, 1.0]
    """
    # Without a matrix product: the same bits wherever a point stands in the list.
    ahead = np.ascontiguousarray((points - camera.eye).T)  # by axis
    right, up, back = (
        axis[0] * ahead[0] + axis[1] * ahead[1] + axis[2] * ahead[2]
        for axis in axes(camera)
    )
    depth = -back
    if isinstance(camera, Camera):
        focal = 0.5 * camera.height / math.tan(0.5 * camera.fov_y)
        # A point so near that its pixels overflow is no different from one at the eye.
        aside = np.maximum(np.abs(right), np.abs(up))
        in_front = depth > np.maximum(aside / FARTHEST, 1.0) * (focal / FARTHEST)
        scale = np.divide(focal, depth, out=np.zeros_like(depth), where=in_front)
    else:
        scale = np.full(len(depth), camera.height / camera.height_of_view)
    x = 0.5 * camera.width + scale * right
    y = 0.5 * camera.height - scale * up
    return x, y, depth, scale


@checked
def rays(camera: AnyCamera) -> tuple[Array, Array]:
    """Give the ray through every pixel's centre.

    Formula: the inverse of `project`

    Parameters
    ----------
    camera
        Pinhole or orthographic.

    Returns
    -------
    Origins and unit directions, each of shape (H, W, 3).

    Source: OpenGL's viewport transform, inverted.

    Examples
    --------
    >>> origins, directions = rays(Camera([0, 0, 4], [0, 0, 0], width=1, height=1))
    >>> directions[0, 0] + 0.0
    array([ 0.,  0., -1.])
    """
    right, up, back = axes(camera)
    i = np.arange(camera.width) + 0.5 - 0.5 * camera.width
    j = 0.5 * camera.height - (np.arange(camera.height) + 0.5)
    if isinstance(camera, Camera):
        pixel = 2.0 * math.tan(0.5 * camera.fov_y) / camera.height
        directions = (
            i[None, :, None] * pixel * right + j[:, None, None] * pixel * up - back
        )
        directions /= np.sqrt(np.square(directions).sum(axis=-1, keepdims=True))
        return np.broadcast_to(camera.eye, directions.shape), directions
    pixel = camera.height_of_view / camera.height
    origins = (
        camera.eye + i[None, :, None] * pixel * right + j[:, None, None] * pixel * up
    )
    return origins, np.broadcast_to(-back, origins.shape)


@checked
def frame(
    lower: Vector,
    upper: Vector,
    *,
    width: Side = 1024,
    height: Side = 768,
    margin: Annotated[float, Range(1.0, 100.0)] = 1.3,
) -> Camera:
    """Set up a camera that shows a box from the front, a little from below.

    Formula: the nearest eye from which every corner, seen margin times as far from
    the middle of the picture as it is, still shows

    Parameters
    ----------
    lower, upper
        Corners of the box, shape (3,), scene units.
    width, height
        Size of the picture, pixels.
    margin
        Room around the box, as a factor, at least 1.

    Returns
    -------
    The camera.

    Source: the look-at and perspective transforms of OpenGL.

    Examples
    --------
    >>> frame([-1, -1, -1], [1, 1, 1]).target
    array([0., 0., 0.])
    """
    target = 0.5 * lower + 0.5 * upper
    half = 0.5 * upper - 0.5 * lower
    toward = unit_vector(np.array(FROM_BELOW))
    right, up, back = axes(Camera(toward, np.zeros(3)))
    signs = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    corners = signs * half
    aside = np.abs(corners @ right) * (height / width)
    needs = np.maximum(aside, np.abs(corners @ up)) * margin
    distance = float((corners @ back + needs / math.tan(0.5 * FOV_Y)).max())
    # A box of hardly any size: the eye must not round onto it.
    distance = max(distance, NEAREST * float(np.abs(target).max()), 1.0 / FARTHEST)
    return Camera(target + distance * toward, target, width=width, height=height)
