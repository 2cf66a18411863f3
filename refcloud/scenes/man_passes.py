"""Figures 11 and 12 of paper M: the two passes, seen from the side, on a real cloud.

The sun, the eye and the drawing lie in one plane, so that rays are seen at their true
length. Beside each drawing stands the framebuffer of that pass, with the areas that the
balls cover in it: those that pass 1 reads back, and those that pass 2 draws.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import Camera, axes, project
from refcloud.conventions import WHOLE_SPHERE, Array
from refcloud.drawing import (
    BLACK,
    BLUE,
    GREY,
    ORANGE,
    RED,
    Canvas,
    arrow,
    blank,
    disc,
    image,
    polyline,
    ring,
    words,
)
from refcloud.figure import Figure, enter_figure
from refcloud.image import Picture
from refcloud.lighting import LitMetaballs, eyeward, named
from refcloud.lighting.lightview import light_camera, light_view
from refcloud.lighting.literal_light import carried_literally
from refcloud.metaballs import Metaballs, approximate
from refcloud.optics import ALBEDO_MAN2003, Medium, Sun
from refcloud.scene import View
from refcloud.scenes.demand_plane import flat_alone
from refcloud.scenes.man_net import small_cloud

BALLS, SIDE = 9, 64  # of the cloud; pixels of both framebuffers
DIRECTION = np.array([-0.6, 0.8, 0.0])  # toward the sun, in the plane of the drawing
# The paper's rules; a ball of its tau, 8, hands on nearly all light, and none is dark.
TAU = 2.0
MEDIUM, LOOK = Medium(1.0, ALBEDO_MAN2003), replace(named("man"), tau=TAU)
BRIGHT = 6.0 * WHOLE_SPHERE  # so that balls of that depth show as bright as clouds
SKY = np.array([0.42, 0.58, 0.80])
EYE_AT, FOV_Y = 2.9, 0.72  # reaches of the cloud; radians


@dataclass(frozen=True)
class Side:
    """Where the drawing from the side lies, and how large it is."""

    canvas: Canvas
    middle: Array
    center: tuple[float, float]
    scale: float

    def place(self, point: Array) -> Array:
        """Give the place of a point of the world: z goes away from the reader."""
        x, y = point[0] - self.middle[0], point[1] - self.middle[1]
        x0, y0 = self.center
        return np.array([x0 + self.scale * x, y0 - self.scale * y])


def cloud() -> Metaballs:
    """Fit a few balls to a small cloud."""
    return approximate(small_cloud(), count=BALLS)


def middle_of(balls: Metaballs) -> tuple[Array, float]:
    """Give the middle of the balls, and how far they reach from it."""
    reach = balls.radii[:, None]
    lower, upper = (balls.centers - reach).min(0), (balls.centers + reach).max(0)
    middle = 0.5 * (lower + upper)
    away = np.sqrt(np.square(balls.centers - middle).sum(axis=1)) + balls.radii
    return middle, float(away.max())


def first(view: View) -> Picture:
    """Draw figure 11: light goes from ball to ball, and is read back before each."""
    flat_alone(view)
    canvas, balls = blank(view.width, view.height), cloud()
    middle, reach = middle_of(balls)
    seen = light_view(balls, DIRECTION, SIDE)
    tau = np.full(len(balls), TAU)
    reached, buffer = carried_literally(seen, tau, ALBEDO_MAN2003, LOOK, LOOK.forward)
    side = Side(canvas, middle, (204.0, 0.62 * canvas.height), 116.0 / reach)
    # 1. The light's framebuffer lies across its rays; a ball's area is where it reads.
    camera, _ = light_camera(balls, DIRECTION, SIDE)
    up, half = axes(camera)[1], 0.5 * camera.height_of_view
    start = middle + camera.eye + 0.1 * reach * DIRECTION

    def on_buffer(pixel: float) -> Array:
        return side.place(start + up * half * (1.0 - 2.0 * pixel / SIDE))

    polyline(canvas, [on_buffer(0.0), on_buffer(SIDE)], BLACK, 3.0)
    for k in seen.order:
        ends = seen.y[k] - seen.radius[k], seen.y[k] + seen.radius[k]
        low, high = (on_buffer(float(y)) for y in ends)
        for end, pixel in ((low, ends[0]), (high, ends[1])):
            there = balls.centers[k] + up * half * 2.0 * (seen.y[k] - pixel) / SIDE
            polyline(canvas, [end, side.place(there)], ORANGE, 0.7, share=0.6)
    # 2. The balls, as bright as the light that reaches them, with their order.
    _balls(side, balls, reached, seen.order)
    for k in seen.order[:1]:
        arrow(canvas, on_buffer(float(seen.y[k])), side.place(balls.centers[k]), RED)
    sun = on_buffer(0.5 * SIDE)
    words(canvas, (sun[0] - 6.0, sun[1] - 14.0), "light", size=13, anchor="rm")
    # 3. The framebuffer after the pass, with the areas that were read back.
    text = "the light's framebuffer, and the areas read back"
    _buffer(canvas, buffer.pixels[..., :3], seen.x, seen.y, seen.radius, text)
    words(canvas, (195.0, canvas.height - 16.0), "near to far", anchor="mm")
    note = (
        f"pass 1: {len(balls)} balls, the darkest gets {reached.min():.2f} of the light"
    )
    return canvas.picture(note)


def second(view: View) -> Picture:
    """Draw figure 12: balls shine toward the eye, and are drawn from far to near."""
    flat_alone(view)
    canvas, balls = blank(view.width, view.height), cloud()
    middle, reach = middle_of(balls)
    seen = light_view(balls, DIRECTION, SIDE)
    tau = np.full(len(balls), TAU)
    reached, _ = carried_literally(seen, tau, ALBEDO_MAN2003, LOOK, LOOK.forward)
    sun = Sun(DIRECTION, np.full(3, BRIGHT))
    lit = LitMetaballs(
        balls,
        (sun,),
        reached[None, :, None] * sun.irradiance,
        np.zeros((len(balls), 3)),
        MEDIUM,
        LOOK,
        (),
    )
    eye = middle + EYE_AT * reach * np.array([-math.cos(0.15), -math.sin(0.15), 0.0])
    camera = Camera(eye, middle, fov_y=FOV_Y, width=SIDE, height=SIDE)
    behind = np.broadcast_to(SKY, (SIDE, SIDE, 3))
    rgba, _ = eyeward(lit, camera, background=behind)
    x, y, depth, scale = project(camera, balls.centers)
    order = np.argsort(-depth, kind="stable")
    side = Side(canvas, middle, (258.0, 0.5 * canvas.height), 84.0 / reach)
    # 1. The picture plane before the eye, and a ray to each ball through its pixel.
    _, up, back = axes(camera)
    plane = eye - 0.9 * reach * back
    half = 0.9 * reach * math.tan(0.5 * FOV_Y)
    ends = [side.place(plane + sign * half * up) for sign in (1.0, -1.0)]
    polyline(canvas, ends, BLACK, 3.0)
    for k in order:
        through = plane + up * half * (1.0 - 2.0 * float(y[k]) / SIDE)
        path = [side.place(p) for p in (eye, through, balls.centers[k])]
        polyline(canvas, path, BLUE, 0.8, share=0.7)
    _balls(side, balls, reached, order)
    # 2. Where the light comes from, and who looks.
    tip = middle + 1.2 * reach * DIRECTION
    arrow(
        canvas, side.place(tip + 0.5 * reach * DIRECTION), side.place(tip), ORANGE, 2.0
    )
    at = side.place(eye)
    disc(canvas, at, 5.0, BLACK)
    words(canvas, (at[0] + 2.0, at[1] + 18.0), "eye", size=13, anchor="mm")
    # 3. The picture, with the area of each ball.
    text = "the picture, and the area of each ball"
    _buffer(canvas, rgba[..., :3], x, y, balls.radii * scale, text)
    words(canvas, (262.0, canvas.height - 16.0), "far to near", anchor="mm")
    return canvas.picture(f"pass 2: {len(balls)} balls, from far to near")


def _balls(side: Side, balls: Metaballs, light: Array, order: NDArray[np.intp]) -> None:
    """Draw the balls from back to front, each with its place in the order."""
    turn = {int(k): number for number, k in enumerate(order, 1)}
    for k in np.argsort(balls.centers[:, 2], kind="stable"):
        place, radius = side.place(balls.centers[k]), float(balls.radii[k] * side.scale)
        disc(side.canvas, place, radius, np.full(3, 0.9 * float(light[k])), share=0.55)
        ring(side.canvas, place, radius, BLACK, 1.0)
    for k in range(len(balls)):
        place = side.place(balls.centers[k])
        words(side.canvas, place, str(turn[k]), RED, size=13, anchor="mm")


def _buffer(
    canvas: Canvas, light: Array, x: Array, y: Array, radius: Array, text: str
) -> None:
    """Lay a framebuffer into the right of the drawing, with the balls' areas on it."""
    edge = 236.0
    left, top = 640.0 - edge - 10.0, 0.5 * (canvas.height - edge)
    image(canvas, light, (left, top), (left + edge, top + edge))
    pixel = edge / SIDE
    for k in range(len(x)):
        place = left + pixel * float(x[k]), top + pixel * float(y[k])
        ring(canvas, place, pixel * float(radius[k]), GREY, 1.0, share=0.8)
        disc(canvas, place, 1.8, RED)
    words(canvas, (left + 0.5 * edge, top - 12.0), text, size=9, anchor="mm")


for name, number, title, draw in (
    ("man-11", "figure 11", "the first pass, from the light", first),
    ("man-12", "figure 12", "the second pass, toward the eye", second),
):
    enter_figure(Figure(name, number, title, draw))
