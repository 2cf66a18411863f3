"""Figures of the errata in skies: fog, document C's program, gradients, cover."""

from __future__ import annotations

import dataclasses

import numpy as np
from errata_sheet import Draw, Figure, colours, frame, grey, name, pictures, plots

from refcloud.drawing import BLUE, RED, curve
from refcloud.noise import fbm_grid
from refcloud.scenes import simple
from refcloud.sky import (
    Cover,
    cloud_cover,
    fog_factor,
    fogged,
    printed_gradient,
    sky_gradient,
)

TOP, BOTTOM = (0.10, 0.24, 0.55), (0.55, 0.70, 0.85)  # of a sky that works, linear
SKY = np.array([0.25, 0.45, 0.8])  # behind the cover, linear


def e29() -> Figure:
    """Draw the share that fog leaves, and posts that stand ever farther off."""
    distance = np.linspace(0.0, 12.0, 121)
    right = fog_factor(distance, density=0.3)
    wrong = fog_factor(distance, density=6.0, form="printed")
    canvas, cells = plots(2)
    axes = frame(
        canvas, cells[0], (0, 12), (0, 1), ((0, 4, 8, 12), (0, 0.5, 1)),
        "share of the object", "distance",
    )  # fmt: skip
    curve(axes, distance, wrong, RED, 3.0)
    curve(axes, distance, right, BLUE, 3.0)
    name(axes, 4.0, 0.88, "printed", RED)
    name(axes, 2.6, 0.62, "product", BLUE)
    strip = frame(
        canvas, cells[1], (0, 12), (0, 2), ((0, 4, 8, 12), ()),
        "a post: product, printed", "distance",
    )  # fmt: skip
    x = np.arange(0.25, 12.0, 0.5)
    post = np.tile([0.05, 0.05, 0.1], (x.size, 1))
    for row, share in ((1.0, 0.3), (0.0, None)):
        if share is not None:
            light = fogged(post, x, density=share, color=np.array([0.7, 0.75, 0.8]))
        else:
            left = fog_factor(x, density=6.0, form="printed")[:, None]
            light = left * post + (1.0 - left) * [0.7, 0.75, 0.8]
        for at, ink in zip(x, light, strict=True):
            curve(strip, [at, at], [row + 0.1, row + 0.9], ink, 9.0)
    return Figure(
        f"At distances 0 and 12: {right[0]:.3f} and {right[-1]:.3f} with the product,"
        f" {wrong[0]:.4f} and {wrong[-1]:.3f} as printed.",
        canvas,
    )


def e31() -> Figure:
    """Draw document C's sheet, and as a signed char that saturates has it."""
    codes = simple.cloud()
    signed = np.minimum(codes, 127.0)
    places = [simple.scrolled(40, reset=on) for on in (True, False)]
    canvas, _ = pictures(
        {
            "0 to 255": grey(codes[:128, :256] / 255.0),
            "cut at 127": grey(signed[:128, :256] / 255.0),
        }
    )
    return Figure(
        f"{100 * (codes > 127).mean():.0f} % of the sheet are above 127. After 40"
        f" frames the scroll stands at {places[0]:.1f}, without the lucky reset at"
        f" {places[1]:.1f}. Each frame leaves {simple.bytes_of_a_frame():,} bytes of"
        " texture behind.",
        canvas,
    )


def e34() -> Figure:
    """Draw the printed sky beside a gradient that works."""
    printed = printed_gradient(width=96, height=60)
    canvas, _ = pictures(
        {
            "as printed": colours(printed),
            "sky_gradient": sky_gradient(TOP, BOTTOM, width=96, height=60),
        }
    )
    low, high = printed.min(axis=(0, 1)), printed.max(axis=(0, 1))
    return Figure(
        "The printed one is shown as codes of 255 v, as a window has them. Red is at"
        f" most {high[0]:g}, green {high[1]:g}, blue {low[2]:.3f} to {high[2]:.3f}.",
        canvas,
    )


def e37() -> Figure:
    """Draw a cover by either reading."""
    x, y = np.linspace(0.0, 6.0, 150), np.linspace(0.0, 4.0, 100)
    noise = fbm_grid(x, y, [0.5], seed=3)[0][0]
    panels, solid = {}, []
    for title, cover in (
        ("opacity", Cover()),
        ("printed", dataclasses.replace(Cover(), reading="printed")),
    ):
        light, opacity = cloud_cover(noise, cover)
        share = np.asarray(opacity)[..., None]
        panels[title] = share * np.asarray(light)[..., None] + (1.0 - share) * SKY
        solid.append(float(cloud_cover(np.array([0.6]), cover)[1][0]))
    canvas, _ = pictures({k: np.clip(v, 0.0, 1.0) for k, v in panels.items()})
    return Figure(
        f"Opacity where the noise is 0.6, a cloud's middle: {solid[0]:g} and"
        f" {solid[1]:g}.",
        canvas,
    )


FIGURES: dict[str, Draw] = {"E29": e29, "E31": e31, "E34": e34, "E37": e37}
