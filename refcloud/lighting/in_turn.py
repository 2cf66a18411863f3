"""Pass 1 ball after ball on the one channel that matters: for wide balls.

The literal loop without what it does for show: no alpha, no three equal channels, no
general blending. Where balls cover many pixels each, that beats `sweeps`.
"""

from __future__ import annotations

import numpy as np

from refcloud.conventions import Array
from refcloud.lighting.lightview import LightView, handed_on
from refcloud.lighting.look import Look
from refcloud.raster.footprint import footprint_of, opacity_of, patch_of
from refcloud.raster.splat import mean_of


def carried_in_turn(
    view: LightView, tau: Array, albedo: float, look: Look, forward: float
) -> tuple[Array, Array]:
    """Run pass 1 for one light and one colour channel, unchecked.

    Parameters
    ----------
    view, tau, albedo, look, forward
        As `carried_literally`.

    Returns
    -------
    The share of the light that reaches each ball, shape (N,), and the buffer of one
    channel, shape (side, side).
    """
    scatter = handed_on(look, albedo, forward)
    on_axis = scatter(tau)
    linear, own_area = look.transmittance == "linear", look.readback == "footprint"
    kernel, side = view.balls.kernel, view.side
    reached = np.ones(len(tau))
    buffer = np.ones((side, side))
    every = buffer[..., None]  # as `mean_of` reads it
    for k in view.order:
        place = float(view.x[k]), float(view.y[k]), float(view.radius[k])
        patch = patch_of(*place, side, side)
        weight = None
        if patch is not None:
            weight = footprint_of(patch.q, kernel, look.footprint)
        # 1. Read: the footprint's own mean is one product, others are as they are.
        total = float(weight.sum()) if own_area and weight is not None else 0.0
        if patch is not None and weight is not None and total > 0.0:
            here = buffer[patch.rows, patch.columns]
            reached[k] = np.einsum("ij,ij->", weight, here) / total
        else:
            mean = mean_of(every, *place, patch, look.readback, weight)
            reached[k] = 1.0 if mean is None else float(mean[0])
        if patch is None or weight is None:
            continue
        # 2. Dim what is there, add what the ball scatters on: c = g I + T c.
        here = buffer[patch.rows, patch.columns]
        here *= 1.0 - opacity_of(weight, float(tau[k]), look.transmittance)
        if linear:
            weight *= on_axis[k]
        else:
            weight = scatter(weight * tau[k])
        weight *= reached[k]
        here += weight
    return reached, buffer
