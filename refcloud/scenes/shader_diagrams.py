"""Figures 1 and 2 of document S: how simplex noise finds its corners, and a light path.

Figure 1 asks the function that the noise itself uses for the corners around one place:
left the plane with its triangles, right the same after the skew, where each two of them
fill a square. Figure 2 is a cut through the layer of the scene ``shader-lit``, with the
samples that its march takes from the document's blue dot toward the sun.
"""

from __future__ import annotations

import math

import numpy as np

from refcloud.conventions import Array
from refcloud.drawing import (
    BLACK,
    BLUE,
    GREY,
    ORANGE,
    RED,
    WHITE,
    Canvas,
    arrow,
    axes_in,
    blank,
    curve,
    disc,
    image,
    polyline,
    ring,
    words,
)
from refcloud.figure import Figure, enter_figure
from refcloud.image import Picture
from refcloud.noise.simplex_corners import SQUARED, _corners, _skews
from refcloud.scene import View
from refcloud.scenes.demand_plane import flat_alone
from refcloud.scenes.shader_eyes import SUN
from refcloud.scenes.shader_light import LIT, noise_of
from refcloud.sky import base_density, light_from_above

PLACE = np.array([0.98, 0.60])  # whose simplex figure 1 looks for
UNIT = 104.0  # units of the drawing to one of the plane
LINES, LONG = range(-3, 6), 12  # of the lattice, as far as they are drawn
TINT = np.array([0.60, 0.76, 0.92])

LAYER = LIT.layer

# The cut of figure 2: along the sun's own direction on the ground, from this place on.
ALONG, WIDE, EYE_BEHIND = 1.0, 2.4, 0.95  # scene units
BEYOND = 0.16  # of the layer's top, where the sun's arrow begins
SCALE = 250.0  # units of the drawing to a scene unit, upward as across
COLUMNS, ROWS = 480, 100  # of the picture of densities
CLEAR, DENSE = np.array([0.52, 0.66, 0.86]), np.array([0.97, 0.97, 0.97])


def corners_of(place: Array) -> tuple[Array, Array]:
    """Ask the noise for the corners around a place, in the order that it visits them.

    Parameters
    ----------
    place
        Coordinates, shape (N,).

    Returns
    -------
    The corners in the plane or space, and on the skewed lattice: shapes (N + 1, N).
    """
    columns = [np.array([x]) for x in place]
    visited = _corners(columns, 0, "continuous", "mixed", "float64")
    found = np.array([place - offset[:, 0] for offset, _, _ in visited])
    lattice = found + _skews(len(place))[0] * found.sum(axis=1, keepdims=True)
    return found, np.rint(lattice)


def simplices(view: View) -> Picture:
    """Draw figure 1: the plane's triangles, and the squares that skewing makes."""
    flat_alone(view)
    canvas = blank(view.width, view.height)
    _, lattice = corners_of(PLACE)
    skew, back = _skews(2)
    skewed = PLACE + skew * PLACE.sum()
    low = 0.5 * canvas.height + 84.0
    panels = (
        (np.array([60.0, low]), lambda at: at - back * at.sum(axis=-1, keepdims=True)),
        (np.array([386.0, low]), lambda at: at),
    )
    for number, (origin, shape) in enumerate(panels):
        left, right = 320.0 * number + 14.0, 320.0 * number + 306.0
        top, bottom = 0.5 * canvas.height - 166.0, 0.5 * canvas.height + 140.0
        sheet = blank(canvas.light.shape[1], canvas.light.shape[0])

        def put(at: Array, origin: Array = origin, shape=shape) -> Array:
            return origin + UNIT * shape(np.asarray(at, np.float64)) * [1.0, -1.0]

        # 1. The square of the skewed lattice that holds the place, and the simplex.
        cell = lattice[0] + np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
        _filled(sheet, put(cell), 0.45 * TINT + 0.55)
        _filled(sheet, put(lattice), TINT)
        # 2. The lattice: two lines of squares, and the diagonal that halves them.
        for k in LINES:
            for step in ((0, 1), (1, 0), (1, 1)):
                starts = {(0, 1): (k, -3), (1, 0): (-3, k), (1, 1): (k - 3, -3 - k)}
                ends = starts[step] + np.array(step) * np.array([[0], [LONG]])
                polyline(sheet, put(ends), GREY, 0.8)
        # 3. The corners in their order, how far each reaches, and the place.
        radius = UNIT * math.sqrt(SQUARED["continuous"])
        order = put(lattice)
        for i in range(len(order) - 1):
            way = (order[i + 1] - order[i]) / np.hypot(*(order[i + 1] - order[i]))
            arrow(sheet, order[i], order[i + 1] - 10.0 * way, BLUE, 2.2)
        for k, corner in enumerate(order):
            if number == 0:
                ring(sheet, corner, radius, ORANGE, 1.0)
            disc(sheet, corner, 9.0, WHITE)
            ring(sheet, corner, 9.0, BLUE, 1.5)
            words(sheet, corner, str(k), BLUE, size=12, anchor="mm")
        place = put(skewed)
        disc(sheet, place, 4.0, RED)
        words(sheet, (place[0] + 7.0, place[1] - 9.0), "P", RED, size=14)
        _window(canvas, sheet, (left, top, right, bottom))
    relative = skewed - lattice[0]
    middle = 0.5 * canvas.height
    for x, text in ((160.0, "the plane"), (480.0, "skewed: x + F (x + y), F = 0.366")):
        words(canvas, (x, middle - 184.0), text, size=13, anchor="mm")
    sign = ">" if relative[0] >= relative[1] else "<"
    first = "x" if relative[0] >= relative[1] else "y"
    lines = (
        f"whole part of the skewed place: the square ({lattice[0, 0]:.0f},"
        f" {lattice[0, 1]:.0f}); the rest is {relative[0]:.2f} {sign}"
        f" {relative[1]:.2f}, so the first step is along {first}",
        "corners 0, 1, 2 alone are summed; each reaches to the far side of its"
        " triangles, r^2 = 1/2",
    )
    for k, line in enumerate(lines):
        words(canvas, (320.0, middle + 162.0 + 20.0 * k), line, size=11, anchor="mm")
    return canvas.picture(lines[0])


def _filled(canvas: Canvas, corners: Array, color: Array) -> None:
    """Fill a convex polygon, given its corners in turn."""
    H, W, _ = canvas.light.shape
    x, y = (np.arange(W) + 0.5) / canvas.scale, (np.arange(H) + 0.5) / canvas.scale
    sides = [
        (b[0] - a[0]) * (y[:, None] - a[1]) - (b[1] - a[1]) * (x - a[0])
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)
    ]
    inside = np.all([s >= 0.0 for s in sides], axis=0)
    inside |= np.all([s <= 0.0 for s in sides], axis=0)
    canvas.light[inside] = color


def _window(
    canvas: Canvas, sheet: Canvas, frame: tuple[float, float, float, float]
) -> None:
    """Lay a part of one drawing over another."""
    left, top, right, bottom = (max(round(canvas.scale * v), 0) for v in frame)
    canvas.light[top:bottom, left:right] = sheet.light[top:bottom, left:right]


def light_path(view: View) -> Picture:
    """Draw figure 2: a cut through the layer, and the samples on the way to the sun."""
    flat_alone(view)
    canvas = blank(view.width, view.height)
    pattern, _ = noise_of(view, direct=True)
    toward = SUN.direction
    ground = toward[[0, 2]] / math.hypot(toward[0], toward[2])
    rise = toward[1] / math.hypot(toward[0], toward[2])

    def over(s: Array) -> Array:
        return np.asarray(pattern((ALONG + s)[:, None] * ground), np.float64)

    # 1. The layer: density at every place of the cut.
    s: Array = np.asarray((np.arange(COLUMNS) + 0.5) / COLUMNS * WIDE, np.float64)
    height = (ROWS - 0.5 - np.arange(ROWS)) / ROWS * LAYER.thickness
    density = base_density(over(s), height[:, None], LAYER)
    base, left = 0.5 * canvas.height - 44.0, 20.0
    top = base - SCALE * LAYER.thickness

    def put(s: float, y: float) -> tuple[float, float]:
        return left + SCALE * s, base - SCALE * y

    share = density[..., None] ** 0.5
    image(
        canvas, CLEAR + share * (DENSE - CLEAR), put(0.0, LAYER.thickness), put(WIDE, 0)
    )
    polyline(canvas, [put(0.0, 0.0), put(WIDE, 0.0)], BLACK, 1.5)
    # 2. The blue dot: where the path toward the sun is darkest.
    reached = light_from_above(
        (ALONG + s)[:, None] * ground, pattern, LAYER, sun=toward
    )
    end = LAYER.thickness / rise  # the way's length on the ground
    inner = (s > EYE_BEHIND) & (s < WIDE - end - BEYOND)
    blue = float(s[inner][np.argmin(reached[inner])])
    # 3. The samples, evenly spaced, as the march takes them.
    T = float(reached[inner].min())
    step = LAYER.thickness / toward[1] / LAYER.steps
    far = (np.arange(LAYER.steps) + 0.5) * step
    at = blue + far * math.hypot(toward[0], toward[2])
    up = far * toward[1]
    taken = base_density(over(at), up, LAYER)
    last = int(np.flatnonzero(taken > 0.0).max(initial=0))
    red = put(at[last] + 0.5 * (at[1] - at[0]), up[last] + 0.5 * (up[1] - up[0]))
    eye = put(blue - EYE_BEHIND, -0.9)
    sun = put(blue + end + BEYOND, LAYER.thickness + BEYOND * rise)
    arrow(canvas, sun, red, ORANGE, 2.0)
    polyline(canvas, [red, put(blue, 0.0)], ORANGE, 1.4)
    arrow(canvas, put(blue, 0.0), put(blue - 0.97 * EYE_BEHIND, -0.873), BLUE, 2.0)
    for x, y, rho in zip(at, up, taken, strict=True):
        disc(canvas, put(x, y), 4.0, BLACK)
        disc(canvas, put(x, y), 3.0, np.full(3, 1.0 - float(rho)))
    disc(canvas, red, 6.0, RED)
    disc(canvas, put(blue, 0.0), 6.0, BLUE)
    disc(canvas, eye, 5.0, BLACK)
    words(canvas, (eye[0] + 10.0, eye[1] + 4.0), "eye", size=13)
    words(canvas, (sun[0] - 8.0, sun[1] - 2.0), "sun", size=13, anchor="rm")
    words(canvas, (left, top - 12.0), "density of the layer, flat below", size=12)
    x, y = put(blue, 0.0)
    words(canvas, (x + 6.0, y + 15.0), "bottom point", BLUE, size=12)
    words(canvas, (red[0] + 10.0, red[1]), "exit", RED, size=12, halo=WHITE)
    # 4. What the march adds up.
    _sums(canvas, far, taken, T)
    note = f"{LAYER.steps} samples from the bottom point, {T:.3f} of the light arrives"
    return canvas.picture(note, "the bottom point with the least light of this cut")


def _sums(canvas: Canvas, far: Array, taken: Array, T: float) -> None:
    """Plot density at the samples, and how much light is left from there down."""
    low = 0.5 * canvas.height + 6.0
    cell = (300.0, low, 632.0, 0.5 * canvas.height + 226.0)
    step = float(far[1] - far[0])
    axes = axes_in(
        canvas,
        cell,
        (0.0, float(far[-1]) + 0.5 * step),
        (0.0, 1.05),
        ticks_x=(0.0, 0.2, 0.4, 0.6, 0.8),
        ticks_y=(0, 0.5, 1),
        title="density, and the light that is left (orange)",
        below="way from the bottom point toward the sun",
    )
    polyline(canvas, axes.place(far, taken), GREY, 1.0)
    for place, rho in zip(axes.place(far, taken), taken, strict=True):
        disc(canvas, place, 4.0, BLACK)
        disc(canvas, place, 3.0, np.full(3, 1.0 - float(rho)))
    # Light comes in at the far end: what lies beyond a place has dimmed it.
    beyond = np.concatenate([[0.0], np.cumsum(taken[::-1])])[::-1] * step
    ends = np.arange(len(far) + 1) * step
    curve(axes, ends, np.exp(-LAYER.sigma_t * beyond), ORANGE, 2.0)
    place = axes.place(0.0, T)
    disc(canvas, place, 5.0, BLUE)
    words(canvas, (place[0] + 12.0, place[1] + 8.0), f"T = {T:.3f}", BLUE, size=12)


for name, number, title, draw in (
    ("shader-01", "figure 1", "skewing the plane and picking a simplex", simplices),
    ("shader-02", "figure 2", "the light path through a layer", light_path),
):
    enter_figure(Figure(name, number, title, draw))
