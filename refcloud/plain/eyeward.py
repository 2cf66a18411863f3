"""Pass 2, one ball and one pixel at a time, with the extensions of the look "cumulus".

Each function is the twin of the one of the same name in `refcloud.lighting`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

from refcloud.plain.camera import Camera, Point, along, axes, project
from refcloud.plain.cloudmap import corners
from refcloud.plain.erosion import Detail, eroded, lit_share, noise_at
from refcloud.plain.lighting import (
    Colour,
    Lit,
    ball_colours,
    ball_depth,
    depth_order,
)
from refcloud.plain.metaballs import Ball, profile
from refcloud.plain.raster import footprint, patch, transmittance


class Field(NamedTuple):
    """Sums of weight times value, and of the weights last: [z][y][x][channel]."""

    sums: Sequence[Sequence[Sequence[Sequence[float]]]]
    lower: Point
    spacing: float


class Fixed(NamedTuple):
    """Numbers that the rooms fix: see their constants of these names."""

    soft: float
    front: float
    rise: float
    own: float
    spacing: float
    most_nodes: int


class Scene(NamedTuple):
    """What all pixels share: the lit balls, the eye, the air, and the two tables."""

    lit: Lit
    camera: Camera
    haze: tuple[Colour, float] | None  # its colour and its length
    detail: Detail | None
    field: Field | None
    step: float  # toward a sun, over which the noise's rise is taken
    fixed: Fixed


def light_field(
    balls: Sequence[Ball],
    values: Sequence[Sequence[float]],
    *,
    kernel: str,
    reach: float,
    spacing: float,
    most_nodes: int,
) -> Field:
    """Sum the balls' values, weighted by their densities, at the nodes of a table."""
    channels = len(values[0]) + 1 if values else 1
    largest = max((density for _, _, density in balls), default=0.0)
    if not largest > 0.0:
        return Field([[[[0.0] * channels]]], (0.0, 0.0, 0.0), 1.0)
    step = spacing * median([radius for _, radius, _ in balls])
    lower = [min(c[a] - reach * radius for c, radius, _ in balls) for a in range(3)]
    upper = [max(c[a] + reach * radius for c, radius, _ in balls) for a in range(3)]
    edges = [b - a for a, b in zip(lower, upper, strict=True)]
    while math.prod(math.ceil(e / step) + 1.0 for e in edges) > most_nodes:
        step *= 2.0
    W, H, D = (math.ceil(e / step) + 1 for e in edges)

    def node(i: int, j: int, k: int) -> list[float]:
        place = [a + n * step for a, n in zip(lower, (i, j, k), strict=True)]
        sums = [0.0] * channels
        for (center, radius, density), value in zip(balls, values, strict=True):
            far = math.dist(place, center) / (reach * radius)
            weight = density / largest * profile(far**2, kernel)
            for channel, v in enumerate((*value, 1.0)):
                sums[channel] += weight * v
        return sums

    sums = [[[node(i, j, k) for i in range(W)] for j in range(H)] for k in range(D)]
    return Field(sums, (lower[0], lower[1], lower[2]), step)


def median(values: Sequence[float]) -> float:
    """Give the middle value, or the mean of the two in the middle."""
    ranked = sorted(values)
    return (ranked[(len(ranked) - 1) // 2] + ranked[len(ranked) // 2]) / 2.0


def field_value(
    field: Field, point: Point, *, own: Sequence[float], own_weight: float
) -> list[float]:
    """Read a light field at one point as one ball sees it."""
    at = [(p - a) / field.spacing for p, a in zip(point, field.lower, strict=True)]
    nodes = field.sums
    counts = len(nodes[0][0]), len(nodes[0]), len(nodes)
    sums = [own_weight * v for v in (*own, 1.0)]
    for i, j, k, weight in corners(counts, at):
        for channel, value in enumerate(nodes[k][j][i]):
            sums[channel] += weight * value
    return [value / sums[-1] for value in sums[:-1]]


def fade(depth: float, radius: float) -> float:
    """Let a ball fade in as the eye leaves it."""
    near = min(max(depth / radius, 0.0), 1.0)
    return near * near * (3.0 - 2.0 * near)


def shown_color(scene: Scene, place: Point, own: Sequence[Colour]) -> list[float]:
    """Give a ball's colour at one place: ambient light and every sun's, in relief."""
    lit, detail = scene.lit, scene.detail
    light = [channel for color in own for channel in color]
    if scene.field is not None:
        light = field_value(scene.field, place, own=light, own_weight=scene.fixed.own)
    color = light[-3:]
    for s, (direction, _) in enumerate(lit.suns):
        share = 1.0
        if detail is not None:
            noise = noise_at(detail, place)
            ahead = noise_at(detail, along(place, (scene.step, direction)))
            share = lit_share(noise, ahead, relief=lit.rules.relief)
        for c in range(3):
            color[c] += share * light[3 * s + c]
    return color


def draw(
    pixels: list[list[list[float]]], scene: Scene, k: int, own: Sequence[Colour]
) -> None:
    """Blend one ball over what lies behind it: c = g* + T c at every pixel (eq 28)."""
    lit, camera, haze = scene.lit, scene.camera, scene.haze
    (cx, cy, cz), R, _ = lit.balls[k]
    x, y, depth, scale = project(camera, (cx, cy, cz))
    if not scale > 0.0:
        return
    rules, radius = lit.rules, R * scale
    thickness = [
        ball_depth(lit.balls[k], lit.kernel, sigma_t, rules)
        * (fade(depth, R) * rules.erosion_depth)
        for sigma_t in lit.medium.sigma_t
    ]
    clear = (
        1.0
        if haze is None
        else math.exp(-math.dist(camera.eye, (cx, cy, cz)) / haze[1])
    )
    right, up, back = axes(camera)
    for row, column, q in patch(x, y, radius, camera.width, camera.height):
        # The place that the pixel shows lies between middle plane and front.
        steps = (column + 0.5 - x) / radius * R, (y - row - 0.5) / radius * R
        front = scene.fixed.front * math.sqrt(max(1.0 - q, 0.0)) * R
        place = along((cx, cy, cz), (steps[0], right), (steps[1], up), (front, back))
        weight = footprint(q, lit.kernel, rules.footprint)
        if scene.detail is not None:
            noise = noise_at(scene.detail, place)
            weight = eroded(weight, noise, erosion=rules.erosion, soft=scene.fixed.soft)
        color = shown_color(scene, place, own)
        pixel = pixels[row][column]
        for c in range(3):
            air = 0.0 if haze is None else haze[0][c] * (1.0 - clear)
            T = transmittance(weight, thickness[c], rules.transmittance)
            pixel[c] = (color[c] * clear + air) * (1.0 - T) + T * pixel[c]
            pixel[3 + c] = (1.0 - T) + T * pixel[3 + c]


def eyeward(
    lit: Lit,
    camera: Camera,
    *,
    background: Sequence[Sequence[Colour]] | None,
    haze: tuple[Colour, float] | None,
    detail: Detail | None,
    fixed: Fixed,
) -> list[list[list[float]]]:
    """Draw the balls far to near over the background (eq 29): RGBA pixels."""
    balls, rules = lit.balls, lit.rules
    # Three colours, and an alpha for each of them.
    pixels = [[[0.0] * 6 for _ in range(camera.width)] for _ in range(camera.height)]
    if background is not None:
        pixels = [[[*color, 1.0, 1.0, 1.0] for color in row] for row in background]
    colours = [ball_colours(lit, k, camera) for k in range(len(balls))]
    field, step = None, 0.0
    if balls:
        step = fixed.rise * rules.erosion_cell * median([r for _, r, _ in balls])
    if balls and rules.light_reach > 0.0:
        field = light_field(
            balls,
            [[channel for color in own for channel in color] for own in colours],
            kernel=lit.kernel,
            reach=rules.light_reach,
            spacing=fixed.spacing,
            most_nodes=fixed.most_nodes,
        )
    scene = Scene(lit, camera, haze, detail, field, step, fixed)
    depths = [project(camera, (c[0], c[1], c[2]))[2] for c, _, _ in balls]
    for k in reversed(depth_order(balls, depths)):
        draw(pixels, scene, k, colours[k])
    return [[[*color[:3], sum(color[3:]) / 3.0] for color in row] for row in pixels]
