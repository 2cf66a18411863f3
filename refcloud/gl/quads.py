"""A table of balls, and the quads that it draws: what both passes share."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from refcloud.conventions import Array
from refcloud.gl.opengl import context, refuse_errors
from refcloud.gl.shaders import BALL, BOX, HAZE, PLACE, VERTEX
from refcloud.gl.state import set_state
from refcloud.gl.target import Target
from refcloud.raster import State
from refcloud.raster.factors import OVER

DEEPEST = 1e30  # optical depths beyond it let nothing pass, and float32 holds it
WHOLE = 2.0**23  # below it float32 holds every whole number, and halves
SMALLEST = 1e-30  # of radii, pixels: 1 / radius is still a float32


def ball_rows(
    columns: int, x: Array, y: Array, radius: Array, tau: Array, side: tuple[int, int]
) -> Array:
    """Lay out where balls are drawn, and how deep they are; the rest is left 0.

    Parameters
    ----------
    columns
        Of the table, four numbers each.
    x, y, radius
        In the picture, pixels, shape (N,).
    tau
        Optical depth on the axis, shape (N,).
    side
        Width and height of the picture.

    Returns
    -------
    Shape (N, columns, 4).
    """
    rows = np.zeros((len(x), columns, 4))
    tau = np.minimum(tau, DEEPEST)
    # A pixel's distance from the centre is nearly exact in float32 where both are near;
    # where the centre is far, so is the rim, and a share of the radius does.
    size = np.maximum(radius, SMALLEST)
    for first, middle in zip((0, 2), (x, y), strict=True):
        whole = np.where(np.abs(middle) < WHOLE, np.floor(middle), 0.0)
        rows[:, PLACE, first], rows[:, PLACE, first + 1] = (
            whole,
            (middle - whole) / size,
        )
    rows[:, BALL, 0], rows[:, BALL, 2] = 1.0 / size, tau
    rows[:, HAZE, 3] = -np.expm1(-tau)
    # The pixels whose centres lie in the bounding square, as raster.footprint.patch_of.
    for first, (middle, most) in zip((0, 2), ((x, side[0]), (y, side[1])), strict=True):
        low = np.ceil(np.maximum(middle - radius, 0.0) - 0.5)
        high = np.floor(np.minimum(middle + radius, most) - 0.5) + 1.0
        rows[:, BOX, first], rows[:, BOX, first + 1] = low, np.maximum(low, high)
    return rows


@functools.cache
def compiled(fragment: str) -> Any:
    """Compile the shaders of a pass, once for each text."""
    ctx = context()
    return ctx.vertex_array(ctx.program(VERTEX, fragment), [])


def bind(target: Target, balls: Any, columns: int, quads: Any) -> None:
    """Make everything ready to draw balls of a table over a target (eq 28).

    Parameters
    ----------
    target
        The framebuffer.
    balls, columns
        Texture of the table, and its columns.
    quads
        Of `compiled`.
    """
    target.fbo.viewport = 0, 0, target.width, target.height
    set_state(target.fbo, State(blending=OVER))
    balls.use(0)
    size = target.width, target.height
    set_uniforms(quads, balls=0, columns=columns, size=size, ball_0=0)


def draw(quads: Any, count: int) -> None:
    """Draw some balls, in the table's order."""
    if count:
        quads.render(context().TRIANGLE_STRIP, vertices=4, instances=count)
        refuse_errors("drawing balls")


def set_uniforms(quads: Any, **values: Any) -> None:
    """Set those uniforms that the compiler has kept."""
    for name, value in values.items():
        if name in quads.program:
            quads.program[name] = value
