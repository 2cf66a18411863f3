"""What each ball sends toward one eye, and the air in between."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from refcloud.camera import AnyCamera, Camera, axes
from refcloud.checking import check_fields, checked
from refcloud.conventions import WHOLE_SPHERE, Array, Colour, Positive
from refcloud.extremes import refuse_bright, refuse_small
from refcloud.lighting.depths import ball_depths
from refcloud.lighting.lightview import handed_on
from refcloud.lighting.lit import LitMetaballs
from refcloud.lighting.look import Look
from refcloud.metaballs import Metaballs
from refcloud.optics import PHASE_MAN2003, Medium, coupling_man2003, phase


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

    Formula: for each sun albedo phase(cos_theta) light + glow, and the ambient light;
    in the paper's rule a sun's term is g* / (1 - T), g* = albedo tau phase Omega I /
    (4 pi)

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
    colours = np.empty((len(balls.radii), len(lit.suns) + 1, 3))
    toward_eye = _toward_eye(balls.centers, camera)
    gain = gain_of(balls, medium, lit.look)
    for s, sun in enumerate(lit.suns):
        # The sun's light travels along -direction and leaves toward the eye.
        x, y, z = toward_eye.T
        a, b, c = sun.direction
        cos_theta = np.clip(-(x * a + y * b + z * c), -1.0, 1.0)
        scattered = phase(medium, cos_theta)[:, None] * medium.albedo_rgb
        colours[:, s] = scattered * lit.light[s] * gain
        if lit.glow is not None:
            colours[:, s] += lit.glow[s]
    colours[:, -1] = lit.ambient
    return colours


def gain_of(balls: Metaballs, medium: Medium, look: Look) -> Array:
    """Give what the scattering rule puts on top of albedo times phase, unchecked.

    Parameters
    ----------
    balls, medium, look
        As `LitMetaballs` holds them.

    Returns
    -------
    Shape (N, 3), at least 0.
    """
    gain = np.ones((len(balls.radii), 3))
    if look.scattering == "split":
        return gain
    keys = zip(medium.albedo_rgb.tolist(), medium.sigma_t_rgb.tolist(), strict=True)
    found: dict[tuple[float, float], Array] = {}  # of a grey medium only one
    for channel, key in enumerate(keys):
        if key not in found:
            found[key] = _gain_man2003(ball_depths(balls, key[1], look), key[0], look)
        gain[:, channel] = found[key]
    return gain * (look.solid_angle / WHOLE_SPHERE)


def _gain_man2003(tau: Array, albedo: float, look: Look) -> Array:
    """Give depth as eq 26 counts it, held where pass 1 holds it, over the opacity."""
    kappa = coupling_man2003(albedo, PHASE_MAN2003, solid_angle=look.solid_angle)
    held = handed_on(look, albedo, 0.0)(tau)
    effective = np.divide(held, kappa, out=np.array(tau), where=kappa > 0.0)
    opacity = -np.expm1(-tau)
    thin = opacity <= 0.0
    return np.where(thin, 1.0, effective / np.where(thin, 1.0, opacity))


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
