"""Pass 1 to the letter: read the mean back, draw the ball, ball after ball.

It defines the light that reaches every ball; `sweeps` finds the same light faster, and
tests hold both equal. Read this one first.
"""

from __future__ import annotations

import numpy as np

from refcloud.conventions import Array
from refcloud.lighting.lightview import LightView, handed_on
from refcloud.lighting.look import Look
from refcloud.raster import Framebuffer, framebuffer
from refcloud.raster.blending import blend_patch
from refcloud.raster.footprint import footprint_of, opacity_of, patch_of
from refcloud.raster.splat import mean_of


def carried_literally(
    view: LightView, tau: Array, albedo: float, look: Look, forward: float
) -> tuple[Array, Framebuffer]:
    """Run pass 1 for one light and one colour channel, unchecked.

    Formula: I_k = g_{k-1} + T_{k-1} I_{k-1}, I_1 = I_0

    Parameters
    ----------
    view
        The balls as the light sees them.
    tau
        Optical depth of each on its axis, shape (N,).
    albedo
        Scattered share of extinction.
    look
        The rules.
    forward
        k of the "split" rule.

    Returns
    -------
    The share of the light that reaches each ball, shape (N,), and the framebuffer.

    Source: paper M, eq 27 and 28, L04 to L09.
    """
    scatter = handed_on(look, albedo, forward)
    on_axis = scatter(tau)
    kernel, side = view.balls.kernel, view.side
    reached = np.zeros(len(tau))
    # 1. The buffer is filled with white, the unblocked light.
    buffer = framebuffer(side, side, color=np.ones(4))
    for k in view.order:
        place = float(view.x[k]), float(view.y[k]), float(view.radius[k])
        patch = patch_of(*place, side, side)
        weight = None
        if patch is not None:
            weight = footprint_of(patch.q, kernel, look.footprint)
        # 2. Read back: the light that reaches this ball is the mean over it.
        mean = mean_of(buffer.pixels, *place, patch, look.readback, weight)
        light = 1.0 if mean is None else float(mean[0])
        reached[k] = light
        # 3. Draw it: eq 27 at every pixel, c = 1 g + T c (eq 28).
        if patch is None or weight is None:
            continue
        source = np.empty((*weight.shape, 4))
        if look.transmittance == "linear":
            source[..., :3] = (weight * (light * on_axis[k]))[..., None]
        else:
            source[..., :3] = (scatter(weight * tau[k]) * light)[..., None]
        source[..., 3] = opacity_of(weight, float(tau[k]), look.transmittance)
        blend_patch(buffer.pixels[patch.rows, patch.columns], source)
    return reached, buffer
