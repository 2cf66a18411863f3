"""Directions that stand for the whole sphere: unit vectors, each with a solid angle.

Three sets. The 26 neighbours of a voxel: light steps from centre to centre, and nothing
is interpolated. Lebedev's 50 and a product of 8 heights and 16 azimuths take more of a
forward phase function; their light is shifted by parts of a voxel.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import check_fields, checked
from refcloud.conventions import WHOLE_SPHERE, Array, Range, Shape

# Shares of the sphere, by how many axes a lattice vector has: exact to degree 7.
NEIGHBOUR_SHARES = {1: 1 / 21, 2: 4 / 105, 3: 9 / 280}
# Lebedev's rule of 50 points, exact to degree 11; the last are (1, 1, 3) / sqrt(11).
LEBEDEV_SHARES = {1: 4 / 315, 2: 64 / 2835, 3: 27 / 1280}
LEBEDEV_LAST = 14641 / 725760
HEIGHTS, AZIMUTHS = 8, 16  # exact to degree 15

DirectionCount = Literal[26, 50, 128]


@dataclass(frozen=True)
class Directions:
    """A quadrature of the sphere.

    Attributes
    ----------
    vectors
        Unit vectors in which light travels, shape (N, 3) in x, y, z.
    weights
        Solid angle that each stands for, shape (N,), steradian; their sum is 4 pi.
    degree
        L, the last Legendre term of a phase function that the set carries: products of
        two such terms are still integrated exactly.
    """

    vectors: Annotated[Array, Shape("N", 3)]
    weights: Annotated[Array, Shape("N"), Range(0.0, WHOLE_SPHERE, "sr")]
    degree: int

    def __post_init__(self) -> None:
        check_fields(self)


@checked
def sphere_directions(count: DirectionCount = 26) -> Directions:
    """Give a set of directions by its size.

    Formula: 26 neighbours with 4 pi (1/21, 4/105, 9/280) for faces, edges and corners;
    50 of Lebedev's with 4 pi (4/315, 64/2835, 27/1280, 14641/725760); 128 as Gauss's 8
    heights along y times 16 azimuths

    Parameters
    ----------
    count
        26, 50 or 128.

    Returns
    -------
    The set; each direction's opposite is in it too.

    Source: an extension of paper M (multiple scattering, X09).

    Examples
    --------
    >>> sphere_directions(26).vectors[4]
    array([ 0.,  0., -1.])
    >>> round(float(sphere_directions(50).weights.sum() / WHOLE_SPHERE), 12)
    1.0
    """
    if count == 128:
        return _product()
    shares = NEIGHBOUR_SHARES if count == 26 else LEBEDEV_SHARES
    lattice = [d for d in itertools.product((-1, 0, 1), repeat=3) if any(d)]
    weights = [shares[sum(map(abs, d))] for d in lattice]
    if count == 50:
        signs = list(itertools.product((-1, 1), repeat=3))
        for place in range(3):
            lengths = [1, 1, 1]
            lengths[place] = 3
            last = [
                tuple(s * n for s, n in zip(d, lengths, strict=True)) for d in signs
            ]
            lattice += last
            weights += [LEBEDEV_LAST] * len(last)
    # In the order of [z, y, x], as voxels lie in memory.
    vectors = np.array(lattice, dtype=np.float64)[:, ::-1]
    vectors /= np.sqrt(np.square(vectors).sum(axis=1, keepdims=True))
    degree = {26: 3, 50: 5}[count]
    return Directions(vectors, WHOLE_SPHERE * np.array(weights), degree)


def _product() -> Directions:
    """Multiply Gauss's heights by equal azimuths, half a step off the axes."""
    height, share = np.polynomial.legendre.leggauss(HEIGHTS)
    azimuth = (np.arange(AZIMUTHS) + 0.5) * (math.tau / AZIMUTHS)
    level = np.sqrt(1.0 - np.square(height))
    vectors = np.stack(
        [
            np.outer(level, np.cos(azimuth)),
            np.broadcast_to(height[:, None], (HEIGHTS, AZIMUTHS)),
            np.outer(level, np.sin(azimuth)),
        ],
        axis=-1,
    )
    weights = np.repeat(share * (math.tau / AZIMUTHS), AZIMUTHS)
    return Directions(vectors.reshape(-1, 3), weights, 7)
