"""Light scattered many times, guessed from light scattered once: octaves of scattering.

Single scattering alone is a dark cloud. Light that is scattered n more times gets
deeper, loses its direction and gets weaker; so each octave is single scattering again,
in a medium that dims the sun less, with lobes that are rounder, and with less weight.
It is an approximation by name: nothing but the first octave is derived. What holds of
it: suns add up, no light comes from none, one octave without the backward lobe is
single scattering to the letter, and thinner media tend to the sum of all lobes.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from refcloud.checking import check_fields, checked
from refcloud.conventions import Array, Colour, Range, Shape
from refcloud.lighting.look import GROUND_LIGHT, SKY_LIGHT
from refcloud.optics import henyey_greenstein
from refcloud.optics.media import Share

Mean = Annotated[float, Range(-1.0, 1.0, open_lower=True, open_upper=True)]


@dataclass(frozen=True)
class Octaves:
    """How much light each octave of scattering sends, and how it is spread.

    Attributes
    ----------
    orders
        N, number of octaves; 1 is single scattering.
    extinction
        a: octave n sees the optical depth toward the sun times a^n.
    contribution
        b: octave n counts b^n times.
    narrowing
        c: octave n has the mean cosine g c^n.
    backward
        Mean cosine of the backward lobe, in -g.
    backward_share
        Share of the light that goes into the backward lobe.
    sky_light, ground_light
        Radiance from straight above and below, RGB; both zero is off.
    sky_extinction
        Factor on the optical depth that these two see.
    """

    orders: Annotated[int, Range(1, 16)] = 4
    extinction: Share = 0.5
    contribution: Share = 0.5
    narrowing: Share = 0.6
    backward: Share = 0.25
    backward_share: Share = 0.3
    sky_light: Colour = field(default_factory=lambda: SKY_LIGHT)
    ground_light: Colour = field(default_factory=lambda: GROUND_LIGHT)
    sky_extinction: Share = 0.35

    def __post_init__(self) -> None:
        check_fields(self)


# Single scattering, as `refcloud.march.integrate` computes it.
SINGLE = Octaves(1, backward_share=0.0, sky_light=np.zeros(3), ground_light=np.zeros(3))


@checked
def octave_lobe(
    cos_theta: Annotated[Array, Shape("..."), Range(-1.0, 1.0)],
    n: Annotated[int, Range(0, 15)],
    *,
    g: Mean,
    octaves: Octaves,
) -> Array:
    """Give the phase function of an octave: a forward lobe and a backward one.

    Formula: (1 - m) HG(cos_theta, g c^n) + m HG(cos_theta, -k g c^n), with m the
    backward share, k its mean cosine

    Parameters
    ----------
    cos_theta
        Cosine between the direction the light travels and the one it leaves in, any
        shape.
    n
        Which octave, counted from 0.
    g
        Mean cosine of the first octave's forward lobe.
    octaves
        The numbers c, m and k.

    Returns
    -------
    The same shape, 1 / steradian; the integral over the sphere is 1.

    Source: document D (R04), in octaves; an extension after Wrenninge, Kulla and
    Lundqvist, "Oz: The Great and Volumetric", 2013.

    Examples
    --------
    >>> bool(octave_lobe([1.0], 3, g=0.6, octaves=Octaves()) < 0.2)
    True
    """
    narrow = g * octaves.narrowing**n
    ahead = henyey_greenstein(cos_theta, narrow)
    if octaves.backward_share == 0.0:
        return ahead
    behind = henyey_greenstein(cos_theta, -octaves.backward * narrow)
    return ahead + octaves.backward_share * (behind - ahead)


@checked
def octave_source(
    cos_theta: Annotated[Array, Shape("..."), Range(-1.0, 1.0)],
    tau: Annotated[Array, Shape("..."), Range(0.0)],
    *,
    g: Mean,
    albedo: Share,
    octaves: Octaves,
) -> Array:
    """Give the radiance per unit of irradiance and optical depth at a place.

    Formula: sum of albedo^(n + 1) b^n p_n(cos_theta) exp(-a^n tau) for n < N

    Parameters
    ----------
    cos_theta
        Cosine between the direction the light travels and the one it leaves in.
    tau
        Optical depth between the place and the sun; the two shapes broadcast.
    g
        Mean cosine of the first octave's forward lobe.
    albedo
        Scattered share of extinction: once for each time that light is scattered.
    octaves
        The numbers a, b and N, and the lobes p_n of `octave_lobe`.

    Returns
    -------
    The broadcast shape, 1 / steradian.

    Source: document D (R05), in octaves; an extension after Wrenninge, Kulla and
    Lundqvist, "Oz: The Great and Volumetric", 2013.

    Examples
    --------
    >>> both = octave_source([0.5, 0.5], [0.0, 9.0], g=0.6, albedo=1, octaves=Octaves())
    >>> bool(both[1] > both[0] * np.exp(-9.0))
    True
    """
    total = np.zeros(np.broadcast_shapes(cos_theta.shape, tau.shape))
    for n in range(octaves.orders):
        weight = albedo ** (n + 1) * octaves.contribution**n
        if weight == 0.0:
            break
        lobe = octave_lobe(cos_theta, n, g=g, octaves=octaves)
        total += weight * lobe * np.exp(-(octaves.extinction**n) * tau)
    return total


@checked
def sky_source(
    above: Annotated[Array, Shape("..."), Range(0.0)],
    below: Annotated[Array, Shape("..."), Range(0.0)],
    *,
    octaves: Octaves,
) -> Array:
    """Give the radiance per unit of optical depth that sky and ground light up.

    Formula: sky_light exp(-k tau_above) + ground_light exp(-k tau_below)

    Parameters
    ----------
    above, below
        Optical depth straight up and straight down, shapes that broadcast.
    octaves
        The two lights, and k, the factor on the depths.

    Returns
    -------
    RGB, shape (..., 3).

    Source: an extension of document D, as `refcloud.Look` has it.

    Examples
    --------
    >>> deep = sky_source([500.0], [500.0], octaves=Octaves())
    >>> bool(deep.max() < 1e-60)
    True
    """
    k = octaves.sky_extinction
    up, down = np.exp(-k * np.asarray(above)), np.exp(-k * np.asarray(below))
    return up[..., None] * octaves.sky_light + down[..., None] * octaves.ground_light
