"""Light as a field: an extension that lets a ball's colour vary over it.

A ball has one light value, so that a flat splat shows as a disc. Here the balls' values
are the samples of a field: at a point it is the mean of the values of all balls there,
weighted by their densities. The weights are never negative and sum to 1 whatever the
values: light adds up over suns, none comes from nothing, and no point is brighter than
the brightest ball that reaches it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.cloudmap.sample import clamped_trilinear
from refcloud.conventions import Array, Positive, Range, Shape
from refcloud.lighting.order import depth_order
from refcloud.metaballs import Metaballs
from refcloud.metaballs.kernels import profile_of

SPACING = 0.5  # nodes per median radius: no ball of that size falls between nodes
LEAST_SPACING = 1e-90  # counts of nodes stay finite numbers, whatever the radii
MOST_NODES = 1 << 20  # a wider cloud gets a coarser table
PAIRS = 1 << 14  # of node and ball, worked on together
# Weight of the ball's own value against a full density's 1: it decides where the table
# is empty, and nowhere else shows.
OWN = 1e-3


@dataclass(frozen=True)
class LightField:
    """A field of C values as weighted sums at the nodes of a table.

    Attributes
    ----------
    sums
        Shape (D, H, W, C + 1): sums of weight times value, and of the weights.
    lower
        The first node, shape (3,), scene units.
    spacing
        Between nodes, scene units.
    """

    sums: Array
    lower: Array
    spacing: float


@checked
def light_field(
    balls: Metaballs,
    values: Annotated[Array, Shape("N", "C")],
    *,
    reach: Annotated[float, Positive] = 1.15,
) -> LightField:
    """Sum the balls' values, weighted by their densities, at the nodes of a table.

    Formula: at each node, sum_j w_j (v_j, 1) with w_j = density_j / max density times
    the ball's profile stretched to reach R_j

    Parameters
    ----------
    balls
        The cloud, N balls.
    values
        Shape (N, C).
    reach
        How far a ball's value counts, in its radii.

    Returns
    -------
    The field; `field_value` reads it.

    Source: an extension of paper M, eq 13, from density to light.
    """
    channels = values.shape[1] + 1
    radii = balls.radii * reach
    largest = balls.densities.max(initial=0.0)
    if not largest > 0.0:
        return LightField(np.zeros((1, 1, 1, channels)), np.zeros(3), 1.0)
    spacing = max(SPACING * float(np.median(balls.radii)), LEAST_SPACING)
    lower = (balls.centers - radii[:, None]).min(axis=0)
    upper = (balls.centers + radii[:, None]).max(axis=0)
    while np.prod(np.ceil((upper - lower) / spacing) + 1.0) > MOST_NODES:
        spacing *= 2.0
    W, H, D = (np.ceil((upper - lower) / spacing) + 1.0).astype(int)
    value = np.concatenate([values, np.ones((len(values), 1))], axis=1)
    value *= (balls.densities / largest)[:, None]
    # 1. Each ball adds to the box of nodes that it reaches.
    first = np.ceil((balls.centers - radii[:, None] - lower) / spacing).astype(int)
    last = np.floor((balls.centers + radii[:, None] - lower) / spacing).astype(int)
    first, last = np.maximum(first, 0), np.minimum(last + 1, [W, H, D])
    box = np.maximum(last - first, 0)
    # 2. In an order that the input's does not show in: sums round by their order.
    order = depth_order(balls, np.zeros(len(radii)))
    many = np.cumsum(box[order].prod(axis=1))
    sums = np.zeros((channels, D * H * W))
    for part in np.split(order, np.flatnonzero(np.diff(many // PAIRS)) + 1):
        # 3. A pair for each node of each box, ball after ball.
        wide, high, deep = box[part].T
        count = wide * high * deep
        within = np.arange(int(count.sum()))
        within -= np.repeat(np.cumsum(count) - count, count)
        number = np.repeat(np.arange(len(part)), count)
        row, i = np.divmod(within, wide[number])
        k, j = np.divmod(row, high[number])
        ball = part[number]
        node, q = np.zeros(len(ball), np.intp), np.zeros(len(ball))
        for a, size, step in ((2, D, k), (1, H, j), (0, W, i)):
            place = first[ball, a] + step
            node = node * size + place
            away = lower[a] + place * spacing - balls.centers[ball, a]
            q += np.square(away / radii[ball])
        weight = profile_of(q, balls.kernel)
        # 4. `add.at` adds pair after pair, in their order.
        for total, worth in zip(sums, value.T, strict=True):
            np.add.at(total, node, weight * worth[ball])
    table = np.ascontiguousarray(sums.T).reshape(D, H, W, channels)
    return LightField(table, lower, spacing)


@checked
def field_value(
    field: LightField,
    points: Annotated[Array, Shape("...", 3)],
    *,
    own: Annotated[Array, Shape("C"), Range(0.0)],
) -> Array:
    """Read a light field as one ball sees it.

    Formula: (sum w v + 0.001 own) / (sum w + 0.001), sums interpolated between nodes

    Parameters
    ----------
    field
        Of `light_field`.
    points
        Shape (..., 3), scene units.
    own
        The values of the ball that is drawn, shape (C,).

    Returns
    -------
    Shape (..., C), between the smallest and the largest value around.

    Source: an extension of paper M, eq 13.
    """
    x, y, z = np.moveaxis((points - field.lower) / field.spacing, -1, 0)
    return field_value_of(field, x, y, z, own)


def field_value_of(
    field: LightField, x: Array, y: Array, z: Array, own: Array
) -> Array:
    """Read a light field at node coordinates without a check.

    Parameters
    ----------
    field
        Of `light_field`.
    x, y, z
        Coordinates in nodes, one shape.
    own
        As `field_value`.

    Returns
    -------
    Shape (..., C).
    """
    sums = clamped_trilinear(field.sums, x, y, z)
    value = sums[..., :-1]
    value += OWN * own
    value /= sums[..., -1:] + OWN
    return value
