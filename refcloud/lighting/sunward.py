"""Pass 1: how much of each sun's light reaches each ball (paper M, section 4.1).

The camera stands at the sun. Balls are drawn near to far; before a ball is drawn, the
framebuffer is read back over its projection: the mean is the light that reaches it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from refcloud.camera import OrthographicCamera, project
from refcloud.checking import checked
from refcloud.conventions import Array, Observer
from refcloud.lighting.depths import ball_depths
from refcloud.lighting.lit import LitMetaballs
from refcloud.lighting.look import Look, LookName, named
from refcloud.lighting.order import depth_order
from refcloud.metaballs import Metaballs
from refcloud.optics import (
    PHASE_MAN2003,
    Medium,
    Sun,
    coupling_man2003,
    largest_steady_tau,
    scattered_man2003,
)
from refcloud.optics.extinction import held_share, split_share
from refcloud.raster import framebuffer
from refcloud.raster.blending import blend_patch
from refcloud.raster.footprint import footprint_of, opacity_of, patch_of
from refcloud.raster.splat import mean_of

FROM_ABOVE = np.array([0.0, 1.0, 0.0])
BORDER = 1.02  # room around the cloud in the sun's buffer, as a factor


@checked
def sunward(
    balls: Metaballs,
    suns: tuple[Sun, ...],
    *,
    medium: Medium,
    look: Look | LookName = "cumulus",
    observe: Observer | None = None,
) -> LitMetaballs:
    """Carry every sun's light through the balls: pass 1.

    Formula: I_k = g_{k-1} + T_{k-1} I_{k-1}, I_1 = I_0, T = exp(-tau), where I_k is the
    mean of the framebuffer over ball k

    Parameters
    ----------
    balls
        The cloud.
    suns
        Each is carried by itself; the results add up.
    medium
        Extinction and albedo; coloured ones are carried channel by channel.
    look
        The rules, or their name.
    observe
        Called with (name, value): order and framebuffer of each light, as "sun 0
        order", "sun 0 buffer", ..., "sky ...", "ground ..."; of a coloured medium once
        for each channel.

    Returns
    -------
    The lit balls.

    Raises
    ------
    ValueError
        With gain="refuse", where eq 26 would make light.

    Source: paper M, eq 26 to 28, L04 to L09, L12, L13; E22 to E27.
    """
    rules = named(look)
    watch = observe or (lambda name, value: None)
    count = len(balls.radii)
    light = np.zeros((len(suns), count, 3))
    for number, sun in enumerate(suns):
        if sun.irradiance.any():
            share = light_share(
                balls,
                sun.direction,
                medium,
                rules,
                rules.forward,
                rules.buffer,
                _labelled(watch, f"sun {number}"),
            )
            light[number] = share * sun.irradiance
    ambient = np.zeros((count, 3))
    for name, direction, color in (
        ("sky", FROM_ABOVE, rules.sky_light),
        ("ground", -FROM_ABOVE, rules.ground_light),
    ):
        if color.any():
            share = light_share(
                balls,
                direction,
                medium,
                rules,
                rules.sky_forward,
                rules.sky_buffer,
                _labelled(watch, name),
            )
            ambient += share * color
    return LitMetaballs(balls, tuple(suns), light, ambient, medium, rules)


def _labelled(watch: Observer, light: str) -> Observer:
    """Let what is watched say which light it is of."""
    return lambda name, value: watch(f"{light} {name}", value)


def light_share(
    balls: Metaballs,
    direction: Array,
    medium: Medium,
    look: Look,
    forward: float,
    side: int,
    watch: Observer,
) -> Array:
    """Give the share of one light that reaches each ball, unchecked.

    Parameters
    ----------
    balls, medium, look
        As `sunward`.
    direction
        Toward the light, unit vector.
    forward
        k of the "split" rule.
    side
        Side of the square framebuffer, pixels.
    watch
        Called with (name, value).

    Returns
    -------
    Shape (N, 3), at least 0.
    """
    share = np.empty((len(balls.radii), 3))
    done: dict[tuple[float, float], int] = {}
    keys = zip(medium.sigma_t_rgb.tolist(), medium.albedo_rgb.tolist(), strict=True)
    for channel, key in enumerate(keys):
        if key in done:  # a grey medium is carried once
            share[:, channel] = share[:, done[key]]
            continue
        done[key] = channel
        tau = ball_depths(balls, key[0], look)
        share[:, channel] = _carry(
            balls, direction, tau, key[1], look, forward, side, watch
        )
    return share


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
    lower = (balls.centers - balls.radii[:, None]).min(axis=0)
    upper = (balls.centers + balls.radii[:, None]).max(axis=0)
    centers = balls.centers - 0.5 * (lower + upper)
    reach = np.sqrt(np.square(centers).sum(axis=1)) + balls.radii
    radius = float(reach.max()) * BORDER
    camera = OrthographicCamera(
        radius * direction,
        np.zeros(3),
        height_of_view=2.0 * radius,
        width=side,
        height=side,
    )
    return camera, centers


def _carry(
    balls: Metaballs,
    direction: Array,
    tau: Array,
    albedo: float,
    look: Look,
    forward: float,
    side: int,
    watch: Observer,
) -> Array:
    """Run pass 1 for one light and one colour channel: the literal loop."""
    count = len(tau)
    reached = np.zeros(count)
    if count == 0:
        return reached
    scatter = handed_on(look, albedo, forward)
    on_axis = scatter(tau)  # refuses here, before anything is drawn

    # 1. The camera at the light; the buffer filled with white, the unblocked light.
    camera, centers = light_camera(balls, direction, side)
    x, y, depth, scale = project(camera, centers)
    buffer = framebuffer(side, side, color=np.ones(4))
    order = depth_order(balls, depth)
    watch("order", order)
    for k in order:
        radius = float(balls.radii[k] * scale[k])
        place = float(x[k]), float(y[k]), radius
        patch = patch_of(*place, side, side)
        weight = None
        if patch is not None:
            weight = footprint_of(patch.q, balls.kernel, look.footprint)
        # 2. Read back: the light that reaches this ball is the mean over it.
        mean = mean_of(buffer.pixels, *place, patch, look.readback, weight)
        light = 1.0 if mean is None else float(mean[0])
        reached[k] = light
        # 3. Draw it: eq 27 at every pixel, c = 1 g + T c (eq 28).
        if patch is None or weight is None:
            continue
        source = np.empty((*weight.shape, 4))
        if look.transmittance == "linear":
            source[..., :3] = (weight * (light * on_axis[k]))[..., None]
        else:
            source[..., :3] = (scatter(weight * tau[k]) * light)[..., None]
        source[..., 3] = opacity_of(weight, float(tau[k]), look.transmittance)
        blend_patch(buffer.pixels[patch.rows, patch.columns], source)
    watch("buffer", buffer)
    return reached
