"""What pixels see of balls, place by place in the world: exactly, all tiles at once.

The weight and the colour of each sample are those of `shading.ball_source`, the literal
form.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from refcloud.conventions import Array
from refcloud.lighting.erosion import eroded_of, lit_share_of
from refcloud.lighting.lightfield import field_value_of
from refcloud.lighting.seen import Seen
from refcloud.lighting.shaded_tiles import Looked
from refcloud.lighting.shading import FRONT, Shading, noise_at
from refcloud.raster.footprint import footprint_of
from refcloud.raster.tile_lists import PIXELS, SIDE, TileLists, Whole


class Covered(NamedTuple):
    """Pixels that one ball of each of T tiles covers, M in all.

    Attributes
    ----------
    at
        Their numbers in the batch of tiles, shape (M,).
    tile, row, column
        Numbers of the tiles, and of the rows and columns of pixels in the batch.
    q
        Squared distance from the ball's centre in the picture, in radii squared.
    right, up
        Its parts by column and by row, in radii, shape (T, 16).
    """

    at: Whole
    tile: Whole
    row: Whole
    column: Whole
    q: Array
    right: Array
    up: Array


def covered(
    lists: TileLists, live: Whole, ball: Whole, seen: Seen, open_: np.ndarray
) -> Covered:
    """Find the open pixels that one ball of each tile covers.

    Parameters
    ----------
    lists, seen
        The tiles, and the balls.
    live, ball
        Numbers of tiles, and of the ball of each.
    open_
        Pixels in which it could show, shape (T, 256).

    Returns
    -------
    The pixels.
    """
    step = np.arange(SIDE) + 0.5
    radius = seen.radius[ball][:, None]
    right = lists.column[live][:, None] * float(SIDE) + step
    right -= seen.x[ball][:, None]
    right /= radius
    up = seen.y[ball][:, None] - (lists.row[live][:, None] * float(SIDE) + step)
    up /= radius
    q = np.square(up)[:, :, None] + np.square(right)[:, None, :]
    q = q.ravel()
    at = np.flatnonzero((q < 1.0) & open_.ravel())
    tile, row = at // PIXELS, at // SIDE
    column = tile * SIDE + at % SIDE
    return Covered(at, tile, row, column, q.take(at), right, up)


class _Samples(NamedTuple):
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


class ExactPlaces:
    """Places that are looked at in double precision.

    Parameters
    ----------
    seen, shading
        What the eye sees, and what all balls share.
    """

    def __init__(self, seen: Seen, shading: Shading) -> None:
        self.seen, self.shading = seen, shading
        self.taus = [seen.tau[channels[0]] for channels in seen.channel_groups()]

    def at(
        self, lists: TileLists, live: Whole, ball: Whole, open_: np.ndarray
    ) -> Looked:
        """Look at one ball of each live tile, in pixels that are open."""
        found = self._samples(lists, live, ball, open_)
        opacity = []
        for tau in self.taus:
            depth = tau.take(found.ball)
            if self.shading.look.transmittance == "linear":
                opacity.append(found.weight * -np.expm1(-depth))
            else:
                opacity.append(-np.expm1(-depth * found.weight))
        return Looked(found.at, self._colours(found), opacity)

    def _samples(
        self, lists: TileLists, live: Whole, ball: Whole, open_: np.ndarray
    ) -> _Samples:
        """Find the pixels that one ball of each tile covers, and what they show."""
        seen, shading = self.seen, self.shading
        look, balls = shading.look, seen.lit.balls
        at, tile, row, column, q, right, up = covered(lists, live, ball, seen, open_)
        right, up = right.take(column), up.take(row)
        weight = footprint_of(q, balls.kernel, look.footprint)

        # The place lies half way from the ball's middle plane to its front surface.
        back = np.sqrt(1.0 - q)
        back *= FRONT
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
            return _Samples(at, number, points, weight, None)
        noise = noise_at(shading.detail, points, np.zeros(3))
        weight = eroded_of(weight, noise, look.erosion)
        kept = np.flatnonzero(weight > 0.0)  # nothing shows where all is taken
        at, number, weight, noise, *points = (
            a.take(kept) for a in (at, number, weight, noise, *points)
        )
        return _Samples(at, number, points, weight, noise)

    def _colours(self, found: _Samples) -> list[Array]:
        """Give the colour of each sample, red, green and blue of shape (M,)."""
        seen, shading = self.seen, self.shading
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
