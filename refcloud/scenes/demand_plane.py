"""The figures of document D in the plane: its noise, and its sky.

``demand-worley`` and ``demand-worley-inverted`` are Worley noise as first drawn;
``demand-cells`` lays its cells and points over it; ``demand-perlin`` sets smooth noise
beside the gradient noise that did not look right (N32); ``demand-sky`` sets the
printed sky, nearly black, beside a mended one (E34).
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from functools import partial

import numpy as np

from refcloud.camera import AnyCamera
from refcloud.checking import complaint
from refcloud.conventions import Array
from refcloud.image import Picture, srgb_decode
from refcloud.noise import fbm_grid, smooth_grid, worley_drawn, worley_smooth_grid
from refcloud.noise.worley_smooth import FINER, Detail
from refcloud.scene import Model, Motion, Scene, View, enter
from refcloud.scenes.demand_cells import cells_overlay
from refcloud.sky import printed_gradient, sky_gradient

SEED, POINTS = 3, 60
SLICE, HEIGHT = 4.0, 0.4  # cells along a slice's longer side, and where it lies
FILLING = 3  # octaves of the finer noise
TOP, BOTTOM = np.array([0.10, 0.24, 0.56]), np.array([0.55, 0.70, 0.88])
PLAIN = np.full(3, 0.34)
GAP = 4  # pixels between the pictures of a pair


def worley(model: Model, view: View, *, inverted: bool) -> Picture:
    """Draw distances to random points, or 255 less them."""
    flat_alone(view)
    values = worley_drawn(
        view.width, view.height, count=POINTS, seed=SEED, inverted=inverted
    )
    return greys(values / 255.0)


def cells(model: Model, view: View) -> Picture:
    """Draw the cells with a point in each, and the cells that one pixel looks into."""
    flat_alone(view)
    return Picture(cells_overlay(view.width, view.height, seed=SEED))


def rejected(model: Model, view: View) -> Picture:
    """Draw smooth noise beside gradient noise, and below the lumps they fill.

    The document does not say what did not look right about it. Each for itself the two
    look different; filled into the lumps they hardly do.
    """
    flat_alone(view)
    return pair(view, partial(filled, "smooth"), partial(filled, "gradient"))


def filled(detail: Detail, view: View) -> Picture:
    """Draw a slice of the finer noise above, and of the texture that it fills below."""
    pixel = SLICE / max(view.width, view.height)
    across, up, through = np.zeros(3) if view.offset is None else view.offset
    x: Array = np.asarray(pixel * (np.arange(view.width) + 0.5) - across, np.float64)
    y: Array = np.asarray(pixel * (np.arange(view.height) + 0.5) + up, np.float64)
    z = np.array([HEIGHT - through + view.time])
    upper, lower = y[: view.height // 2], y[view.height // 2 :]
    finer = FINER * x, FINER * upper, FINER * z
    if detail == "smooth":
        above = smooth_grid(*finer, seed=SEED, octaves=FILLING)[0]
    else:
        above = 0.5 + 0.5 * fbm_grid(*finer, seed=SEED, octaves=FILLING)[0][0]
    below = worley_smooth_grid(x, lower, z, seed=SEED, octaves=FILLING, detail=detail)[
        0
    ]
    return greys(np.concatenate([above, below]))


def skies(model: Model, view: View) -> Picture:
    """Draw the printed sky beside the mended one."""
    flat_alone(view)
    return pair(view, lambda v: Picture(printed(v)), lambda v: Picture(mended(v)))


def pair(
    view: View, left: Callable[[View], Picture], right: Callable[[View], Picture]
) -> Picture:
    """Draw two pictures side by side, each half as wide, with a gap between them."""
    camera: AnyCamera | None = view.camera
    width, height = view.width, view.height
    if camera is not None:
        width, height = camera.width, camera.height
    half = max((width - GAP) // 2, 1)
    if camera is not None:
        camera = dataclasses.replace(camera, width=half)
    narrow = dataclasses.replace(view, width=half, height=height, camera=camera)
    panels = [left(narrow), right(narrow)]
    light = np.ones((height, width, 3))
    light[:, :half] = panels[0].linear
    light[:, max(width - half, 0) :] = panels[1].linear
    return dataclasses.replace(panels[1], linear=light)


def plain(view: View) -> Array:
    """Give one grey."""
    return np.broadcast_to(PLAIN, (view.height, view.width, 3)).copy()


def mended(view: View) -> Array:
    """Give the gradient that document D meant."""
    return sky_gradient(TOP, BOTTOM, width=view.width, height=view.height)


def printed(view: View) -> Array:
    """Give the gradient that document D printed."""
    return printed_gradient(width=view.width, height=view.height)


def greys(values: Array) -> Picture:
    """Show values in [0, 1] as the codes of a PNG file, as document D does."""
    return Picture(np.repeat(srgb_decode(values)[..., None], 3, axis=-1))


def flat_alone(view: View) -> None:
    """Refuse what a picture of the plane has no use for."""
    refuse_given(view, ("camera", "suns", "medium", "look"), "a picture of the plane")


def refuse_given(view: View, names: tuple[str, ...], what: str) -> None:
    """Refuse parts of a view that are not None, in one line."""
    for name in names:
        if getattr(view, name) is not None:
            raise ValueError(complaint(name, f"none beside {what}", "one"))


def no_model() -> Model:
    """Make nothing yet: how fine a cloud is, its picture says."""
    return Model({})


# Slices of noise in space: time moves the slice, wind the noise, and neither repeats.
SLICED = Motion(period=math.inf, repeats=(math.inf, math.inf, math.inf))
STILL = Motion()
for name, title, draw, motion in (
    ("worley", "Worley noise in the plane", partial(worley, inverted=False), STILL),
    (
        "worley-inverted",
        "Worley noise, inverted",
        partial(worley, inverted=True),
        STILL,
    ),
    ("cells", "cells, points, and where one pixel looks", cells, STILL),
    ("perlin", "smooth noise beside the rejected gradient noise", rejected, SLICED),
    ("sky", "the sky as printed, and mended", skies, STILL),
):
    enter(Scene(f"demand-{name}", f"document D: {title}", no_model, draw, motion))
