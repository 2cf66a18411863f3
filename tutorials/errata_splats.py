"""Figures of the errata in splats, buffers and the march."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from errata_sheet import (
    Draw,
    Figure,
    colours,
    frame,
    grey,
    name,
    paper,
    pictures,
    plots,
)

from refcloud.camera import OrthographicCamera, axes
from refcloud.cloudmap import VoxelGrid
from refcloud.drawing import BLACK, BLUE, GREY, RED, box, curve, image, ring, words
from refcloud.lighting import named, sunward
from refcloud.march import Mixing, march_by_steps
from refcloud.metaballs import Metaballs
from refcloud.noise import hermite
from refcloud.optics import (
    Medium,
    Sun,
)
from refcloud.raster import (
    footprint,
    framebuffer,
    patch,
    read_mean,
    read_pixels,
    seen_through_layers,
    splat,
    transmittance,
)


def e25() -> Figure:
    """Draw a ball of tau 8 over white under each law."""
    side, R = 96, 44.0
    found = patch(side / 2, side / 2, R, side, side)
    assert found is not None
    w = np.zeros((side, side))
    w[found.rows, found.columns] = footprint(np.minimum(found.q, 1.0))
    quad = np.ones((side, side))
    quad[4:-4, 4:-4] = transmittance(np.ones((side - 8, side - 8)), 8.0)
    canvas, _ = pictures(
        {
            "whole quad": colours(quad[..., None] * np.ones(3)),
            "linear": grey(transmittance(w, 8.0, law="linear")),
            "beer": grey(transmittance(w, 8.0)),
        }
    )
    share = np.linspace(0.0, 1.0, 100_001)
    gaps = [
        np.abs(transmittance(share, t) - transmittance(share, t, law="linear")).max()
        for t in (0.1, 1.0, 8.0)
    ]
    return Figure(
        "A ball of tau 8 before white. Largest difference of the two laws at tau 0.1,"
        f" 1 and 8: {gaps[0]:.4f}, {gaps[1]:.3f}, {gaps[2]:.3f}.",
        canvas,
    )


def e26() -> Figure:
    """Draw a row of balls from the farthest on, and from the nearest on."""
    row = [(26.0, 34.0, [1.0, 0.25, 0.1]), (48.0, 28.0, [0.2, 0.8, 0.2]),
           (70.0, 34.0, [0.2, 0.4, 1.0])]  # fmt: skip
    panels = {}
    for title, order in (("far to near", row), ("near to far", row[::-1])):
        buffer = framebuffer(96, 60, color=[1, 1, 1, 1])
        for x, y, light in order:
            glow = np.array(light) * -math.expm1(-4.0)
            splat(buffer, x, y, 25.0, emission=glow, tau=4.0)
        panels[title] = colours(buffer.pixels[..., :3])
    canvas, _ = pictures(panels)
    pair = Metaballs([[0, 2, 0], [0, -2, 0]], [1, 1], [1, 1])
    stored = [
        sunward(
            pair,
            (Sun([0, 1, 0], [1, 1, 1]),),
            medium=Medium(1.0, 0.9, 0.6, phase),
            look=named("man"),
        ).light[0, :, 0]
        for phase in ("isotropic", "hg")
    ]
    return Figure(
        "Three balls, the blue one nearest. What pass 1 stores for two balls in line,"
        f" {stored[0][0]:.3f} and {stored[0][1]:.3f}, is the same under any phase"
        f" function: it differs by {np.abs(stored[0] - stored[1]).max():g}.",
        canvas,
    )


def e27() -> Figure:
    """Draw what is read around a ball that hangs over the border."""
    wide, high = 96, 48
    buffer = framebuffer(wide, high, color=[1, 1, 1, 1])
    splat(buffer, 60.0, 22.0, 30.0, emission=[0.3, 0.3, 0.3], tau=3.0)
    x, y, R = 84.0, 24.0, 20.0
    canvas, s = paper(128), 5.0  # units to a pixel of the buffer
    image(canvas, grey(buffer.pixels[..., 0]), (8, 8), (8 + s * wide, 8 + s * high))
    box(canvas, (8, 8), (8 + s * wide, 8 + s * high), GREY, 2.0)
    middle = 8 + s * x, 8 + s * y
    corners = [np.array(middle) + sign * s * R for sign in (-1, 1)]
    box(canvas, *corners, GREY, 4.0)
    box(canvas, corners[0], (6 + s * wide, corners[1][1]), RED, 4.0)
    ring(canvas, middle, s * R, BLUE, 4.0)
    words(canvas, (500, 14), "read (red)", RED, size=18)
    means: dict[str, float] = {}
    for area in ("square", "disc", "footprint"):
        mean = read_mean(buffer, x, y, R, area=area)
        assert mean is not None
        means[area] = float(mean[0])
    rows, columns = slice(int(y - R), int(y + R)), slice(int(x - R), wide)
    read = read_pixels(buffer, rows, columns)
    wrong = float(read[..., 0].sum()) / (2 * R) ** 2
    return Figure(
        "Means: "
        + ", ".join(f"{k} {v:.3f}" for k, v in means.items())
        + f"; the sum of what is there over the count of the whole square {wrong:.3f}.",
        canvas,
    )


def e28() -> Figure:
    """Draw the map of SkyWorks beside the footprints, and try the up vector."""
    b = np.linspace(0.0, 1.0, 201)
    canvas, cells = plots(2)
    maps = frame(
        canvas, cells[0], (0, 1), (0, 1), ((0, 0.5, 1), (0, 0.5, 1)),
        "map: SkyWorks red", "b / R",
    )  # fmt: skip
    other = np.asarray(hermite(1.0, 0.0, b))
    curve(maps, b, other, RED, 3.0)
    curve(maps, b, footprint(b**2), BLUE, 3.0)
    term = frame(
        canvas, cells[1], (0, 1), (-0.5, 0.1), ((0, 0.5, 1), (-0.4, -0.2, 0)),
        "u^3 - u (red), u^3 - u^2", "u",
    )  # fmt: skip
    curve(term, b, b**3 - b, RED, 3.0)
    curve(term, b, b**3 - b**2, BLUE, 3.0)
    way = np.array([0.3, 0.9, 0.3])
    up = axes(OrthographicCamera(way, np.zeros(3)))[1]
    return Figure(
        "2u^3 - 3u^2 + 1 and the chord's footprint differ by up to"
        f" {np.abs(other - footprint(b**2)).max():.3f}. Seen from (0.3, 0.9, 0.3) up is"
        f" ({up[0]:.3f}, {up[1]:.3f}, {up[2]:.3f}), as near to y as can be.",
        canvas,
    )


def e35() -> Figure:
    """Draw what is seen through black layers, in floating point and in 8 bits."""
    count = np.arange(1001)
    canvas, cells = plots(1)
    axes_ = frame(
        canvas, cells[0], (0, 1000), (0, 1), ((0, 250, 500, 750), (0, 0.5, 1)),
        "white behind layers of alpha 1/255", "layers",
    )  # fmt: skip
    found = {}
    for form, ink in (("RGBA64F", BLUE), ("RGBA8", RED)):
        seen = seen_through_layers(1 / 255, 1000, format=form)
        curve(axes_, count[::4], seen[::4], ink, 3.0)
        found[form] = float(seen[-1])
    name(axes_, 600, 0.6, "RGBA8", RED)
    name(axes_, 480, 0.28, "RGBA64F", BLUE)
    return Figure(
        f"After 1000 layers: {found['RGBA64F']:.4f} in floating point,"
        f" {found['RGBA8']:.3f} in RGBA8.",
        canvas,
    )


def e38() -> Figure:
    """Draw the light of a slab by either sum, over its depth."""
    slab = VoxelGrid(np.ones((2, 3, 2)), [-50.0, -50.0, 0.0], [50.0, 50.0, 2.0])
    ray: Any = ([0.0, 0.0, 9.0], [[0.0, 0.0, -1.0]])
    depth = np.linspace(0.0, 16.0, 17)[1:]
    sums: dict[str, list[float]] = {"beer": [], "euler": []}
    for segment, found in sums.items():
        for tau in depth.tolist():
            L, _ = march_by_steps(
                slab, *ray, suns=Sun([0, 0, 1]),
                medium=Medium(tau / 2.0, phase="isotropic"), sample_rate=4,
                sun_sample_rate=1, segment=segment,
                mixing=Mixing(darkness_threshold=1.0),
            )  # fmt: skip
            found.append(float(L[0, 0]))
    canvas, cells = plots(1)
    axes_ = frame(
        canvas, cells[0], (0, 16), (0, 4.5), ((0, 4, 8, 12, 16), (0, 1, 2, 3, 4)),
        "light of a slab, eight steps", "optical depth",
    )  # fmt: skip
    curve(axes_, depth, sums["euler"], RED, 3.0)
    curve(axes_, depth, sums["beer"], BLUE, 3.0)
    curve(axes_, depth, -np.expm1(-depth), BLACK, 1.0, dash=8.0)
    name(axes_, 6.0, 2.6, "euler", RED)
    name(axes_, 10.5, 0.55, "beer", BLUE)
    return Figure(
        f"At a depth of 16: {sums['euler'][-1]:.3f} by the printed sum,"
        f" {sums['beer'][-1]:.6f} by Beer's law; the slab has"
        f" {-math.expm1(-16.0):.6f} (dashed).",
        canvas,
    )


FIGURES: dict[str, Draw] = {
    "E25": e25,
    "E26": e26,
    "E27": e27,
    "E28": e28,
    "E35": e35,
    "E38": e38,
}
