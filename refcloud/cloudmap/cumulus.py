"""The shape of a cumulus: ellipsoids on ellipsoids over a flat base, moved by noise.

An extension of the paper: where eq 10 multiplies the quadric by the noise, here the
noise moves the surface in and out. Small ellipsoids then keep their lobes instead of
falling into foam.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Positive, Range, Seed, Shape
from refcloud.noise import uniform

LOBES = (5, 6, 6)  # along the base; on each of those; on each of these
SHRINK = (0.55, 0.5)  # a child's size against its parent's, by generation
CREST = 0.18  # where along the base, in half widths, the cloud is highest
MEAN_NOISE = 0.22  # just above the mean of |eq 1|, 0.195: noise cuts a little in


@checked
def cumulus_ellipsoids(
    diameters: Annotated[Array, Shape(3), Positive], *, seed: Seed = 0
) -> tuple[Array, Array]:
    """Pile up 215 ellipsoids in three generations on the plane y = 0.

    Formula: five lie along x under a crest; six sit on each of them and six on each of
    those, in directions mostly upward, at 0.75 to 0.95 of the parent's surface

    Parameters
    ----------
    diameters
        Nominal width, height and depth, shape (3,), scene units, above 0.
    seed
        Chooses the cloud.

    Returns
    -------
    Centres and half axes, each of shape (215, 3), scene units.

    Source: paper M, section 2 (union of ellipsoid volumes, V05), extended.

    Examples
    --------
    >>> centers, radii = cumulus_ellipsoids([62.0, 34.0, 34.0], seed=7)
    >>> centers.shape, bool((radii > 0).all())
    ((215, 3), True)
    """
    width, height, depth = diameters

    def draw(generation: int, count: int, what: int, low: float, high: float) -> Array:
        u = uniform(np.arange(count), generation, what, seed=seed)
        return low + (high - low) * u

    # 1. The base row: a bulge of height under the crest.
    n = LOBES[0]
    along = 0.55 * np.linspace(-1.0, 1.0, n) + draw(0, n, 0, -0.08, 0.08)
    bulge = np.maximum(0.35, 1.0 - np.abs(along - CREST) ** 1.3)
    r = np.stack(
        [
            0.24 * width * draw(0, n, 1, 0.85, 1.1),
            0.48 * height * bulge * draw(0, n, 2, 0.9, 1.05),
            0.38 * depth * draw(0, n, 3, 0.8, 1.1),
        ],
        axis=1,
    )
    c = np.stack(
        [0.5 * width * along, 0.55 * r[:, 1], 0.15 * depth * draw(0, n, 4, -1.0, 1.0)],
        axis=1,
    )
    centers, radii = [c], [r]

    # 2. Two generations of children on their parents' surfaces.
    for generation, (each, shrink) in enumerate(
        zip(LOBES[1:], SHRINK, strict=True), start=1
    ):
        parent_c = np.repeat(c, each, axis=0)
        parent_r = np.repeat(r, each, axis=0)
        n = len(parent_c)
        up = draw(generation, n, 0, -0.15, 1.0)  # uniform on the sphere's upper part
        around = draw(generation, n, 1, 0.0, 2.0 * np.pi)
        level = np.sqrt(1.0 - up * up)
        out = np.stack([level * np.cos(around), up, level * np.sin(around)], axis=1)
        c = parent_c + parent_r * out * draw(generation, n, 2, 0.75, 0.95)[:, None]
        size = np.cbrt(parent_r.prod(axis=1)) * shrink
        size *= draw(generation, n, 3, 0.75, 1.25)
        r = size[:, None] * np.array([1.08, 0.95, 1.08])
        centers.append(c)
        radii.append(r)
    return np.concatenate(centers), np.concatenate(radii)


@checked
def depth_inside(
    x: Annotated[Array, Shape("W")],
    y: Annotated[Array, Shape("H")],
    z: Annotated[Array, Shape("D")],
    *,
    centers: Annotated[Array, Shape("N", 3)],
    radii: Annotated[Array, Shape("N", 3), Positive],
    least: Annotated[float, Range(-1e300, 0.0, "scene units")] = -1e300,
) -> Array:
    """Tell how deep the points of a grid lie inside a union of ellipsoids.

    Formula: max over j of min(r_j) (1 - |(p - c_j) / r_j|), at least `least`

    Parameters
    ----------
    x, y, z
        Coordinates along each axis, shapes (W,), (H,), (D,), scene units.
    centers, radii
        Of the ellipsoids, shape (N, 3), scene units.
    least
        Smaller values do not matter to the caller: boxes that lie lower are skipped.

    Returns
    -------
    Shape (D, H, W), scene units: positive inside.

    Source: an extension of paper M, eq 9.

    Examples
    --------
    >>> one = dict(centers=[[0, 0, 0]], radii=[[2, 2, 2]])
    >>> depth_inside([0.0, 3.0], [0.0], [0.0], **one)
    array([[[ 2., -1.]]])
    """
    depth = np.full((len(z), len(y), len(x)), least)
    for center, r in zip(centers, radii, strict=True):
        smallest = r.min()
        # Outside this box the ellipsoid's value is below `least` (proved: one axis
        # alone already brings |(p - c) / r| to 1 - least / min(r)).
        with np.errstate(over="ignore"):
            reach = r * (1.0 - least / smallest)
        sx, sy, sz = (
            (axis - middle) / half
            for axis, middle, half in zip((x, y, z), center, r, strict=True)
        )
        ix, iy, iz = (
            np.flatnonzero(np.abs(axis - middle) <= far)
            for axis, middle, far in zip((x, y, z), center, reach, strict=True)
        )
        if not (ix.size and iy.size and iz.size):
            continue
        distance = np.sqrt(
            np.square(sz[iz])[:, None, None]
            + np.square(sy[iy])[None, :, None]
            + np.square(sx[ix])[None, None, :]
        )
        window = np.ix_(iz, iy, ix)
        depth[window] = np.maximum(depth[window], smallest * (1.0 - distance))
    return depth


@checked
def displace(
    depth: Annotated[Array, Shape("D", "H", "W")],
    noise: Annotated[Array, Shape("D", "H", "W")],
    y: Annotated[Array, Shape("H")],
    *,
    relief: Annotated[float, Range(0.0, unit="scene units")] = 6.0,
    edge: Annotated[float, Range(0.0, unit="scene units", open_lower=True)] = 1.2,
) -> Array:
    """Move the surface by the noise, and cut it off at a flat base.

    Formula: clip((depth + A (|n| - 0.22)) / edge, 0, 1) * clip(y + n / 2, 0, 1)

    Parameters
    ----------
    depth
        Of `depth_inside`, shape (D, H, W), scene units.
    noise
        n, the signed sum of octaves, the same shape.
    y
        Height over the base, shape (H,), scene units.
    relief
        A, how far the noise moves the surface, scene units, at least 0.
    edge
        Width over which the density rises from 0 to 1, scene units, above 0.

    Returns
    -------
    Density, shape (D, H, W), in [0, 1].

    Source: an extension of paper M, eq 10.
    """
    surface = (depth + relief * (np.abs(noise) - MEAN_NOISE)) / edge
    base = y[None, :, None] + 0.5 * noise
    return np.clip(surface, 0.0, 1.0) * np.clip(base, 0.0, 1.0)
