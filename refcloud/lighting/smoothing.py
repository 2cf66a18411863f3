"""Colours that vary over a ball: an extension that keeps the laws of light.

A ball has one light value, so that a flat splat shows as a disc. Here the colour at a
point of a ball is a weighted mean of its neighbours' colours, with weights that change
linearly over the ball. The weights are never negative and sum to 1, whatever the
colours: light adds up over suns, none comes from nothing, and no pixel is brighter
than the brightest neighbour.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.conventions import Array, Range
from refcloud.metaballs import Metaballs

SHARPNESS = 2.0  # neighbours weigh exp(-2 d^2 / h^2), h the distance of the farthest
RIDGE = 0.3  # of the mean square distance: steadies the slope where neighbours line up
CHUNK = 1 << 21  # distances formed at once


@dataclass(frozen=True)
class Blend:
    """For each ball, whose colours it shows and how that changes over it.

    Attributes
    ----------
    neighbour
        Indices of m neighbours, the ball among them, shape (N, m).
    weight
        Their weights at the centre, at least 0, summing to 1, shape (N, m).
    slope
        Their relative change per radius along x, y, z, shape (N, m, 3): at offset o,
        |o| <= R, neighbour j weighs weight_j (1 + slope_j . o / R) >= 0.
    """

    neighbour: NDArray[np.intp]
    weight: Array
    slope: Array


@checked
def colour_blend(
    balls: Metaballs, *, neighbours: Annotated[int, Range(1, 64)] = 12
) -> Blend:
    """Fit the blend of neighbours that a local plane through their colours asks for.

    Formula: w_j = exp(-2 d_j^2 / h^2), normalised; slope_j = R A^-1 (x_j - mean) with
    A the weighted covariance and a ridge; slopes are cut to length 1/2 and centred,
    which keeps every weight at least 0 over the whole ball

    Parameters
    ----------
    balls
        The cloud, N balls.
    neighbours
        m, how many balls share; fewer where the cloud has fewer.

    Returns
    -------
    The blend.

    Source: look.md, section 1 (first-order splats), made linear and positive.
    """
    count = len(balls.radii)
    m = min(neighbours, count)
    if count == 0:
        empty = np.zeros((0, 0))
        return Blend(empty.astype(np.intp), empty, np.zeros((0, 0, 3)))
    nearest = _nearest(balls.centers, m)
    offset = balls.centers[nearest] - balls.centers[:, None]  # (N, m, 3)
    square = np.square(offset).sum(axis=2)
    far = square.max(axis=1, keepdims=True)
    far = np.where(far > 0.0, far, 1.0)  # one ball, or all in one place
    weight = np.exp(-SHARPNESS * square / far)
    weight /= weight.sum(axis=1, keepdims=True)

    # Slope of the weighted plane fit, as weights on the neighbours.
    centred = offset - (weight[..., None] * offset).sum(axis=1, keepdims=True)
    covariance = np.einsum("nj,nja,njb->nab", weight, centred, centred)
    spread = np.trace(covariance, axis1=1, axis2=2) / 3.0
    ridge = RIDGE * np.where(spread > 0.0, spread, 1.0)
    covariance[:, [0, 1, 2], [0, 1, 2]] += ridge[:, None]
    slope = np.linalg.solve(covariance, centred.transpose(0, 2, 1)).transpose(0, 2, 1)
    slope = slope * balls.radii[:, None, None]

    # Cut to length 1/2; centring then adds at most 1/2, so 1 + slope . o / R >= 0.
    length = np.sqrt(np.square(slope).sum(axis=2, keepdims=True))
    slope = slope * (0.5 / np.maximum(length, 0.5))
    slope = slope - (weight[..., None] * slope).sum(axis=1, keepdims=True)
    return Blend(nearest, weight, slope)


def blended_colours(blend: Blend, colours: Array) -> tuple[Array, Array]:
    """Give each ball's colour at its centre and its change per radius, unchecked.

    Parameters
    ----------
    blend
        Of `colour_blend`.
    colours
        Each ball's own colour, shape (N, 3).

    Returns
    -------
    Colours at the centres, shape (N, 3); change along x, y, z per radius, shape
    (N, 3, 3) as [ball, axis, channel].
    """
    around = colours[blend.neighbour]  # (N, m, 3)
    value = np.einsum("nj,njc->nc", blend.weight, around)
    change = np.einsum("nj,nja,njc->nac", blend.weight, blend.slope, around)
    return value, change


def _nearest(centers: Array, m: int) -> NDArray[np.intp]:
    """Find the m nearest centres of each, itself first, ties by index."""
    count = len(centers)
    found = np.empty((count, m), dtype=np.intp)
    rows = max(1, CHUNK // count)
    for start in range(0, count, rows):
        part = centers[start : start + rows]
        square = np.zeros((len(part), count))
        for axis in range(3):
            square += np.square(part[:, axis, None] - centers[None, :, axis])
        square[np.arange(len(part)), np.arange(start, start + len(part))] = -1.0
        found[start : start + rows] = np.argsort(square, axis=1, kind="stable")[:, :m]
    return found
