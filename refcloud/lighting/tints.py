"""Light of one colour: one number of each ball tells what all channels show.

Balls under one sun, with no other light, differ in brightness alone: their colours are
multiples of one colour, grey where the sun and the cloud are. A picture of such balls
is a picture of their brightness, times that colour.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from refcloud.conventions import Array

# Products of a colour and a brightness differ from multiples by their own rounding.
ROUNDED = 2.0**-50


class Tinted(NamedTuple):
    """Lights that are drawn, and what the channels show of them.

    Attributes
    ----------
    lights
        Shape (L, N).
    shown
        Of each channel the number of its light, and the share of that which it shows,
        in [0, 1].
    """

    lights: Array
    shown: tuple[tuple[int, float], ...]


def tinted(colours: Array) -> Tinted:
    """Give one light for channels that are multiples of one another, else each its own.

    Parameters
    ----------
    colours
        Of the balls, at least 0, shape (C, N).

    Returns
    -------
    The brightest channel alone and the others' shares of it, to `ROUNDED` of every
    colour; or all channels as they are.
    """
    most = colours.max(axis=1, initial=0.0)
    lead = int(np.argmax(most))
    if len(colours) > 1 and most[lead] > 0.0:
        light, shares = colours[lead], (most / most[lead]).tolist()
        if all(
            (np.abs(light * share - channel) <= ROUNDED * channel).all()
            for share, channel in zip(shares, colours, strict=True)
        ):
            return Tinted(light[None], tuple((0, share) for share in shares))
    return Tinted(colours, tuple((k, 1.0) for k in range(len(colours))))
