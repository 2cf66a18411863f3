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
from refcloud.metaballs import Metaballs, profile

SPACING = 0.5  # nodes per median radius: no ball of that size falls between nodes
LEAST_SPACING = 1e-90  # counts of nodes stay finite numbers, whatever the radii
MOST_NODES = 1 << 20  # a wider cloud gets a coarser table
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
    sums = np.zeros((D, H, W, channels))
    value = np.concatenate([values, np.ones((len(values), 1))], axis=1)
    value *= (balls.densities / largest)[:, None]
    # Each ball adds to the box of nodes that it reaches.
    first = np.ceil((balls.centers - radii[:, None] - lower) / spacing).astype(int)
    last = np.floor((balls.centers + radii[:, None] - lower) / spacing).astype(int)
    first, last = np.maximum(first, 0), np.minimum(last + 1, [W, H, D])
    # In an order that the input's does not show in: sums round by their order.
    for k in depth_order(balls, np.zeros(len(radii))):
        (i0, j0, k0), (i1, j1, k1) = first[k], last[k]
        x, y, z = (
            np.square((lower[a] + np.arange(low, high) * spacing - c) / radii[k])
            for a, low, high, c in zip(
                range(3), first[k], last[k], balls.centers[k], strict=True
            )
        )
        q = z[:, None, None] + y[None, :, None] + x[None, None, :]
        if q.size:
            weight = profile(q, balls.kernel)
            sums[k0:k1, j0:j1, i0:i1] += weight[..., None] * value[k]
    return LightField(sums, lower, spacing)


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
