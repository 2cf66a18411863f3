"""Clouds of a layer from one number a pixel: where they are, how solid, how light.

Noise above a threshold is cloud, so the threshold sets how much of the sky is open.
Opacity and light are both linear in the noise. With both slopes positive clouds are
brightest where they are thickest, the document's first try; with the light's slope
negative they have light edges and a darker middle.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import check_fields, checked
from refcloud.conventions import Array, Range, Shape

Numbers = Annotated[Array, Shape("..."), Range()]
Reading = Literal["opacity", "printed"]


@dataclass(frozen=True)
class Cover:
    """How noise becomes cloud; the defaults have slopes of opposite signs.

    Attributes
    ----------
    threshold
        Noise below it is open sky.
    opacity_slope
        Opacity per noise above the threshold.
    light
        Light at the threshold, a cloud's edge; 1 is white.
    light_slope
        Light per noise above the threshold; negative is darker where more solid.
    least_light
        What light is left at the least.
    reading
        What the document's "transparency" is: "opacity", or "printed", by which the
        slope makes clouds clear where noise is high (E37).
    """

    threshold: Annotated[float, Range(-2.0, 2.0, "noise")] = 0.0
    opacity_slope: Annotated[float, Range(0.0, 1e6, "1/noise")] = 4.0
    light: Annotated[float, Range(0.0, 100.0, "radiance")] = 1.0
    light_slope: Annotated[float, Range(-1e6, 1e6, "radiance/noise")] = -0.9
    least_light: Annotated[float, Range(0.0, 100.0, "radiance")] = 0.0
    reading: Reading = "opacity"

    def __post_init__(self) -> None:
        check_fields(self)


# The document's first try: more noise is more opaque and lighter.
SAME_SIGN = Cover(light=0.25, light_slope=1.5)


@checked
def cloud_cover(noise: Numbers, cover: Cover) -> tuple[Array, Array]:
    """Turn noise into the light and the opacity of a layer of clouds.

    Formula: e = noise - threshold; opacity = clip(opacity_slope e, 0, 1), light =
    max(light + light_slope max(e, 0), least_light)

    Parameters
    ----------
    noise
        Values of a fractal sum, any shape.
    cover
        Threshold and slopes.

    Returns
    -------
    Light, at least 0, and opacity, in [0, 1], both of the same shape.

    Source: document S, section 5.1 (V06, V07); E37.

    Examples
    --------
    >>> light, opacity = cloud_cover([-0.1, 0.05, 0.5], Cover(light_slope=-1.0))
    >>> light, opacity
    (array([1.  , 0.95, 0.5 ]), array([0. , 0.2, 1. ]))
    """
    above = noise - cover.threshold
    share = np.clip(cover.opacity_slope * above, 0.0, 1.0)
    if cover.reading == "printed":
        share = 1.0 - share
    light = cover.light + cover.light_slope * np.maximum(above, 0.0)
    return np.maximum(light, cover.least_light), share
