"""What a scattering rule puts on top of albedo times phase."""

from __future__ import annotations

import numpy as np

from refcloud.conventions import WHOLE_SPHERE, Array
from refcloud.lighting.depths import ball_depths
from refcloud.lighting.lightview import handed_on
from refcloud.lighting.look import Look
from refcloud.metaballs import Metaballs
from refcloud.optics import PHASE_MAN2003, Medium, coupling_man2003


def gain_of(balls: Metaballs, medium: Medium, look: Look) -> Array:
    """Give what the scattering rule puts on top of albedo times phase, unchecked.

    Parameters
    ----------
    balls, medium, look
        As `LitMetaballs` holds them.

    Returns
    -------
    Shape (N, 3), at least 0.
    """
    gain = np.ones((len(balls.radii), 3))
    if look.scattering == "split":
        return gain
    keys = zip(medium.albedo_rgb.tolist(), medium.sigma_t_rgb.tolist(), strict=True)
    found: dict[tuple[float, float], Array] = {}  # of a grey medium only one
    for channel, key in enumerate(keys):
        if key not in found:
            found[key] = _gain_man2003(ball_depths(balls, key[1], look), key[0], look)
        gain[:, channel] = found[key]
    return gain * (look.solid_angle / WHOLE_SPHERE)


def _gain_man2003(tau: Array, albedo: float, look: Look) -> Array:
    """Give depth as eq 26 counts it, held where pass 1 holds it, over the opacity."""
    kappa = coupling_man2003(albedo, PHASE_MAN2003, solid_angle=look.solid_angle)
    held = handed_on(look, albedo, 0.0)(tau)
    effective = np.divide(held, kappa, out=np.array(tau), where=kappa > 0.0)
    opacity = -np.expm1(-tau)
    thin = opacity <= 0.0
    return np.where(thin, 1.0, effective / np.where(thin, 1.0, opacity))
