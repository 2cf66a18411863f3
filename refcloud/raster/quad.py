"""The quad that document D draws its cloud on: rays from the eye through its points.

A rectangle across the view, as large as what the camera sees of it. Its corners are
interpolated to every pixel, as OpenGL interpolates an attribute, and a ray from the eye
through a pixel's point is the camera's own ray: the quad is only a way to have the
fragment shader run once for each pixel. Where it stands does not matter.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from refcloud.camera import Camera, OrthographicCamera, axes
from refcloud.checking import checked
from refcloud.conventions import Array, Range

Distance = Annotated[float, Range(1e-100, 1e100, "scene units")]


@checked
def quad_corners(camera: Camera | OrthographicCamera, distance: Distance) -> Array:
    """Give the corners of the rectangle across the view that fills the picture.

    Formula: eye - distance back -+ w right -+ h up, h = distance tan(fov_y / 2) or
    height_of_view / 2, w = h width / height

    Parameters
    ----------
    camera
        Pinhole or orthographic.
    distance
        From the eye along the view, scene units.

    Returns
    -------
    Lower left, lower right, upper left and upper right, shape (4, 3), scene units.

    Source: document D, Generating Cloud Textures (R02: "a quad implementation").

    Examples
    --------
    >>> view = OrthographicCamera([0, 0, 1], [0, 0, 0], width=4, height=2)
    >>> quad_corners(view, 1.0)[0]
    array([-2., -1.,  0.])
    """
    right, up, back = axes(camera)
    if isinstance(camera, Camera):
        half = distance * math.tan(0.5 * camera.fov_y)
    else:
        half = 0.5 * camera.height_of_view
    wide = half * camera.width / camera.height
    middle = camera.eye - distance * back
    return np.array(
        [middle + x * wide * right + y * half * up for y in (-1, 1) for x in (-1, 1)]
    )


@checked
def quad_points(camera: Camera | OrthographicCamera, distance: Distance) -> Array:
    """Interpolate the quad's corners to the centre of every pixel.

    Formula: bilinear in s = (i + 1/2) / W and t = 1 - (j + 1/2) / H

    Parameters
    ----------
    camera
        Pinhole or orthographic.
    distance
        From the eye along the view, scene units.

    Returns
    -------
    Places on the quad, shape (H, W, 3), scene units, row 0 at the top.

    Source: document D, Ray and Box intersection (R02).

    Examples
    --------
    >>> view = OrthographicCamera([0, 0, 1], [0, 0, 0], width=2, height=2)
    >>> quad_points(view, 1.0)[0, 0]
    array([-0.5,  0.5,  0. ])
    """
    lower_left, lower_right, upper_left, upper_right = quad_corners(camera, distance)
    s = ((np.arange(camera.width) + 0.5) / camera.width)[:, None]
    t = (1.0 - (np.arange(camera.height) + 0.5) / camera.height)[:, None, None]
    below = lower_left + s * (lower_right - lower_left)
    above = upper_left + s * (upper_right - upper_left)
    return below + t * (above - below)
