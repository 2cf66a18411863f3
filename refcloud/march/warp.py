"""From the image on a regular grid of q to the pixels of a camera."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import AnyCamera, Camera, axes
from refcloud.conventions import Array
from refcloud.march.light import phase_along
from refcloud.march.resample import Image
from refcloud.march.view import View
from refcloud.optics import Medium, Sun
from refcloud.transport.windows import catmull_rom

# Lengths in a box, in slices, and their ratio, beyond which nothing is corrected; and
# the most that a pixel hides for its optical depth to be told in single precision.
LEAST, MOST, OPAQUE = 1e-2, 4.0, 1.0 - 1e-6
ENLARGED = 3  # bilinear between samples a third as far apart errs a ninth as much


def enlarging(count: int) -> Image:
    """Write Catmull-Rom weights of samples ENLARGED times as dense, (3 n - 2, n)."""
    weights = np.zeros((ENLARGED * count, count), np.float32)
    sample = np.arange(count)
    for part in range(ENLARGED):
        for k, weight in enumerate(catmull_rom(part / ENLARGED), start=-1):
            known = sample[max(-k, 0) : count - max(k, 0)]  # beyond them there is 0
            weights[ENLARGED * known + part, known + k] = weight
    return weights[: ENLARGED * (count - 1) + 1]


def enlarged(images: Image) -> Image:
    """Interpolate images (..., R_v, R_u), which are 0 around what they show."""
    images = images @ enlarging(images.shape[-1]).T
    *more, n, N = images.shape
    # Rows lie in one piece each: their sums need no product, which is mostly with 0.
    found = np.zeros((*more, ENLARGED * n, N), np.float32)
    found[..., ::ENLARGED, :] = images
    for part in range(1, ENLARGED):
        between = found[..., part : ENLARGED * (n - 1) : ENLARGED, :]
        for k, weight in enumerate(catmull_rom(part / ENLARGED), start=-1):
            rows = slice(max(-k, 0), n - 1 - max(k - 1, 0))
            known = images[..., rows.start + k : rows.stop + k, :]
            between[..., rows, :] += known * np.float32(weight)
    return found[..., : ENLARGED * (n - 1) + 1, :]


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
    (H, W), C = view.shear.size, len(hidden)
    pixels, found = warped(view, np.concatenate([hidden, *light]), C)
    # Each sun sends what the phase function has for the pixel's direction.
    toward = np.zeros((1, 3))  # isotropic: the same for all
    if medium.phase != "isotropic" and suns:
        toward = directions(camera, pixels)
    radiance = np.zeros((H * W, 3))
    whole = np.zeros(H * W)
    for n, sun in enumerate(suns, start=1):
        p = phase_along(medium, toward, sun.direction)
        source = medium.albedo_rgb * sun.irradiance
        for extinction in range(C):
            whole[pixels] = p * found[n * C + extinction]
            for c in np.flatnonzero(channel == extinction):
                if n == 1:
                    np.multiply(whole, source[c], out=radiance[:, c])
                else:
                    radiance[:, c] += whole * source[c]
    through = np.ones((C, H * W))
    through[:, pixels] -= found[:C]
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
    Numbers of the N pixels that see cloud, and what they read, (F, N).
    """
    # 1. Enlarge.
    images = enlarged(images)
    # 2. Where pixels lie in it, if they do; and which of them see cloud.
    v, u = (at.reshape(-1) for at in numbers_of(view))
    N_v, N_u = images.shape[-2:]
    inside = (v > 0.0) & (v < N_v - 1.0) & (u > 0.0) & (u < N_u - 1.0)
    pixels = np.flatnonzero(inside)
    seen = beside((images != 0.0).any(axis=0))
    number = v[pixels].astype(np.intp) * N_u + u[pixels].astype(np.intp)
    pixels = pixels[seen.reshape(-1).take(number)]
    v, u = v[pixels], u[pixels]
    # 3. Read. A cubic may leave the range of what it joins.
    found = read(images, v, u)
    np.clip(found, 0.0, 1.0, out=found)
    if view.cut:
        sharpen(view, found, hidden, v, u)
    return pixels, found


def numbers_of(view: View) -> tuple[Image, Image]:
    """Give the rows and columns of the enlarged image at which all pixels read it.

    Numerator and denominator are sums of a row's and a column's part; they are small
    numbers in samples of the image, which single precision tells apart.
    """
    shear, (H, W) = view.shear, view.shear.size
    first = float(view.q_v[0]), float(view.q_u[0])
    step = (
        float(view.q_v[1] - view.q_v[0]) / ENLARGED,
        float(view.q_u[1] - view.q_u[0]) / ENLARGED,
    )
    w, *across = (
        (start + down * np.arange(H))[:, None].astype(np.float32)
        + (right * np.arange(W)).astype(np.float32)
        for start, right, down in shear.homogeneous(first, step)
    )
    ahead = w > 0.0
    if not ahead.all():  # what leads away from the slices is beside the image
        w = np.where(ahead, w, np.float32(1.0))
        across = [np.where(ahead, part, np.float32(-1.0)) for part in across]
    # As near the border of sight as this, the image is left in any case.
    np.maximum(w, np.float32(1e-20), out=w)
    with np.errstate(over="ignore"):
        return across[0] / w, across[1] / w


def beside(cloud: NDArray[Any]) -> NDArray[np.bool_]:
    """Mark samples if they, or the next ones along either axis, show cloud."""
    seen = cloud.copy()
    seen[:-1] |= cloud[1:]
    seen[:, :-1] |= seen[:, 1:].copy()
    return seen


def sharpen(view: View, found: Image, hidden: int, v: Image, u: Image) -> None:
    """Give pixels their own length in the box, where the image's samples blur it.

    The mean extinction along a ray changes slowly from ray to ray; beside an edge of a
    box filled with cloud the length in it does not. So the optical depth that a pixel
    read is multiplied by its own length over the length that it would have read.
    """
    first, last = view.ends(view.q_v[:, None], view.q_u)
    lengths = enlarged(np.maximum(last - first, 0.0)[None])
    blurred = np.maximum(read(lengths, v, u)[0], np.float32(LEAST))
    own = (
        q[0] + at.astype(np.float64) * ((q[1] - q[0]) / ENLARGED)
        for q, at in ((view.q_v, v), (view.q_u, u))
    )
    first, last = view.ends(*own)
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
