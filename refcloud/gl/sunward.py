"""Pass 1 on OpenGL, to the letter: read back, draw, ball after ball.

Every ball waits for the mean of what the balls before it left in the framebuffer, so
that each costs a readback; it is summed in float64. Only what is drawn is float32.
"""

from __future__ import annotations

from typing import Any, cast

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Observer, Tolerance
from refcloud.gl.fragments import clear
from refcloud.gl.opengl import context
from refcloud.gl.quads import ball_rows, bind, compiled, draw, set_uniforms
from refcloud.gl.shaders import HAZE, sunward_source
from refcloud.gl.tables import table
from refcloud.gl.target import Target, framebuffer, read_pixels
from refcloud.lighting.lightview import LightView, handed_on
from refcloud.lighting.lit import LitMetaballs
from refcloud.lighting.look import Look, LookName, named
from refcloud.lighting.sunward import lit_by
from refcloud.metaballs import Metaballs
from refcloud.metaballs.kernels import Kernel
from refcloud.optics import (
    PHASE_MAN2003,
    Medium,
    Sun,
    coupling_man2003,
    largest_steady_tau,
)
from refcloud.raster.footprint import footprint_of, patch_of
from refcloud.raster.splat import mean_of

FAR = 1e30  # stands for a limit of the steady range that float32 does not hold


@checked
def sunward(
    balls: Metaballs,
    suns: tuple[Sun, ...],
    *,
    medium: Medium,
    look: Look | LookName = "cumulus",
    tolerance: Tolerance = 0.0,
    earlier: LitMetaballs | None = None,
    observe: Observer | None = None,
) -> LitMetaballs:
    """Carry every sun's light through the balls, on OpenGL: pass 1.

    Formula: I_k = g_{k-1} + T_{k-1} I_{k-1}, I_1 = I_0, T = exp(-tau), where I_k is the
    mean of the framebuffer over ball k

    Parameters
    ----------
    balls
        The cloud.
    suns
        Each is carried by itself; the results add up.
    medium
        Extinction and albedo; coloured ones are carried channel by channel.
    look
        The rules, or their name.
    tolerance
        Saves nothing here: every ball is read back and drawn.
    earlier
        What an earlier call gave, of either backend: lights that shine on the same
        balls by the same rules are not carried again (L15).
    observe
        Called with (name, value), as of `refcloud.lighting.sunward`.

    Returns
    -------
    The lit balls, for either `eyeward`.

    Raises
    ------
    ValueError
        There is no OpenGL; or with gain="refuse", where eq 26 would make light.

    Source: paper M, eq 26 to 28, L04 to L09, L12, L13; E22 to E27.
    """
    rules = named(look)
    context()  # refuses here, also where no ball is to be lit
    how = rules, tolerance, earlier, observe
    return lit_by(balls, suns, medium, *how, carried_on_opengl)


def carried_on_opengl(
    view: LightView, tau: Array, albedo: float, look: Look, forward: float
) -> tuple[Array, Array]:
    """Run pass 1 for one light and one colour channel, unchecked.

    Parameters
    ----------
    view, tau, albedo, look, forward
        As `refcloud.lighting.in_turn.carried_in_turn`.

    Returns
    -------
    The share of the light that reaches each ball, shape (N,), and the framebuffer's
    light, its rows one after the other.
    """
    on_axis = handed_on(look, albedo, forward)(tau)  # refuses before anything is drawn
    kernel, side = view.balls.kernel, view.side
    reached = np.zeros(len(tau))
    # 1. The buffer is filled with white, the unblocked light.
    target = framebuffer(side, side)
    clear(target, np.ones(4))
    rows = ball_rows(4, view.x, view.y, view.radius, tau, (side, side))
    rows[:, HAZE, 0] = on_axis
    quads = _quads_for(kernel, look, albedo, forward)
    balls = table(rows.reshape(-1, 4))
    bind(target, balls, 4, quads)
    pixels = cast(Array, _Pixels(target))
    for k in view.order:
        # 2. Read back: the light that reaches this ball is the mean over it.
        place = float(view.x[k]), float(view.y[k]), float(view.radius[k])
        patch = patch_of(*place, side, side)
        weight = None
        if patch is not None and look.readback == "footprint":
            weight = footprint_of(patch.q, kernel, look.footprint)
        mean = mean_of(pixels, *place, patch, look.readback, weight)
        reached[k] = 1.0 if mean is None else float(mean[0])
        # 3. Draw it: eq 27 at every pixel, c = 1 g + T c (eq 28).
        if patch is not None:
            set_uniforms(quads, ball_0=int(k), light=float(reached[k]))
            draw(quads, 1)
    everything = slice(0, side), slice(0, side)
    return reached, read_pixels(target, *everything)[..., 0].ravel()


class _Pixels:
    """The framebuffer's pixels as an array: each index reads that box back."""

    def __init__(self, target: Target) -> None:
        self.target = target
        self.shape = target.height, target.width, 4

    def __getitem__(self, index: tuple[Any, Any]) -> Array:
        rows, columns = (
            part if isinstance(part, slice) else slice(part, part + 1) for part in index
        )
        read = read_pixels(self.target, rows, columns)
        return read if isinstance(index[0], slice) else read[0, 0]


def _quads_for(kernel: Kernel, look: Look, albedo: float, forward: float) -> Any:
    """Compile the shaders for these rules, and tell them how light is scattered on."""
    quads = compiled(sunward_source(look, kernel))
    kappa = coupling_man2003(albedo, PHASE_MAN2003, solid_angle=look.solid_angle)
    limit = min(largest_steady_tau(kappa) + 1.0, FAR)
    set_uniforms(quads, forward=albedo * forward, kappa=kappa, limit=limit)
    return quads
