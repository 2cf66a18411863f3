"""Pass 1 and the balls' colours, one ball, one pixel and one channel at a time.

Each function is the twin of the one of the same name in `refcloud.lighting`. A ball is
(centre, radius, density), a sun is (direction, irradiance).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from refcloud.conventions import WHOLE_SPHERE
from refcloud.plain.camera import Camera, Point, axes, between, dot, project, unit
from refcloud.plain.metaballs import Ball, axis_depth
from refcloud.plain.optics import (
    coupling_man2003,
    phase,
    scattered_man2003,
    scattered_split,
)
from refcloud.plain.raster import (
    blend,
    footprint,
    framebuffer,
    patch,
    read_mean,
    transmittance,
)

Colour = Sequence[float]  # red, green, blue
Sun = tuple[Point, Colour]


class Rules(NamedTuple):
    """The rules of light: the fields of `refcloud.lighting.Look`."""

    scattering: str
    transmittance: str
    footprint: str
    readback: str
    tau: float | None
    forward: float
    solid_angle: float
    gain: str
    sky_light: Colour
    ground_light: Colour
    sky_forward: float
    light_reach: float
    erosion: float
    erosion_cell: float
    erosion_depth: float
    relief: float
    buffer: int
    sky_buffer: int


class Medium(NamedTuple):
    """What a cloud is made of, by channel."""

    sigma_t: Colour
    albedo: Colour
    g: float
    phase: str


class Lit(NamedTuple):
    """Balls and the light that reaches them: `refcloud.lighting.LitMetaballs`."""

    balls: Sequence[Ball]
    kernel: str
    suns: Sequence[Sun]
    light: Sequence[Sequence[Colour]]  # by sun, then by ball
    ambient: Sequence[Colour]
    medium: Medium
    rules: Rules
    glow: Sequence[Sequence[Colour]] | None = None  # by sun, then by ball


def depth_order(balls: Sequence[Ball], depths: Sequence[float]) -> list[int]:
    """Sort the balls near to far; ties by x, y, z, R and density."""
    return sorted(
        range(len(balls)), key=lambda k: (depths[k], *balls[k][0], *balls[k][1:])
    )


def ball_depth(ball: Ball, kernel: str, sigma_t: float, rules: Rules) -> float:
    """Give one ball's optical depth on its axis; the rules may set it for all."""
    if rules.tau is not None:
        return rules.tau
    _, radius, density = ball
    return axis_depth(sigma_t, density, radius, kernel)


def handed_on(tau: float, rules: Rules, albedo: float, forward: float) -> float:
    """Give the share of light that a depth of tau scatters onward (eq 26)."""
    if rules.scattering == "split":
        return scattered_split(tau, albedo * forward)
    kappa = coupling_man2003(albedo, 1.5, solid_angle=rules.solid_angle)
    return scattered_man2003(tau, kappa, gain=rules.gain)


def light_camera(
    balls: Sequence[Ball], direction: Point, side: int, border: float
) -> tuple[Camera, list[Point]]:
    """Stand at the light so that every ball shows; the cloud's middle is the origin."""
    middle = []
    for axis in range(3):
        lower = min(center[axis] - radius for center, radius, _ in balls)
        upper = max(center[axis] + radius for center, radius, _ in balls)
        middle.append((lower + upper) / 2.0)
    here = (middle[0], middle[1], middle[2])
    centers = [between(here, (c[0], c[1], c[2])) for c, _, _ in balls]
    reach = border * max(
        math.hypot(*center) + ball[1]
        for center, ball in zip(centers, balls, strict=True)
    )
    eye = (reach * direction[0], reach * direction[1], reach * direction[2])
    start, up = (0.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    return Camera(eye, start, up, side, side, None, 2.0 * reach), centers


def carry(
    balls: Sequence[Ball],
    kernel: str,
    direction: Point,
    sigma_t: float,
    albedo: float,
    rules: Rules,
    forward: float,
    side: int,
    border: float,
) -> list[float]:
    """Run pass 1 for one light and one channel (eq 27): what reaches each ball."""
    reached = [0.0] * len(balls)
    if not balls:
        return reached
    camera, centers = light_camera(balls, direction, side, border)
    places = [project(camera, center) for center in centers]
    buffer = framebuffer(side, side, (1.0, 1.0, 1.0, 1.0))
    for k in depth_order(balls, [depth for _, _, depth, _ in places]):
        x, y, _, scale = places[k]
        where = x, y, balls[k][1] * scale
        # Read back: the mean over the ball is the light that reaches it.
        mean = read_mean(buffer, *where, rules.readback, kernel, rules.footprint)
        light = reached[k] = 1.0 if mean is None else mean[0]
        # Draw: c = 1 g + T c at every pixel (eq 28).
        tau = ball_depth(balls[k], kernel, sigma_t, rules)
        for row, column, q in patch(*where, side, side):
            weight = footprint(q, kernel, rules.footprint)
            if rules.transmittance == "linear":
                g = weight * handed_on(tau, rules, albedo, forward) * light
            else:
                g = handed_on(weight * tau, rules, albedo, forward) * light
            alpha = 1.0 - transmittance(weight, tau, rules.transmittance)
            pixel = buffer[row][column]
            pixel[:] = blend([g, g, g, alpha], pixel, "ONE", "ONE_MINUS_SRC_ALPHA")
    return reached


def sunward(
    balls: Sequence[Ball],
    kernel: str,
    suns: Sequence[Sun],
    medium: Medium,
    rules: Rules,
    border: float,
) -> Lit:
    """Carry every light through the balls, each by itself."""
    light, ambient = [], [[0.0] * 3 for _ in balls]
    channels = list(enumerate(zip(medium.sigma_t, medium.albedo, strict=True)))
    for direction, irradiance in suns:
        reached = [[0.0] * 3 for _ in balls]
        how = rules, rules.forward, rules.buffer, border
        for c, stuff in channels:
            shares = carry(balls, kernel, direction, *stuff, *how)
            for k, share in enumerate(shares):
                reached[k][c] = share * irradiance[c]
        light.append(reached)
    for height, color in ((1.0, rules.sky_light), (-1.0, rules.ground_light)):
        how = rules, rules.sky_forward, rules.sky_buffer, border
        for c, stuff in channels:
            shares = carry(balls, kernel, (0.0, height, 0.0), *stuff, *how)
            for k, share in enumerate(shares):
                ambient[k][c] += share * color[c]
    return Lit(balls, kernel, suns, light, ambient, medium, rules)


def toward_eye(center: Point, camera: Camera) -> Point:
    """Give the direction from a ball to the eye; on the eye itself, backward."""
    if camera.fov_y is None or tuple(center) == tuple(camera.eye):
        return axes(camera)[2]
    return unit(between(center, camera.eye))


def ball_colours(lit: Lit, k: int, camera: Camera) -> list[list[float]]:
    """Give what one ball sends to the eye over its opacity, by sun, ambient last."""
    medium, rules = lit.medium, lit.rules
    x, y, z = lit.balls[k][0]
    wo = toward_eye((x, y, z), camera)
    colours = []
    for s, ((direction, _), reached) in enumerate(
        zip(lit.suns, lit.light, strict=True)
    ):
        cos_theta = min(max(-dot(wo, direction), -1.0), 1.0)
        p = phase(medium.phase, medium.g, cos_theta)
        color = []
        for c in range(3):
            sent = medium.albedo[c] * p * reached[k][c]
            if rules.scattering == "man2003":  # g* = a tau p Omega I / (4 pi)
                tau = ball_depth(lit.balls[k], lit.kernel, medium.sigma_t[c], rules)
                sent *= held_tau(tau, medium.albedo[c], rules) / opacity(tau)
                sent *= rules.solid_angle / WHOLE_SPHERE
            color.append(sent + (lit.glow[s][k][c] if lit.glow else 0.0))
        colours.append(color)
    around = zip(medium.albedo, lit.ambient[k], strict=True)
    return [*colours, [albedo * light for albedo, light in around]]


def held_tau(tau: float, albedo: float, rules: Rules) -> float:
    """Give the depth that eq 26 counts: less than tau where it is held (E23)."""
    kappa = coupling_man2003(albedo, 1.5, solid_angle=rules.solid_angle)
    if tau == 0.0:
        return 1.0  # over `opacity` 1: both go to 0 alike
    return handed_on(tau, rules, albedo, 0.0) / kappa if kappa > 0.0 else tau


def opacity(tau: float) -> float:
    """Give 1 - T; 1 at depth 0, where `held_tau` is 1 too."""
    return -math.expm1(-tau) if tau > 0.0 else 1.0
