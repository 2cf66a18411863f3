"""Tiles of balls whose footprint and colour vary with the place that a pixel shows.

Where a look erodes footprints or takes colours from a field, no product of matrices can
give the samples: each has its own place in the world. So the tiles are composited one
list slot at a time, from the front, on a list of just those pixels that the slot's
balls cover and that still let light pass. The weight and the colour of each sample are
those of `shading.ball_source`, the literal form.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from refcloud.conventions import Array
from refcloud.lighting.erosion import eroded_of, lit_share_of
from refcloud.lighting.flat_tiles import Drawn
from refcloud.lighting.lightfield import field_value_of
from refcloud.lighting.seen import Seen
from refcloud.lighting.shading import FRONT, Shading, noise_at
from refcloud.raster.footprint import footprint_of
from refcloud.raster.tile_lists import PIXELS, SIDE, TileLists, Whole

TILES = 256  # worked on together: calls are long, and samples stay near the processor


class Samples(NamedTuple):
    """Places where one ball of each tile is looked at, M in all.

    Attributes
    ----------
    at
        Numbers of the pixels in the batch of tiles, shape (M,).
    ball
        Number of the ball, shape (M,).
    points
        x, y and z in the world, each of shape (M,).
    weight
        Footprint, shape (M,).
    noise
        That erodes it, shape (M,); None where nothing does.
    """

    at: Whole
    ball: Whole
    points: list[Array]
    weight: Array
    noise: Array | None


def shaded_tiles(
    lists: TileLists,
    seen: Seen,
    drawn: Whole,
    shading: Shading,
    least: float,
) -> Drawn:
    """Composite the tiles of balls that are shaded place by place, unchecked.

    Parameters
    ----------
    lists
        The tiles' lists of positions in `drawn`.
    seen
        What the eye sees.
    drawn
        The balls that are drawn, near to far.
    shading
        What all balls share.
    least
        A pixel that lets no more than this share pass is complete.

    Returns
    -------
    What was drawn of the 256 pixels of each tile.
    """
    groups = seen.channel_groups()
    count = len(lists.count)
    light = np.zeros((count, 3, PIXELS))
    clear = np.ones((count, len(groups), PIXELS))
    unseen, closed = np.zeros(count, np.intp), 0
    ranked = np.argsort(-lists.count, kind="stable")  # lists of like length together
    for begin in range(0, count, TILES):
        batch = ranked[begin : begin + TILES]
        added = np.zeros((3, len(batch) * PIXELS))
        passed = np.ones((len(groups), len(batch) * PIXELS))
        for slot in range(int(lists.count[batch[0]])):
            # 1. One ball of each tile whose list goes on; where it could still show.
            live = batch[: np.count_nonzero(lists.count[batch] > slot)]
            open_ = passed[:, : len(live) * PIXELS].max(axis=0) > least
            hidden = ~open_.reshape(-1, PIXELS).any(axis=1)
            unseen[live] += hidden
            closed += int(np.count_nonzero(~open_)) - PIXELS * int(hidden.sum())
            ball = drawn[lists.ball[lists.first[live] + slot]]
            found = _samples(lists, live, ball, seen, shading, open_)
            if not len(found.at):
                continue
            # 2. Its colour and its opacity at each of these pixels.
            color = _colours(found, seen, shading)
            at = found.at
            for group, channels in enumerate(groups):
                tau = seen.tau[channels[0]].take(found.ball)
                if shading.look.transmittance == "linear":
                    opacity = found.weight * -np.expm1(-tau)
                else:
                    opacity = -np.expm1(-tau * found.weight)
                # 3. Under what lies in front: add F times that, and dim F.
                opacity *= passed[group].take(at)
                passed[group][at] -= opacity
                for channel in channels:
                    added[channel][at] += opacity * color[channel]
        light[batch] = added.reshape(3, -1, PIXELS).transpose(1, 0, 2)
        clear[batch] = passed.reshape(len(groups), -1, PIXELS).transpose(1, 0, 2)
    return Drawn(light, clear, unseen, closed)


def _samples(
    lists: TileLists,
    live: Whole,
    ball: Whole,
    seen: Seen,
    shading: Shading,
    open_: np.ndarray,
) -> Samples:
    """Find the pixels that one ball of each tile covers, and what they show of it."""
    look, balls = shading.look, seen.lit.balls
    step = np.arange(SIDE) + 0.5
    radius = seen.radius[ball][:, None]
    right = lists.column[live][:, None] * float(SIDE) + step
    right -= seen.x[ball][:, None]
    right /= radius
    up = seen.y[ball][:, None] - (lists.row[live][:, None] * float(SIDE) + step)
    up /= radius
    q = np.square(up)[:, :, None] + np.square(right)[:, None, :]
    at = np.flatnonzero(open_ & (q < 1.0).ravel())
    tile = at // PIXELS
    q = q.ravel().take(at)
    weight = footprint_of(q, balls.kernel, look.footprint)

    # The place lies half way from the ball's middle plane to its front surface.
    back = np.sqrt(1.0 - q)
    back *= FRONT
    right = right.ravel().take(tile * SIDE + at % SIDE)
    up = up.ravel().take(at // SIDE)
    per_right, per_up, per_back = shading.frame
    points = []
    for a in range(3):
        place = per_back[a] * back
        place += per_up[a] * up
        place += per_right[a] * right
        place *= balls.radii[ball].take(tile)
        place += balls.centers[ball, a].take(tile)
        points.append(place)
    number = ball.take(tile)
    if shading.detail is None:
        return Samples(at, number, points, weight, None)
    noise = noise_at(shading.detail, points, np.zeros(3))
    weight = eroded_of(weight, noise, look.erosion)
    kept = np.flatnonzero(weight > 0.0)  # nothing shows where all is taken
    at, number, weight, noise, *points = (
        a.take(kept) for a in (at, number, weight, noise, *points)
    )
    return Samples(at, number, points, weight, noise)


def _colours(found: Samples, seen: Seen, shading: Shading) -> list[Array]:
    """Give the colour of each sample, red, green and blue of shape (M,)."""
    own = seen.colours.reshape(len(seen.colours), -1).take(found.ball, axis=0)
    light = own
    if shading.field is not None:
        x, y, z = (
            (p - low) / shading.field.spacing
            for p, low in zip(found.points, shading.field.lower, strict=True)
        )
        light = field_value_of(shading.field, x, y, z, own)
    light = np.ascontiguousarray(light.T)
    color = light[-3:]
    relief = shading.look.relief
    for s, toward in enumerate(shading.toward):
        sunlit = light[3 * s : 3 * s + 3]
        if found.noise is not None and shading.detail is not None and relief > 0.0:
            ahead = noise_at(shading.detail, found.points, toward)
            sunlit *= lit_share_of(found.noise, ahead, relief)
        color += sunlit
    clear = seen.clear.take(found.ball)
    color *= clear
    return [c + air * (1.0 - clear) for c, air in zip(color, seen.air, strict=True)]
