"""One light's view of the balls: what both forms of pass 1 start from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import OrthographicCamera, project
from refcloud.conventions import Array
from refcloud.lighting.look import Look
from refcloud.lighting.order import depth_order
from refcloud.metaballs import Metaballs
from refcloud.optics import (
    PHASE_MAN2003,
    coupling_man2003,
    largest_steady_tau,
    scattered_man2003,
)
from refcloud.optics.extinction import held_share, split_share

BORDER = 1.02  # room around the cloud in the sun's buffer, as a factor


@dataclass(frozen=True, eq=False)
class LightView:
    """Balls as one light sees them.

    Attributes
    ----------
    balls
        The cloud, N balls.
    side
        Width and height of the light's framebuffer, pixels.
    x, y, radius
        In the framebuffer, pixels, shape (N,).
    order
        From near to far.
    """

    balls: Metaballs
    side: int
    x: Array
    y: Array
    radius: Array
    order: NDArray[np.intp]


def light_view(balls: Metaballs, direction: Array, side: int) -> LightView:
    """Look at the balls from a light, unchecked.

    Parameters
    ----------
    balls
        At least one.
    direction
        Toward the light, unit vector.
    side
        Width and height of its framebuffer, pixels.

    Returns
    -------
    The view.
    """
    camera, centers = light_camera(balls, direction, side)
    x, y, depth, scale = project(camera, centers)
    order = depth_order(balls, depth)
    return LightView(balls, side, x, y, balls.radii * scale, order)


def handed_on(look: Look, albedo: float, forward: float) -> Callable[[Array], Array]:
    """Give the rule for the share of light that a depth of tau scatters onward.

    Parameters
    ----------
    look
        Its `scattering`, `solid_angle` and `gain` decide.
    albedo
        Scattered share of extinction.
    forward
        k of the "split" rule.

    Returns
    -------
    A function from tau, any shape, to shares in [0, 1], the same shape.
    """
    if look.scattering == "split":
        return lambda tau: split_share(tau, albedo * forward)
    kappa = coupling_man2003(albedo, PHASE_MAN2003, solid_angle=look.solid_angle)
    if kappa > 1.0:
        raise ValueError(
            f"solid_angle: expected albedo 1.5 Omega / 4 pi of at most 1, got"
            f" {kappa:.4g}; lower solid_angle or albedo"
        )
    limit = largest_steady_tau(kappa)
    if look.gain == "refuse":
        return lambda tau: scattered_man2003(tau, kappa, gain="refuse")
    return lambda tau: held_share(tau, kappa, limit)


def light_camera(
    balls: Metaballs, direction: Array, side: int
) -> tuple[OrthographicCamera, Array]:
    """Place an orthographic camera at the light so that it sees every ball.

    It looks at the cloud's middle as the origin: a cloud far out in the world is lit
    along the same direction, to the last bits, as one at home.

    Parameters
    ----------
    balls
        At least one.
    direction
        Toward the light, unit vector.
    side
        Width and height of its framebuffer, pixels.

    Returns
    -------
    The camera, and the centres as it counts them, shape (N, 3).
    """
    # By axis: whole rows of memory.
    lower = [(at - balls.radii).min() for at in balls.centers.T]
    upper = [(at + balls.radii).max() for at in balls.centers.T]
    middle = 0.5 * np.add(lower, upper)
    centers = np.stack([at - m for at, m in zip(balls.centers.T, middle, strict=True)])
    x, y, z = np.square(centers)
    reach = np.sqrt(x + y + z) + balls.radii
    radius = float(reach.max()) * BORDER
    camera = OrthographicCamera(
        radius * direction,
        np.zeros(3),
        height_of_view=2.0 * radius,
        width=side,
        height=side,
    )
    return camera, centers.T
