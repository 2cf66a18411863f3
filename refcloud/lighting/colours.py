"""What each ball sends toward one eye, and the air in between."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from refcloud.camera import AnyCamera, Camera, axes
from refcloud.checking import check_fields, checked
from refcloud.conventions import Array, Colour, Positive
from refcloud.extremes import refuse_bright, refuse_small
from refcloud.lighting.lit import LitMetaballs
from refcloud.optics import phase


@dataclass(frozen=True)
class Haze:
    """Air between the cloud and the eye.

    Attributes
    ----------
    color
        What very distant balls look like, RGB radiance.
    length
        Distance over which a ball's own light falls to 1/e, scene units.
    """

    color: Colour
    length: Annotated[float, Positive]

    def __post_init__(self) -> None:
        check_fields(self)
        refuse_bright("color", self.color)
        refuse_small("length", self.length)


@checked
def ball_colours(lit: LitMetaballs, camera: AnyCamera) -> Array:
    """Give the radiance that each ball would show if nothing came through it.

    Formula: for each sun albedo phase(cos_theta) light + glow, and albedo times the
    ambient light; in the paper's rule a sun's term is g* / (1 - T), g* = albedo tau
    phase Omega I / (4 pi)

    Parameters
    ----------
    lit
        The balls and their light, of `sunward`.
    camera
        Where the eye is; an orthographic camera sees every ball along one direction.

    Returns
    -------
    Shape (N, S + 1, 3), radiance, at least 0: by sun, and the ambient light last. A
    splat adds their sum times its opacity.

    Source: paper M, eq 26 and 29; E20, E22, E23, E26.
    """
    balls, medium = lit.balls, lit.medium
    # In memory channel by channel: each is one list of numbers.
    colours = np.empty((len(lit.suns) + 1, 3, len(balls.radii))).transpose(2, 0, 1)
    toward_eye = _toward_eye(balls.centers, camera)
    for s, sun in enumerate(lit.suns):
        # The sun's light travels along -direction and leaves toward the eye.
        x, y, z = toward_eye.T
        a, b, c = sun.direction
        cos_theta = np.clip(-(x * a + y * b + z * c), -1.0, 1.0)
        colours[:, s] = phase(medium, cos_theta)[:, None] * lit.scattered[s]
        if lit.glow is not None:
            colours[:, s] += lit.glow[s]
    colours[:, -1] = lit.reflected  # what is absorbed is not seen
    return colours


def _toward_eye(centers: Array, camera: AnyCamera) -> Array:
    """Give wo, the unit vector from each ball to the eye."""
    if not isinstance(camera, Camera):
        return np.broadcast_to(axes(camera)[2], centers.shape)
    # By axis: whole rows of memory.
    offset = np.stack(
        [at - axis for at, axis in zip(camera.eye, centers.T, strict=True)]
    )
    x, y, z = np.square(offset)
    length = np.sqrt(x + y + z)
    away = length > 0.0
    if away.all():
        return (offset / length).T
    # A ball around the eye itself is seen along the view axis.
    aside = (offset / np.where(away, length, 1.0)).T
    return np.where(away[:, None], aside, axes(camera)[2])


def clearness(haze: Haze | None, centers: Array, camera: AnyCamera) -> Array:
    """Give the share of each ball's light that passes the air, unchecked.

    Parameters
    ----------
    haze
        The air; None for none.
    centers
        Shape (N, 3), scene units.
    camera
        Where the eye is.

    Returns
    -------
    Shape (N,), in [0, 1]: exp(-distance / length).
    """
    if haze is None:
        return np.ones(len(centers))
    distance = np.sqrt(np.square(centers - camera.eye).sum(axis=1))
    return np.exp(-distance / haze.length)
