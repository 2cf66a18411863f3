"""Many thin layers, one over the other: where a format of few digits stalls (E35)."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Range
from refcloud.raster.blending import blended_as
from refcloud.raster.factors import OVER
from refcloud.raster.formats import Arithmetic, Format


@checked
def seen_through_layers(
    alpha: Annotated[float, Range(0.0, 1.0)],
    layers: Annotated[int, Range(0, 100_000)],
    *,
    format: Format,
    arithmetic: Arithmetic = "ideal",
) -> Array:
    """Blend black layers over white and say what is seen after each.

    Formula: v_k = (1 - alpha) v_{k-1}, v_0 = 1, rounded by the format. RGBA8 stops
    where 255 v alpha < 1/2: the product then rounds back to where it was

    Parameters
    ----------
    alpha
        Opacity of one layer, in [0, 1].
    layers
        How many.
    format, arithmetic
        Of the framebuffer.

    Returns
    -------
    The red channel before the first layer and after each, shape (layers + 1,).

    Source: paper M, eq 28; E35.

    Examples
    --------
    >>> for format in ("RGBA32F", "RGBA8"):
    ...     print(seen_through_layers(1 / 255, 1000, format=format)[-1].round(4))
    0.0197
    0.498
    """
    layer, pixel = np.array([0.0, 0.0, 0.0, alpha]), np.ones(4)
    seen = np.ones(layers + 1)
    for k in range(layers):
        pixel = blended_as(layer, pixel, OVER, format, arithmetic)
        seen[k + 1] = pixel[0]
    return seen
