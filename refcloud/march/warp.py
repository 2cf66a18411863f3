"""From the image on a regular grid of q to the pixels of a camera."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import AnyCamera, Camera, axes
from refcloud.conventions import Array
from refcloud.march.light import phase_along
from refcloud.march.resample import Image
from refcloud.march.view import View
from refcloud.optics import Medium, Sun

FARTHEST = 1e6  # beyond any image
# Lengths in a box, in slices, and their ratio, beyond which nothing is corrected; and
# the most that a pixel hides for its optical depth to be told in single precision.
LEAST, MOST, OPAQUE = 1e-2, 4.0, 1.0 - 1e-6
ENLARGED = 3  # bilinear between samples a third as far apart errs a ninth as much


def enlarging(count: int) -> Image:
    """Write Catmull-Rom weights of samples ENLARGED times as dense, (3 n - 2, n)."""
    at = np.arange(ENLARGED * (count - 1) + 1) / ENLARGED
    distance = np.abs(at[:, None] - np.arange(count))
    near = (1.5 * distance - 2.5) * distance**2 + 1.0
    far = ((2.5 - 0.5 * distance) * distance - 4.0) * distance + 2.0
    weights = np.where(distance < 1.0, near, np.where(distance < 2.0, far, 0.0))
    return weights.astype(np.float32)


def enlarged(images: Image) -> Image:
    """Interpolate images (..., R_v, R_u), which are 0 around what they show."""
    R_v, R_u = images.shape[-2:]
    return enlarging(R_v) @ images @ enlarging(R_u).T


def read(images: Image, v: Image, u: Image) -> Image:
    """Read images (F, N_v, N_u) between their samples at N places; shape (F, N)."""
    N_u = images.shape[-1]
    i, j = v.astype(np.intp), u.astype(np.intp)
    near = i * N_u + j
    v, u = v - i, u - j
    found = np.empty((len(images), len(v)), np.float32)
    for image, out in zip(images.reshape(len(images), -1), found, strict=True):
        upper, right = image.take(near), image.take(near + 1)
        lower, corner = image.take(near + N_u), image.take(near + (N_u + 1))
        right -= upper
        upper += np.multiply(right, u, out=right)
        corner -= lower
        lower += np.multiply(corner, u, out=corner)
        lower -= upper
        np.add(upper, np.multiply(lower, v, out=lower), out=out)
    return found


def developed(
    camera: AnyCamera,
    view: View,
    light: Image,
    hidden: Image,
    suns: tuple[Sun, ...],
    medium: Medium,
    channel: NDArray[np.intp],
) -> tuple[Array, Array]:
    """Make radiance and transmittance of pixels from the image.

    Parameters
    ----------
    camera, view
        Whose pixels, and where the image's samples are.
    light, hidden
        Shapes (S, C, R_v, R_u) and (C, R_v, R_u): light that is scattered toward the
        eye per unit of what a sun would send, and what is hidden, for C different
        extinctions.
    suns, medium
        The lights and the medium.
    channel
        Which of the C extinctions red, green and blue have, shape (3,).

    Returns
    -------
    Shape (H, W, 3) each.
    """
    H, W = view.shear.size
    pixels, found = warped(view, np.concatenate([hidden, *light]), len(hidden))
    C = len(hidden)
    radiance, through = np.zeros((H * W, 3)), np.ones((C, H * W))
    through[:, pixels] -= found[:C]
    # Each sun sends what the phase function has for the pixel's direction.
    lit = np.zeros((3, len(pixels)))
    toward = np.zeros((1, 3))  # isotropic: the same for all
    if medium.phase != "isotropic":
        toward = directions(camera, pixels)
    for n, sun in enumerate(suns, start=1):
        p = phase_along(medium, toward, sun.direction)
        source = medium.albedo_rgb * sun.irradiance
        for c in range(3):
            lit[c] += (source[c] * p) * found[n * C + channel[c]]
    radiance[pixels] = lit.T
    shape = (H, W, 3)
    if C == 1:
        one = through.reshape(H, W, 1)
        return radiance.reshape(shape), np.broadcast_to(one, shape)
    return radiance.reshape(shape), through[channel].T.reshape(shape)


def warped(view: View, images: Image, hidden: int) -> tuple[NDArray[np.intp], Image]:
    """Let pixels read the image at their own q.

    Parameters
    ----------
    view
        Where the image's samples are.
    images
        Shape (F, R_v, R_u), values in [0, 1], 0 where there is no cloud.
    hidden
        How many of them are 1 - T; the others are light, in the same order, for each
        sun.

    Returns
    -------
    Numbers of the N pixels that lie in the image, and what they read, (F, N).
    """
    H, W = view.shear.size
    # 1. Enlarge.
    images = enlarged(images)
    # 2. Where pixels lie in it.
    columns, rows = np.arange(W, dtype=np.float32), np.arange(H)[:, None]
    places = view.shear.places(columns, rows)
    at = []
    for q, own in zip((view.q_v, view.q_u), places, strict=True):
        number = (own - q[0]) * (ENLARGED / (q[1] - q[0]))
        at.append(np.clip(number, -1.0, FARTHEST).astype(np.float32))
    (v, u), (N_v, N_u) = at, images.shape[-2:]
    pixels = np.flatnonzero((v > 0.0) & (v < N_v - 1.0) & (u > 0.0) & (u < N_u - 1.0))
    v, u = v.reshape(-1)[pixels], u.reshape(-1)[pixels]
    # 3. Read. A cubic may leave the range of what it joins.
    found = read(images, v, u)
    np.clip(found, 0.0, 1.0, out=found)
    if view.cut:
        sharpen(view, found, hidden, v, u, [own.reshape(-1)[pixels] for own in places])
    return pixels, found


def sharpen(
    view: View, found: Image, hidden: int, v: Image, u: Image, q: list[Array]
) -> None:
    """Give pixels their own length in the box, where the image's samples blur it.

    The mean extinction along a ray changes slowly from ray to ray; beside an edge of a
    box filled with cloud the length in it does not. So the optical depth that a pixel
    read is multiplied by its own length over the length that it would have read.
    """
    first, last = view.ends(view.q_v[:, None], view.q_u)
    lengths = enlarged(np.maximum(last - first, 0.0)[None])
    blurred = np.maximum(read(lengths, v, u)[0], np.float32(LEAST))
    first, last = view.ends(*q)
    ratio = np.minimum(np.maximum(last - first, 0.0) / blurred, np.float32(MOST))
    for c in range(hidden):
        before = np.minimum(found[c], np.float32(OPAQUE))
        after = -np.expm1(ratio * np.log1p(-before))
        gain = np.divide(after, before, out=ratio.copy(), where=before > 0.0)
        found[c] *= gain
        found[c + hidden :: hidden] *= gain


def directions(camera: AnyCamera, pixels: NDArray[np.intp]) -> Array:
    """Give the directions of some pixels, as `refcloud.camera.rays`; shape (N, 3)."""
    right, up, back = axes(camera)
    if not isinstance(camera, Camera):
        return -back[None, :]
    tall = 2.0 * np.tan(0.5 * camera.fov_y) / camera.height
    row, column = np.divmod(pixels, camera.width)
    x = (column + 0.5 - 0.5 * camera.width) * tall
    y = (0.5 * camera.height - (row + 0.5)) * tall
    ahead = x[:, None] * right + y[:, None] * up - back
    return ahead / np.sqrt(np.square(x) + np.square(y) + 1.0)[:, None]
