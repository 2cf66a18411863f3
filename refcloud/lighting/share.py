"""The share of one light that reaches each ball, carried as suits its view."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from refcloud.conventions import Array, Observer
from refcloud.lighting.depths import ball_depths
from refcloud.lighting.fragments import fragments, fragments_per_ball
from refcloud.lighting.in_turn import carried_in_turn
from refcloud.lighting.light_tiles import light_tiles
from refcloud.lighting.lightview import LightView
from refcloud.lighting.look import Look
from refcloud.lighting.sweeps import ROUNDED, carried, largest_gain
from refcloud.optics import Medium
from refcloud.raster import framebuffer

# Errors of a share that float32 may use up: lists of hundreds of balls round below it.
LEAST_FLOAT32 = 3e-4
# Nanoseconds for a ball whose turn it is, for listing one of its pixels, and for one
# pixel in one sweep; and how many sweeps there are, of those that the largest gain
# promises, which counts as `MOST_COUNTED` at most. Measured on clouds of 100 to 11,000
# balls with gains of 0.2 to 0.86: times within a third, sweeps within a half.
TURN, LISTED, SWEPT = 26_000.0, 67.0, 6.3
NEEDED, MOST_COUNTED = 0.4, 0.9
MOST_ROUGH = 2.0 / 3.0  # of what is allowed: what roundings of tiles may do
MOST_GAIN = 0.9  # and gains that do not magnify these roundings more than tenfold
# Carries one light over one channel, ball after ball, as `carried_in_turn` does.
Carry = Callable[[LightView, Array, float, Look, float], tuple[Array, Array]]


class Sweeps(NamedTuple):
    """How often one light was swept over one channel, and the error that is left."""

    number: int
    bound: float


def light_share(
    view: LightView,
    medium: Medium,
    look: Look,
    forward: float,
    most: float,
    watch: Observer | None,
    carry: Carry | None = None,
) -> tuple[Array, list[Sweeps]]:
    """Give the share of one light that reaches each ball, unchecked.

    Parameters
    ----------
    view
        The balls as the light sees them.
    medium, look
        As `sunward`.
    forward
        k of the "split" rule.
    most
        Largest error of a share.
    watch
        Called with (name, value); None for nobody.
    carry
        How the light is carried; None for the fastest way in numpy.

    Returns
    -------
    Shape (N, 3), at least 0; and the sweeps of each channel.
    """
    # A grey medium is carried once, a coloured one channel by channel.
    channels: dict[tuple[float, float], list[int]] = {}
    keys = zip(medium.sigma_t_rgb.tolist(), medium.albedo_rgb.tolist(), strict=True)
    for channel, key in enumerate(keys):
        channels.setdefault(key, []).append(channel)
    depths = {key: ball_depths(view.balls, key[0], look) for key in channels}
    kappa = max(largest_gain(depths[key], key[1], look, forward) for key in channels)
    rounds = most >= LEAST_FLOAT32 and kappa <= MOST_GAIN
    found = None
    if carry is None and rounds:
        found = light_tiles(view, look, np.max(list(depths.values()), axis=0))
        if found is not None and found.rough > MOST_ROUGH * (1.0 - kappa) * most:
            found = None
    turns = in_turn_is_sooner(fragments_per_ball(view), kappa, most)
    if carry is None and found is None and not turns:
        found = fragments(view, look, np.float32 if rounds else np.float64)
    share = np.empty((len(view.radius), 3))
    sweeps: list[Sweeps] = []
    for key, tau in depths.items():
        if watch:
            watch("order", view.order)
        if found is None:
            in_turn = carry or carried_in_turn
            reached, plane = in_turn(view, tau, key[1], look, forward)
        else:
            result = carried(found, tau, key[1], look, forward, most)
            sweeps.append(Sweeps(len(result.changes), result.bound))
            reached = result.reached
            plane = None
            if watch:
                plane = np.ones(view.side**2 + 1)  # one more for all outside
                plane[found.pixel] = result.buffer
                plane = plane[:-1]
        if watch and plane is not None:
            buffer = framebuffer(view.side, view.side, color=np.ones(4))
            buffer.pixels[..., :3] = plane.reshape(view.side, view.side, 1)
            watch("buffer", buffer)
        share[:, channels[key]] = reached[:, None]
    return share, sweeps


def in_turn_is_sooner(pixels: float, kappa: float, most: float) -> bool:
    """Tell whether one ball after the other takes less time than sweeps over all.

    Parameters
    ----------
    pixels
        That a ball covers, on the mean.
    kappa
        Of `largest_gain`: a sweep leaves that share of the error at most.
    most
        Largest error of a share.

    Returns
    -------
    Whether it does. Only time depends on whether that is true.
    """
    sweeps = 1.0
    if kappa > 0.0:
        gain = min(kappa, MOST_COUNTED)
        left = max(most, ROUNDED) * (1.0 - gain) / gain
        sweeps = max(NEEDED * math.log(left) / math.log(gain), 1.0)
    return pixels * (LISTED + sweeps * SWEPT) > TURN
