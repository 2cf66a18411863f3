"""The scenes that have a golden picture, each as a function that draws it small."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from refcloud import Picture, load_metaballs
from refcloud.raster import framebuffer, splat
from refcloud.scenes import SCENES, Model, View

FIXTURES = Path(__file__).parent / "fixtures"
VIEW, SMALL_VIEW = View(192, 144), View(128, 96)


def blend_fan() -> Picture:
    """Draw a fan of overlapping splats over a gradient, both laws, both footprints."""
    width, height = 128, 96
    buffer = framebuffer(width, height)
    down, across = np.linspace(0, 1, height), np.linspace(0, 1, width)
    buffer.pixels[..., 0] = 0.1 + 0.3 * across
    buffer.pixels[..., 1] = 0.2 + 0.2 * down[:, None]
    buffer.pixels[..., 2] = 0.6 - 0.3 * down[:, None]
    for step in range(9):
        angle = math.pi * step / 8
        colour = 0.5 + 0.5 * np.cos(angle + np.array([0.0, 2.0, 4.0]))
        splat(
            buffer,
            width / 2 - 44 * math.cos(angle),
            height - 8 - 60 * math.sin(angle),
            10 + 2.5 * step,
            emission=colour,
            tau=0.25 * 2 ** (step / 2),
            name=("chord", "profile")[step % 2],
            law=("beer", "linear")[step // 2 % 2],
        )
    return Picture(buffer.pixels[..., :3])


def fitted(name: str, balls: str) -> Picture:
    """Draw a scene from stored balls: a fit amplifies what machines differ in."""
    stored = sorted(FIXTURES.glob(f"{balls}-*.npz"))
    clouds = {
        path.stem.removeprefix(f"{balls}-").replace("-", " "): load_metaballs(path)
        for path in stored
    }
    return SCENES[name].draw(Model(clouds), VIEW)


def unfitted(name: str, view: View = VIEW) -> Picture:
    """Draw a scene whose clouds come straight from the noise."""
    scene = SCENES[name]
    return scene.draw(scene.model(), view)


GOLDEN: dict[str, Callable[[], Picture]] = {
    "blend-fan": blend_fan,
    "cumulus": partial(fitted, "cumulus", "cumulus"),
    "demand": partial(unfitted, "demand"),
    **{
        f"demand-{name}": partial(unfitted, f"demand-{name}", SMALL_VIEW)
        for name in (
            *("worley", "worley-inverted", "cells", "perlin", "sky"),
            *("box", "faces", "quad", "lit", "background"),
        )
    },
    "man-04": partial(unfitted, "man-04"),
    "man-08": partial(fitted, "man-08", "man-08"),
    "man-09": partial(fitted, "man-09", "man-09"),
    "man-10": partial(fitted, "man-10", "man-10"),
    "man-13": partial(fitted, "man-13", "man-13"),
    "man-14": partial(fitted, "man-14", "man-13"),
    "multiple": partial(unfitted, "multiple", View(64, 48)),
}
