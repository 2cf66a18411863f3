"""Blend formats: what a framebuffer of each format makes of many layers (E35).

Black layers lie over white; what is seen through n of them is (1 - alpha)^n. Each
format rounds after every layer, by the specification or as Mesa's llvmpipe does.
"""

from __future__ import annotations

import functools
from typing import get_args

import numpy as np

from refcloud.bench.subject import NS, Subject
from refcloud.bench.timing import Contender
from refcloud.conventions import Array
from refcloud.raster import blend, framebuffer
from refcloud.raster.formats import Arithmetic, Format
from refcloud.raster.framebuffer import linear_of

LAYERS, QUICK_LAYERS = (10, 100, 1000), (10, 100)
SMALL = 8  # pixels of a quick look's framebuffer, at most
THROUGH = 0.1  # of white: what is seen through all of them
WHOLE = slice(None)


def layered(format: Format, arithmetic: Arithmetic, layers: int, side: int) -> Array:
    """Blend layers over a white framebuffer, and give what is seen through them.

    Parameters
    ----------
    format, arithmetic
        Of the framebuffer.
    layers
        How many; all of one opacity.
    side
        Of the framebuffer, pixels.

    Returns
    -------
    One channel, linear, shape (side^2,).
    """
    buffer = framebuffer(
        side, side, color=np.ones(4), format=format, arithmetic=arithmetic
    )
    layer = np.zeros((side, side, 4))
    layer[..., 3] = 1.0 - THROUGH ** (1.0 / layers)
    over = "SRC_ALPHA", "ONE_MINUS_SRC_ALPHA"
    for _ in range(layers):
        blend(buffer, WHOLE, WHOLE, layer, *over)
    return linear_of(buffer.pixels, format)[..., 0].ravel()


def formats(side: int) -> list[Contender]:
    """List every format and rounding at every number of layers."""
    return [
        Contender(
            f"{layers:4d} layers",
            f"{format}, {arithmetic}" if format != "RGBA64F" else format,
            side * side * layers,
            functools.partial(layered, format, arithmetic, layers, side),
            lambda: np.full(side * side, THROUGH),
        )
        for layers in (QUICK_LAYERS if side <= SMALL else LAYERS)
        for format in get_args(Format)
        for arithmetic in get_args(Arithmetic)
        if (format, arithmetic) != ("RGBA64F", "llvmpipe")
    ]


BLEND = Subject(
    name="blend",
    title="framebuffer formats: what rounding makes of 10 to 1000 layers",
    about="CPU time per pixel and layer, medians; error: largest distance of what is"
    f" seen through all layers, {THROUGH:g} of white",
    lists=((formats, 48, 4),),
    unit=NS,
    digits=2,
    reference="(1 - alpha)^n in closed form",
)
