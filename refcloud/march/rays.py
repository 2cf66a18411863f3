"""Rays as the march takes them: one list of unit directions, in chunks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from refcloud.conventions import Array
from refcloud.march.box import refuse_still
from refcloud.optics import Medium


@dataclass(frozen=True)
class Rays:
    """A list of rays.

    Attributes
    ----------
    origins
        Shape (N, 3), scene units.
    directions
        Shape (N, 3), unit vectors.
    shape
        The leading axes that the caller's arrays have.
    """

    origins: Array
    directions: Array
    shape: tuple[int, ...]


def as_rays(origins: Array, directions: Array) -> Rays:
    """Make one list of arrays that broadcast, as `checked` has seen to."""
    refuse_still(directions)
    shape = np.broadcast_shapes(origins.shape, directions.shape)
    # Axis by axis: a sum over three neighbours takes longer than three long rows.
    x, y, z = (np.abs(directions[..., k]) for k in range(3))
    largest = np.maximum(np.maximum(x, y), z)[..., None]
    units = directions / largest  # no overflow, whatever the length
    x, y, z = (np.square(units[..., k]) for k in range(3))
    units /= np.sqrt(x + y + z)[..., None]
    return Rays(
        np.broadcast_to(origins, shape).reshape(-1, 3),
        np.broadcast_to(units, shape).reshape(-1, 3),
        shape[:-1],
    )


def shaped(
    radiance: Array, through: Array, rays: Rays, medium: Medium
) -> tuple[Array, Array]:
    """Give results the caller's leading axes.

    Parameters
    ----------
    radiance
        Shape (N, 3).
    through
        Transmittance, shape (N, 1), or (N, 3) where sigma_t is RGB.
    rays, medium
        Of the call.

    Returns
    -------
    Shapes (..., 3), and (...,) or (..., 3).
    """
    axes = () if np.ndim(medium.sigma_t) == 0 else (3,)
    return (
        radiance.reshape((*rays.shape, 3)),
        through.reshape((*rays.shape, *axes)),
    )
