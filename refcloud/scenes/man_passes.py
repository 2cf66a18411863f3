"""Figures 11 and 12 of paper M: the two passes, seen from the side, on a real cloud.

The sun, the eye and the drawing lie in one plane, so that rays are seen at their true
length. Beside each drawing stands the framebuffer of that pass: in its middle, with the
area of the ball whose turn it is, and after it with the areas of all. Pass 1 reads an
area back before it draws a ball there, pass 2 only draws.
"""

from __future__ import annotations

import itertools
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
    WHITE,
    Canvas,
    arrow,
    blank,
    box,
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
TURN = 5  # whose turn it is where a framebuffer is shown in the middle of a pass
DIRECTION = np.array([-0.6, 0.8, 0.0])  # toward the sun, in the plane of the drawing
# The paper's rules; a ball of its tau, 8, hands on nearly all light, and none is dark.
TAU = 2.0
MEDIUM, LOOK = Medium(1.0, ALBEDO_MAN2003), replace(named("man"), tau=TAU)
BRIGHT = 6.0 * WHOLE_SPHERE  # so that balls of that depth show as bright as clouds
SKY = np.array([0.42, 0.58, 0.80])
EYE_AT, FOV_Y = 2.1, 0.84  # reaches of the cloud; radians
NUMBER = 15.0  # units between the numbers of balls, at least
# The drawing from the side lies left, both framebuffers right, all around the middle.
LEFT, RIGHT, EDGE = 206.0, 533.0, 196.0
SAID = f"tau is {TAU:g} for each ball; the paper's 8 would hand on nearly all light"


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
    how = tau, ALBEDO_MAN2003, LOOK, LOOK.forward
    reached, buffer = carried_literally(seen, *how)
    scale = 150.0 / reach
    side = Side(canvas, middle, (LEFT + 44.0, 0.5 * canvas.height + 62.0), scale)
    # 1. The light's framebuffer lies across its rays; a ball's area is where it reads.
    camera, _ = light_camera(balls, DIRECTION, SIDE)
    up, half = axes(camera)[1], 0.5 * camera.height_of_view
    start = middle + camera.eye + 0.1 * reach * DIRECTION

    def on_buffer(pixel: float) -> Array:
        return side.place(start + up * half * (1.0 - 2.0 * pixel / SIDE))

    polyline(canvas, [on_buffer(0.0), on_buffer(SIDE)], BLACK, 3.0)
    for k in seen.order:
        mine = k == seen.order[TURN - 1]
        ink, wide = (RED, 1.6) if mine else (ORANGE, 0.7)
        for pixel in (seen.y[k] - seen.radius[k], seen.y[k] + seen.radius[k]):
            there = balls.centers[k] + up * half * 2.0 * (seen.y[k] - pixel) / SIDE
            ends = [on_buffer(float(pixel)), side.place(there)]
            polyline(canvas, ends, ink, wide, share=1.0 if mine else 0.6)
    # 2. The balls, as bright as the light that reaches them, with their order.
    _balls(side, balls, reached, seen.order)
    # 3. Where the light comes from.
    sun = on_buffer(0.5 * SIDE) - np.array([0.0, 6.0])
    away = side.scale * 0.34 * reach * np.array([DIRECTION[0], -DIRECTION[1]])
    arrow(canvas, sun + away, sun, ORANGE, 2.5)
    words(canvas, (*(sun + away - [0.0, 12.0]),), "light", size=14, anchor="mm")
    # 4. The framebuffer in the middle of the pass, and after it.
    before = replace(seen, order=seen.order[: TURN - 1])
    half_way = carried_literally(before, *how)[1].pixels[..., :3]
    areas = seen.x, seen.y, seen.radius
    share = reached[seen.order[TURN - 1]]
    _buffers(
        canvas,
        half_way,
        f"ball {TURN} reads a mean of {share:.2f}",
        buffer.pixels[..., :3],
        f"after ball {len(balls)}: every area read",
        *areas,
        seen.order,
    )
    _said(canvas, "pass 1, near to far: read back, draw, next ball")
    note = (
        f"pass 1: {len(balls)} balls, the darkest gets {reached.min():.2f} of the light"
    )
    return canvas.picture(note, SAID)


def second(view: View) -> Picture:
    """Draw figure 12: balls shine toward the eye, and are drawn from far to near."""
    flat_alone(view)
    canvas, balls = blank(view.width, view.height), cloud()
    middle, reach = middle_of(balls)
    seen = light_view(balls, DIRECTION, SIDE)
    tau = np.full(len(balls), TAU)
    reached, _ = carried_literally(seen, tau, ALBEDO_MAN2003, LOOK, LOOK.forward)
    eye = middle + EYE_AT * reach * np.array([-math.cos(0.15), -math.sin(0.15), 0.0])
    camera = Camera(eye, middle, fov_y=FOV_Y, width=SIDE, height=SIDE)
    x, y, depth, size = project(camera, balls.centers)
    order = np.argsort(-depth, kind="stable")
    scale = 128.0 / reach
    side = Side(canvas, middle, (LEFT + 80.0, 0.5 * canvas.height + 14.0), scale)
    # 1. The picture plane before the eye, and a ray to each ball through its pixel.
    _, up, back = axes(camera)
    plane = eye - 0.8 * reach * back
    half = 0.8 * reach * math.tan(0.5 * FOV_Y)
    ends = [side.place(plane + sign * half * up) for sign in (1.0, -1.0)]
    polyline(canvas, ends, BLACK, 3.0)
    for k in order:
        ink, wide = (RED, 1.6) if k == order[TURN - 1] else (BLUE, 0.8)
        through = plane + up * half * (1.0 - 2.0 * float(y[k]) / SIDE)
        path = [side.place(p) for p in (eye, through, balls.centers[k])]
        polyline(canvas, path, ink, wide, share=0.8)
    _balls(side, balls, reached, order)
    # 2. Where the light comes from, and who looks.
    tip = side.place(middle + 1.1 * reach * DIRECTION)
    away = side.scale * 0.4 * reach * np.array([DIRECTION[0], -DIRECTION[1]])
    arrow(canvas, tip + away, tip, ORANGE, 2.5)
    words(canvas, (*(tip + away - [0.0, 12.0]),), "light", size=14, anchor="mm")
    at = side.place(eye)
    disc(canvas, at, 5.0, BLACK)
    words(canvas, (at[0] + 2.0, at[1] + 18.0), "eye", size=14, anchor="mm")
    # 3. The picture with the farthest balls, and with all.
    half_way = _seen(balls, reached, camera, order[: TURN - 1])
    areas = x, y, balls.radii * size
    _buffers(
        canvas,
        half_way,
        f"ball {TURN} is drawn over {TURN - 1} farther ones",
        _seen(balls, reached, camera, order),
        f"after ball {len(balls)}: the picture",
        *areas,
        order,
    )
    _said(canvas, "pass 2, far to near: each ball shines toward the eye")
    return canvas.picture(f"pass 2: {len(balls)} balls, from far to near", SAID)


def _seen(
    balls: Metaballs, reached: Array, camera: Camera, chosen: NDArray[np.intp]
) -> Array:
    """Draw some of the balls before the sky, each lit as the whole cloud lights it."""
    some = Metaballs(
        balls.centers[chosen],
        balls.radii[chosen],
        balls.densities[chosen],
        balls.kernel,
    )
    sun = Sun(DIRECTION, np.full(3, BRIGHT))
    light = reached[chosen][None, :, None] * sun.irradiance
    dark = np.zeros((len(some), 3))
    lit = LitMetaballs(some, (sun,), light, dark, MEDIUM, LOOK, ())
    behind = np.broadcast_to(SKY, (SIDE, SIDE, 3))
    return eyeward(lit, camera, background=behind)[0][..., :3]


def _balls(side: Side, balls: Metaballs, light: Array, order: NDArray[np.intp]) -> None:
    """Draw the balls from back to front, each with its place in the order."""
    for k in np.argsort(balls.centers[:, 2], kind="stable"):
        place, radius = side.place(balls.centers[k]), float(balls.radii[k] * side.scale)
        disc(side.canvas, place, radius, np.full(3, 0.9 * float(light[k])), share=0.55)
        ring(side.canvas, place, radius, BLACK, 1.0)
    places = _apart(np.array([side.place(balls.centers[k]) for k in order]))
    for number, place in enumerate(places, 1):
        mine = number == TURN
        disc(side.canvas, place, 0.5 * NUMBER, WHITE, share=0.85)
        ink = RED if mine else BLACK
        words(side.canvas, place, str(number), ink, size=13, anchor="mm")


def _apart(places: Array) -> Array:
    """Push places apart until none is nearer to another than a number is wide."""
    places = places.copy()
    for _ in range(60):
        for i, j in itertools.combinations(range(len(places)), 2):
            way = places[j] - places[i]
            far = float(np.hypot(*way))
            if far < NUMBER:
                push = way / far if far > 0.0 else np.array([1.0, 0.0])
                places[i] -= 0.5 * (NUMBER - far) * push
                places[j] += 0.5 * (NUMBER - far) * push
    return places


def _buffers(
    canvas: Canvas,
    half_way: Array,
    above: str,
    after: Array,
    below: str,
    x: Array,
    y: Array,
    radius: Array,
    order: NDArray[np.intp],
) -> None:
    """Lay two framebuffers into the right of the drawing, with the balls' areas."""
    left, pixel = RIGHT - 0.5 * EDGE, EDGE / SIDE
    for light, text, down, shown in (
        (half_way, above, -EDGE - 14.0, order[TURN - 1 : TURN]),
        (after, below, 30.0, order),
    ):
        top = 0.5 * canvas.height + down
        lower, upper = (left, top), (left + EDGE, top + EDGE)
        image(canvas, light, lower, upper)
        box(canvas, lower, upper, GREY, 1.0)
        for k in shown:
            ink, wide = (RED, 2.0) if k == order[TURN - 1] else (GREY, 1.0)
            place = left + pixel * float(x[k]), top + pixel * float(y[k])
            ring(canvas, place, pixel * float(radius[k]), ink, wide, share=0.9)
        words(canvas, (RIGHT, top - 10.0), text, size=11, anchor="mm")


def _said(canvas: Canvas, text: str) -> None:
    """Write below the drawing what the pass does, and at which depth."""
    low = 0.5 * canvas.height + 208.0
    words(canvas, (LEFT, low), text, size=13, anchor="mm")
    words(canvas, (LEFT, low + 18.0), SAID, size=10, anchor="mm")


for name, number, title, draw in (
    ("man-11", "figure 11", "the first pass, from the light", first),
    ("man-12", "figure 12", "the second pass, toward the eye", second),
):
    enter_figure(Figure(name, number, title, draw))
