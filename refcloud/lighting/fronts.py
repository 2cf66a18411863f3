"""Opaque fronts: what shows through them is not looked at, but given a middle colour.

A pixel that lets no more than F pass shows F X beside what was drawn already, where X
is a mean of colours of balls and of the background: it lies between the lowest and the
highest of these. With the middle between them in place of X a channel is off by F times
half their distance at most, whatever stands behind.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from refcloud.conventions import Array
from refcloud.lighting.flat_tiles import Drawn
from refcloud.lighting.seen import Seen


def hull_of(seen: Seen, background: Array | None) -> tuple[Array, Array]:
    """Give the lowest and the highest colour that any place can show, by channel.

    Each light at a place is a mean of that of balls (or that of its own ball); relief
    keeps a share of the suns' back, air mixes its own colour in.

    Parameters
    ----------
    seen
        What the eye sees.
    background
        What stands behind, shape (H, W, 3); None for nothing, that is 0.

    Returns
    -------
    Both of shape (3,).
    """
    look = seen.lit.look
    kept = 1.0 - look.relief if look.erosion > 0.0 else 1.0
    lights = seen.colours
    low, high = np.zeros(3), np.zeros(3)
    if len(lights):
        least, most = lights.min(axis=0), lights.max(axis=0)
        ends = seen.clear.min(), seen.clear.max()
        low = least[-1] + kept * least[:-1].sum(axis=0)
        low = np.minimum(*(low * c + seen.air * (1.0 - c) for c in ends))
        high = most.sum(axis=0)
        high = np.maximum(*(high * c + seen.air * (1.0 - c) for c in ends))
    if background is None:
        return np.zeros(3), high
    planes = [background[..., channel] for channel in range(3)]  # in one piece, mostly
    return (
        np.minimum(low, [plane.min() for plane in planes]),
        np.maximum(high, [plane.max() for plane in planes]),
    )


def half_width(low: Array, high: Array, over: bool) -> float:
    """Give half the distance between the ends of the widest channel.

    Parameters
    ----------
    low, high
        Of `hull_of`.
    over
        Whether there is a background; before none alpha, from 0 to 1, is a channel.
    """
    return max(0.5 * float((high - low).max()), 0.0 if over else 0.5)


def fill(
    found: Drawn,
    groups: Sequence[Sequence[int]],
    least: float,
    low: Array,
    high: Array,
    over: bool,
) -> None:
    """Put the middle colour behind complete pixels, in place.

    Parameters
    ----------
    found
        Tiles.
    groups
        Channels of one extinction each.
    least
        A pixel that lets no more than this share pass is complete.
    low, high
        Of `hull_of`.
    over
        Whether a background follows: it is in the middle already. Before nothing half
        of what passes counts as opaque.
    """
    light, clear = found.light, found.clear
    tile, pixel = np.nonzero(clear.max(axis=1) <= least)
    for group, channels in enumerate(groups):
        passed = clear[tile, group, pixel]
        for channel in channels:
            light[tile, channel, pixel] += passed * (0.5 * (low + high)[channel])
        clear[tile, group, pixel] = 0.0 if over else 0.5 * passed
