"""The figures of paper M that are plots: octaves, interpolants, the two bases.

Each curve is drawn by the function that the rest of refcloud uses. Figure 1, the
result, is the scene ``cumulus``.
"""

from __future__ import annotations

import numpy as np

from refcloud import noise
from refcloud.conventions import Array
from refcloud.drawing import (
    BLUE,
    GREY,
    RED,
    Axes,
    Canvas,
    axes_in,
    blank,
    curve,
    disc,
    grid_of,
    image,
    words,
)
from refcloud.figure import Drawn, Figure, enter_figure
from refcloud.image import Picture
from refcloud.metaballs import gaussian, wyvill
from refcloud.noise_pictures import noise_picture
from refcloud.scene import SCENES, View
from refcloud.scenes.demand_plane import flat_alone

OCTAVES, PERSISTENCE = 4, 0.5  # Z and s of figure 2
CELLS = 8  # lattice points along figure 3
ROW, SEEN = 5.0, 9.0  # y and z of the lattice line that figure 3 shows
SIGMA = 0.6  # of figure 5
FINE = 241  # places of a curve


def octaves(view: View) -> Picture:
    """Draw figure 2: the octaves of the noise, and their sums so far."""
    flat_alone(view)
    canvas = blank(view.width, view.height)
    side = max(min(view.width // OCTAVES, view.height // 3), 8)
    rows = noise_picture("man", size=side, octaves=OCTAVES, view="octaves", cells=4)
    gap = rows.linear.shape[0] - 2 * side
    edge = min(640.0 / OCTAVES - 10.0, 0.5 * canvas.height - 34.0)
    first = 0.5 * canvas.height - edge - 34.0
    for cell in range(2 * OCTAVES):
        column, row = cell % OCTAVES, cell // OCTAVES
        x, y = column * (side + gap), row * (side + gap)
        panel = rows.linear[y : y + side, x : x + side]
        middle, top = (column + 0.5) * 640.0 / OCTAVES, first + row * (edge + 34.0)
        upper = middle - 0.5 * edge, top + 28.0
        image(canvas, panel, upper, (upper[0] + edge, upper[1] + edge))
        size = f"{PERSISTENCE**column:g}"
        text = f"octave {column}, times {size}" if row == 0 else f"sum of {column + 1}"
        words(canvas, (middle, top + 16.0), text, anchor="mm")
    return canvas.picture()


def interpolants(view: View) -> Picture:
    """Draw figure 3: linear, cosine, cubic, and the noise beside its smoothing."""
    flat_alone(view)
    canvas = blank(view.width, view.height)
    knots = np.arange(-1, CELLS + 2)
    v = np.asarray(noise.man2003(knots, np.array(int(ROW)), np.array(int(SEEN))))
    t = np.linspace(0.0, 1.0, 31)
    ways = {
        "linear (eq 4)": lambda i: noise.linear(v[i], v[i + 1], t),
        "cosine (eq 5)": lambda i: noise.cosine(v[i], v[i + 1], t),
        "cubic (eq 6)": lambda i: noise.cubic(v[i - 1], v[i], v[i + 1], v[i + 2], t),
    }
    cells = grid_of(canvas, 2, 2)
    for cell, (name, way) in zip(cells, ways.items(), strict=False):
        axes = _lattice_axes(canvas, cell, name)
        x = np.concatenate([i + t for i in range(CELLS)])
        y = np.concatenate([way(i + 1) for i in range(CELLS)])
        curve(axes, x, y, BLUE)
        _dots(axes, v)
    axes = _lattice_axes(canvas, cells[3], "g, and dashed its smoothing f (eq 3)")
    place = knots, np.array(int(ROW)), np.array(int(SEEN))
    f = np.asarray(noise.smoothed(*place, seed=None))
    curve(axes, knots[1:-1], v[1:-1], BLUE)
    curve(axes, knots[1:-1], f[1:-1], RED, dash=6.0)
    _dots(axes, v)
    return canvas.picture()


def _lattice_axes(canvas: Canvas, cell: tuple[float, ...], name: str) -> Axes:
    left, top, right, bottom = cell
    return axes_in(
        canvas,
        (left, top, right, bottom),
        (0.0, float(CELLS)),
        (-1.5, 1.5),
        ticks_x=range(0, CELLS + 1, 2),
        ticks_y=(-1, 0, 1),
        title=name,
    )


def _dots(axes: Axes, v: Array) -> None:
    for place in axes.place(np.arange(CELLS + 1), v[1:-1]):
        disc(axes.canvas, place, 3.0, RED)


def bases(view: View) -> Picture:
    """Draw figure 5: the Gaussian basis, and Wyvill's."""
    flat_alone(view)
    canvas = blank(view.width, view.height)
    r = np.linspace(0.0, 1.5, FINE)
    both = np.concatenate([-r[:0:-1], r])
    one = np.ones(())
    for cell, (name, values) in zip(
        grid_of(canvas, 2, 1),
        {
            f"Gaussian, sigma = {SIGMA} (eq 15)": gaussian(np.abs(both), SIGMA * one),
            "f(R, r), R = 1 (eq 12)": wyvill(np.abs(both), one),
        }.items(),
        strict=True,
    ):
        axes = axes_in(
            canvas,
            cell,
            (-1.5, 1.5),
            (0.0, 1.05),
            ticks_x=(-1, 0, 1),
            ticks_y=(0, 0.25, 0.5, 0.75, 1),
            title=name,
            below="distance r from the centre",
        )
        curve(axes, [-1.5, 1.5], [0.5, 0.5], GREY, 0.6)
        curve(axes, both, values, BLUE, 2.0)
    return canvas.picture()


for name, number, title, draw in (
    ("man-01", "figure 1", "a result of the algorithm", Drawn(SCENES["cumulus"])),
    ("man-02", "figure 2", "noise as a sum of octaves, s = 0.5", octaves),
    ("man-03", "figure 3", "three interpolants, and the smoothing", interpolants),
    ("man-05", "figure 5", "basis functions", bases),
):
    enter_figure(Figure(name, number, title, draw))
