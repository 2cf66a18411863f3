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
from dataclasses import dataclass
from functools import partial
from typing import Annotated

import numpy as np

from refcloud.camera import AnyCamera
from refcloud.checking import check_fields, complaint
from refcloud.conventions import Array, Colour, Range, Seed
from refcloud.declared import Kind, enter_kind
from refcloud.image import Picture, srgb_decode
from refcloud.noise import fbm_grid, smooth_grid, worley_drawn, worley_smooth_grid
from refcloud.noise.worley_smooth import FINER, Detail
from refcloud.scene import Model, Motion, View
from refcloud.scenes.demand_cells import cells_overlay
from refcloud.sky import printed_gradient, sky_gradient

TOP, BOTTOM = np.array([0.10, 0.24, 0.56]), np.array([0.55, 0.70, 0.88])
PLAIN = np.full(3, 0.34)
PARTS = ("camera", "suns", "medium", "look", "scattering")
GAP = 4  # pixels between the pictures of a pair


@dataclass(frozen=True)
class Points:
    """Random points in the plane: which, how many, and whether 255 - d is shown."""

    seed: Seed
    count: Annotated[int, Range(1, 100_000)]
    inverted: bool

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class Cells:
    """A point in each cell: which, and how many cells along the longer side."""

    seed: Seed
    across: Annotated[int, Range(2, 64)]

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class Slice:
    """A slice of noise in space.

    Attributes
    ----------
    seed
        Which noise.
    across
        Cells along the slice's longer side.
    height
        Where it lies.
    filling
        Octaves of the finer noise.
    """

    seed: Seed
    across: Annotated[float, Range(0.1, 64.0, "cells")]
    height: Annotated[float, Range(-1e6, 1e6, "cells")]
    filling: Annotated[int, Range(1, 12)]

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class Gradient:
    """The mended sky above and below, linear RGB; the printed one has its own."""

    top: Colour
    bottom: Colour

    def __post_init__(self) -> None:
        check_fields(self)


DOTS, DOTS_INVERTED = Points(3, 60, False), Points(3, 60, True)
CELLS = Cells(3, 8)
SLICE = Slice(seed=3, across=4.0, height=0.4, filling=3)
SKY = Gradient(TOP, BOTTOM)


def worley(of: Points, model: Model, view: View) -> Picture:
    """Draw distances to random points, or 255 less them."""
    flat_alone(view)
    values = worley_drawn(
        view.width, view.height, count=of.count, seed=of.seed, inverted=of.inverted
    )
    return greys(values / 255.0)


def cells(of: Cells, model: Model, view: View) -> Picture:
    """Draw the cells with a point in each, and the cells that one pixel looks into."""
    flat_alone(view)
    light = cells_overlay(view.width, view.height, seed=of.seed, across=of.across)
    return Picture(light)


def rejected(of: Slice, model: Model, view: View) -> Picture:
    """Draw smooth noise beside gradient noise, and below the lumps they fill.

    The document does not say what did not look right about it. Each for itself the two
    look different; filled into the lumps they hardly do.
    """
    flat_alone(view)
    left = partial(filled, "smooth", of=of)
    return pair(view, left, partial(filled, "gradient", of=of))


def filled(detail: Detail, view: View, *, of: Slice = SLICE) -> Picture:
    """Draw a slice of the finer noise above, and of the texture that it fills below."""
    pixel = of.across / max(view.width, view.height)
    across, up, through = np.zeros(3) if view.offset is None else view.offset
    x: Array = np.asarray(pixel * (np.arange(view.width) + 0.5) - across, np.float64)
    y: Array = np.asarray(pixel * (np.arange(view.height) + 0.5) + up, np.float64)
    z = np.array([of.height - through + view.time])
    upper, lower = y[: view.height // 2], y[view.height // 2 :]
    finer = FINER * x, FINER * upper, FINER * z
    if detail == "smooth":
        above = smooth_grid(*finer, seed=of.seed, octaves=of.filling)[0]
    else:
        above = 0.5 + 0.5 * fbm_grid(*finer, seed=of.seed, octaves=of.filling)[0][0]
    below = worley_smooth_grid(
        x, lower, z, seed=of.seed, octaves=of.filling, detail=detail
    )[0]
    return greys(np.concatenate([above, below]))


def skies(of: Gradient, model: Model, view: View) -> Picture:
    """Draw the printed sky beside the mended one."""
    flat_alone(view)
    right = partial(mended, top=of.top, bottom=of.bottom)
    return pair(view, lambda v: Picture(printed(v)), lambda v: Picture(right(v)))


def halved(view: View) -> View:
    """Give the view of each of two pictures side by side."""
    return dataclasses.replace(view, width=max((view.width - GAP) // 2, 1))


def pair(
    view: View, left: Callable[[View], Picture], right: Callable[[View], Picture]
) -> Picture:
    """Draw two pictures side by side, each half as wide, with a gap between them."""
    camera: AnyCamera | None = view.camera
    width, height = view.width, view.height
    if camera is not None:
        width, height = camera.width, camera.height
    narrow = halved(dataclasses.replace(view, width=width, height=height))
    half = narrow.width
    if camera is not None:
        camera = dataclasses.replace(camera, width=half)
        narrow = dataclasses.replace(narrow, camera=camera)
    panels = [left(narrow), right(narrow)]
    light = np.ones((height, width, 3))
    light[:, :half] = panels[0].linear
    light[:, max(width - half, 0) :] = panels[1].linear
    return dataclasses.replace(panels[1], linear=light)


def plain(view: View) -> Array:
    """Give one grey."""
    return np.broadcast_to(PLAIN, (view.height, view.width, 3)).copy()


def mended(view: View, *, top: Array = TOP, bottom: Array = BOTTOM) -> Array:
    """Give the gradient that document D meant."""
    return sky_gradient(top, bottom, width=view.width, height=view.height)


def printed(view: View) -> Array:
    """Give the gradient that document D printed."""
    return printed_gradient(width=view.width, height=view.height)


def greys(values: Array) -> Picture:
    """Show values in [0, 1] as the codes of a PNG file, as document D does."""
    return Picture(np.repeat(srgb_decode(values)[..., None], 3, axis=-1))


def flat_alone(view: View) -> None:
    """Refuse what a picture of the plane has no use for."""
    refuse_given(view, PARTS, "a picture of the plane")


def refuse_given(view: View, names: tuple[str, ...], what: str) -> None:
    """Refuse parts of a view that are not None, in one line."""
    for name in names:
        if getattr(view, name) is not None:
            raise ValueError(complaint(name, f"none beside {what}", "one"))


def no_model() -> Model:
    """Make nothing yet: how fine a cloud is, its picture says."""
    return Model({})


def sliced(of: Slice) -> Motion:
    """Let time move the slice and wind the noise; neither repeats."""
    return Motion(period=math.inf, repeats=(math.inf, math.inf, math.inf))


def still(of: object) -> Motion:
    """Move nothing."""
    return Motion()


for name, title, own, draw, motion in (
    ("worley", "Worley noise in the plane", DOTS, worley, still),
    ("worley-inverted", "Worley noise, inverted", DOTS_INVERTED, worley, still),
    ("cells", "cells, points, and where one pixel looks", CELLS, cells, still),
    (
        "perlin",
        "smooth noise beside the rejected gradient noise",
        SLICE,
        rejected,
        sliced,
    ),
    ("sky", "the sky as printed, and mended", SKY, skies, still),
):
    enter_kind(Kind(f"demand-{name}", f"document D: {title}", own, draw, motion))
