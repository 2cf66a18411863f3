"""Figures of the errata in noise: interpolants, sums, simplex and Worley noise."""

from __future__ import annotations

from typing import Any

import numpy as np
from errata_sheet import Draw, Figure, frame, grey, name, pictures, plots

from refcloud import noise
from refcloud.drawing import BLUE, GREEN, ORANGE, RED, curve

MASK_31, MASK_43 = 0x7FFFFFFF, 0x7FFFFFFFFFF


def e11() -> Figure:
    """Draw a line through the sum, with what each normalisation makes of it."""
    x = np.linspace(0.0, 40.0, 321)
    how: dict[str, Any] = {"persistence": 0.9, "seed": None}
    raw, clipped, bound = (
        noise.octave_sum_grid(x, [20.0], [0.5], normalize=n, **how)[0][0, 0]
        for n in ("none", "clip", "bound")
    )
    canvas, cells = plots(1)
    top = 1.1 * float(raw.max())
    axes = frame(
        canvas, cells[0], (0, 40), (0, top), ((0, 10, 20, 30, 40), (0, 0.5, 1)),
        "s = 0.9: none (red), clip (blue), bound (green)", "x",
    )  # fmt: skip
    curve(axes, x, raw, RED, 3.0)
    curve(axes, x, clipped, BLUE, 3.0)
    curve(axes, x, bound, GREEN, 3.0)
    return Figure(
        f"The largest sum on this line is {raw.max():.3f}; the bound is"
        f" {noise.octave_bound(4, 0.9):.3f} here and {noise.octave_bound(4, 0.5):.4g}"
        " with s = 0.5.",
        canvas,
    )


def e12() -> Figure:
    """Draw the cubic of eq 6 and that of Catmull and Rom."""
    t = np.linspace(0.0, 1.0, 61)
    canvas, cells = plots(2)
    step = frame(
        canvas, cells[0], (0, 1), (0.9, 1.6), ((0, 0.5, 1), (1, 1.25, 1.5)),
        "between -1, 1, 1, -1", "t",
    )  # fmt: skip
    line = frame(
        canvas, cells[1], (0, 1), (0, 1), ((0, 0.5, 1), (0, 0.5, 1)),
        "on -1, 0, 1, 2", "t",
    )  # fmt: skip
    tops = []
    for way, ink in ((noise.cubic, RED), (noise.catmull_rom, BLUE)):
        y = way(-1.0, 1.0, 1.0, -1.0, t)
        curve(step, t, y, ink, 3.0)
        curve(line, t, way(-1.0, 0.0, 1.0, 2.0, t), ink, 3.0)
        tops.append(float(np.max(y)))
    bend = np.abs(noise.cubic(-1.0, 0.0, 1.0, 2.0, t) - t).max()
    return Figure(
        f"Eq 6 (red) reaches {tops[0]:g}, Catmull-Rom (blue) {tops[1]:g}; on a straight"
        f" line eq 6 is off by up to {bend:.3f}. In three dimensions {tops[0] ** 3:g}.",
        canvas,
    )


CURVES = (
    ("linear", BLUE), ("cosine", RED), ("cubic", ORANGE), ("catmull_rom", GREEN),
)  # fmt: skip


def joined_error(way: str, cells: int) -> float:
    """Measure the worst error of an interpolant on one period of a sine."""
    h = 2.0 * np.pi / cells
    values = np.sin(h * np.arange(-1, cells + 2))
    t = np.linspace(0.0, 1.0, 33)
    k = np.arange(cells)[:, None]
    weights, offsets = noise.taps(way, t)
    parts = zip(weights, offsets, strict=True)
    found: Any = sum(w * values[k + o + 1] for w, o in parts)
    return float(np.abs(found - np.sin(h * (k + t))).max())


def e13() -> Figure:
    """Draw the error of each interpolant over the number of cells."""
    cells = 2 ** np.arange(3, 10)
    canvas, places = plots(1)
    axes = frame(
        canvas, places[0], (3, 9), (-8, 0), (range(3, 10), (-8, -6, -4, -2, 0)),
        "log10 of the error on a sine", "log2 of the cells to a period",
    )  # fmt: skip
    orders = []
    for way, ink in CURVES:
        errors = np.array([joined_error(way, int(n)) for n in cells])
        curve(axes, np.log2(cells), np.log10(errors), ink, 3.0)
        order = np.log2(errors[-2] / errors[-1])
        orders.append(f"{way.replace('catmull_rom', 'Catmull-Rom')} {order:.2f}")
    for text, x, y, ink in (
        ("cosine, cubic", 6.9, -0.75, RED),
        ("linear", 7.2, -3.0, BLUE),
        ("Catmull-Rom", 4.6, -5.2, GREEN),
    ):
        name(axes, x, y, text, ink)
    return Figure("Orders measured: " + ", ".join(orders) + ".", canvas)


def e14() -> Figure:
    """Draw the noise along x through 0, with floor and with the fraction cut off."""
    x = np.linspace(-3.0, 3.0, 601)[:-1]
    place = np.stack([x, np.full_like(x, 2.0), np.full_like(x, 5.0)], axis=-1)
    right = noise.value(place, seed=None)
    cell = np.trunc(x).astype(np.int64)
    # cos is even: with its negative "fraction" eq 5 is what it is with |t|.
    ends = [np.asarray(noise.smoothed(cell + i, 2, 5, seed=None)) for i in (0, 1)]
    wrong = np.asarray(noise.cosine(*ends, np.abs(x - cell)))
    canvas, cells = plots(1)
    low, high = min(right.min(), wrong.min()), max(right.max(), wrong.max())
    axes = frame(
        canvas, cells[0], (-3, 3), (low - 0.05, high + 0.05), (range(-3, 4), ()),
        "floor (blue), int (red)", "x",
    )  # fmt: skip
    for start in range(0, 600, 100):
        part = slice(start + 1, start + 100)  # the red curve jumps between these
        curve(axes, x[part], wrong[part], RED, 4.0)
    curve(axes, x, right, BLUE, 2.0)
    jumps = [float(np.abs(np.diff(v)).max()) for v in (right, wrong)]
    return Figure(
        f"Largest change over 0.01 of a cell: {jumps[0]:.3f} with floor,"
        f" {jumps[1]:.3f} with int. For x >= 0 both are the same.",
        canvas,
    )


def e30() -> Figure:
    """Draw simplex noise across a face of its simplices, with both radii."""
    # The face z = 0 of the plane's first simplex, met where the jump is large.
    s = np.linspace(-4e-3, 4e-3, 400)
    ends = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    ends = ends - (3.0 - np.sqrt(3.0)) / 6.0 * ends.sum(axis=1, keepdims=True)
    face = 0.5 * (ends[0] + ends[2])
    along = (ends[2] - ends[0]) / np.linalg.norm(ends[2] - ends[0])
    at = face + s[:, None] * np.array([-along[1], along[0]])
    canvas, cells = plots(2)
    found = []
    for cell, radius, ink in zip(
        cells, ("continuous", "usual"), (BLUE, RED), strict=True
    ):
        values = [noise.simplex(at, seed=k, radius=radius) for k in range(60)]
        steps = [np.abs(v[200] - v[199]) for v in values]
        one = int(np.argmax(steps)) if radius == "usual" else 0
        y = values[one] - values[one][199]
        found.append(max(steps))
        axes = frame(
            canvas, cell, (-4, 4), (-0.02, 0.02), ((-4, 0, 4), (-0.02, 0, 0.02)),
            f"r^2 = {0.5 if radius == 'continuous' else 0.6}", "1000 x distance to it",
        )  # fmt: skip
        curve(axes, 1e3 * s[:200], y[:200], ink, 3.0)
        curve(axes, 1e3 * s[200:], y[200:], ink, 3.0)
    return Figure(
        f"Change over 2e-5 across a face in the plane, worst of 60 seeds:"
        f" {found[0]:.1e} with r^2 = 0.5, {found[1]:.1e} with 0.6.",
        canvas,
    )


def e32() -> Figure:
    """Draw the place where the neighbours-only search of seed 0 is worst."""
    x = 2746.96 + np.linspace(-0.5, 0.5, 80)
    y = 994.997 + np.linspace(-0.5, 0.5, 80)
    how: dict[str, Any] = {"seed": 0, "period": 3000}
    exact = noise.worley_grid(x, y, **how)
    near = noise.worley_grid(x, y, search="neighbours", **how)
    canvas, _ = pictures(
        {
            "exact": grey(exact / 1.5),
            "neighbours": grey(near / 1.5),
            "10 x gap": grey(10.0 * (near - exact)),
        }
    )
    return Figure(
        f"One cell of 9 million; the worst gap seen here is {(near - exact).max():.4f},"
        f" the worst that can be built {np.sqrt(2.0) - 1.0:.4f}. The distance reaches"
        f" {exact.max():.3f} cells.",
        canvas,
    )


def e33() -> Figure:
    """Draw the remap while its range shrinks to nothing."""
    v = np.linspace(0.0, 2.0, 201)
    canvas, cells = plots(1)
    axes = frame(
        canvas, cells[0], (0, 2), (-0.1, 1.1), ((0, 1, 2), (0, 1)),
        "remap(v, 1, 1 + w, 0, 1), cut", "v",
    )  # fmt: skip
    for width, ink in ((1.0, BLUE), (0.3, GREEN), (0.05, ORANGE)):
        curve(
            axes, v, np.clip(noise.remap(v, 1.0, 1.0 + width, 0.0, 1.0), 0, 1), ink, 3.0
        )
    curve(axes, v, noise.remap(v, 1.0, 1.0, 0.0, 1.0, empty="step"), RED, 3.0, dash=9.0)
    try:
        noise.remap([0.5], 1.0, 1.0, 0.0, 1.0)
        refusal = "none"
    except ValueError as error:
        refusal = str(error)
    bounds = [float(noise.worley_bound(n, "F1")) for n in (2, 3)]
    return Figure(
        "w = 1 (blue), 0.3 (green), 0.05 (orange), and dashed the step that w = 0"
        " makes by name; else the answer is"
        f" `{refusal}`. The distance to the nearest point is at most"
        f" {bounds[0]:.4f} in the plane, {bounds[1]:.4f} in space.",
        canvas,
    )


FIGURES: dict[str, Draw] = {
    "E11": e11,
    "E12": e12,
    "E13": e13,
    "E14": e14,
    "E30": e30,
    "E32": e32,
    "E33": e33,
}
