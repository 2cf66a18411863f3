"""What pixels see of balls, place by place in the world: in single precision, proved.

The idea: where a pixel looks is known in float64, what it sees there is float32. Places
are counted in cells of the table of noise, so that a table is read without a change of
units; tables and what comes of them are half as large, and half as long on the way.

Proved, with u = 2^-24, the largest relative error of one rounding:

* A table's values lie in [0, 1], and so do the fractions of a cell. One linear step
  between two values rounds by 1.5 u, its fraction by half a u; three steps on a rounded
  table are off by less than 7 u. A noise is off by NOISE u.
* Erosion cuts lo = e (1 - n) away, which is off by (7.5 e + 1) u; the weight left grows
  by no more than 1.3 / (1.3 - e) of that. With the roundings on the way a weight is off
  by D = (1.3 (7.5 e + 3) / (1.3 - e) + 3) u at most, and an opacity by tau D + 5 u.
  Weights that come out as 0 are kept where the exact ones may be above.
* Means of light are sums of terms that are not negative: no digits cancel, and with 8
  factors each they are right to 12 u of themselves. With relief and haze a colour is
  right to COLOR u of the brightest.

Opacities a_k and colours c_k make the picture sum_k F_k a_k c_k. Changed from the
farthest ball on, one after the other, they change it by

    sum_k F_k |da_k| brightest + max_k |dc_k|

with the F of what is drawn: `shaded_tiles` sums F_k |da_k| as it goes, in each pixel.
"""

from __future__ import annotations

import numpy as np

from refcloud.conventions import Array
from refcloud.lighting.erosion import SOFT, lit_share_of
from refcloud.lighting.exact_places import covered
from refcloud.lighting.seen import Seen
from refcloud.lighting.shaded_tiles import Looked
from refcloud.lighting.shading import FRONT, Shading
from refcloud.lighting.single_tables import Rows, Table, in_rows
from refcloud.raster.footprint import footprint_of
from refcloud.raster.quadratics import Floats
from refcloud.raster.tile_lists import TileLists, Whole

ROUNDING = 2.0**-24
NOISE, COLOR = 7.0, 28.0  # roundings: see above
DEEPEST = 1e30  # optical depths above show nothing else, and leave room for products


def weight_doubt(erosion: float) -> float:
    """Bound what rounding does to an eroded weight.

    Parameters
    ----------
    erosion
        Of the look.
    """
    if not erosion > 0.0:
        return ROUNDING
    low = (NOISE + 0.5) * erosion + 3.0
    return ((1.0 + SOFT) / (1.0 + SOFT - erosion) * low + 3.0) * ROUNDING


class SinglePlaces:
    """Places that are looked at in single precision.

    Parameters
    ----------
    seen, shading
        As `ExactPlaces`.
    """

    def __init__(self, seen: Seen, shading: Shading) -> None:
        self.seen, self.look = seen, shading.look
        self.beer = self.look.transmittance != "linear"
        balls, field, detail = seen.lit.balls, shading.field, shading.single
        # 1. What a ball hides, and what rounding may change of it.
        erosion = self.look.erosion if detail is not None else 0.0
        self.slack = np.float32(((NOISE + 0.5) * erosion + 3.0) * ROUNDING)
        strong = [
            np.minimum(tau, DEEPEST) if self.beer else -np.expm1(-tau)
            for tau in (seen.tau[channels[0]] for channels in seen.channel_groups())
        ]
        self.strong = [each.astype(np.float32) for each in strong]
        self.doubt = [each * weight_doubt(erosion) + 5.0 * ROUNDING for each in strong]
        self.clear = seen.clear.astype(np.float32)
        self.hazed = bool((seen.clear != 1.0).any())
        own = seen.colours.reshape(len(seen.colours), -1)
        self.own = in_rows(own)
        # 2. Balls' places in cells of the noise, or in nodes of the light.
        self.detail = self.field = None
        if detail is not None:
            cell = np.full(3, detail.spacing)
            first = detail.lower + 0.5 * cell
            self.detail = Table(detail.values)
        elif field is not None:
            cell, first = np.full(3, field.spacing), field.lower
        else:
            cell, first = np.ones(3), np.zeros(3)
        self.centers = ((balls.centers - first) / cell).T.copy()
        self.frame = shading.frame / cell  # right, up and back of a radius of 1
        self.toward = shading.toward / cell
        if field is not None:
            self.field = Rows(field.sums, own)
            self.to_nodes = (
                cell / field.spacing,
                (first - field.lower) / field.spacing,
            )

    def at(
        self, lists: TileLists, live: Whole, ball: Whole, open_: np.ndarray
    ) -> Looked:
        """Look at one ball of each live tile, in pixels that are open."""
        balls, look = self.seen.lit.balls, self.look
        at, tile, row, column, q, right, up = covered(
            lists, live, ball, self.seen, open_
        )
        weight = footprint_of(q, balls.kernel, look.footprint).astype(np.float32)
        # 1. Where each pixel looks: half way from the middle plane to the front.
        places: list[Array] = []
        if self.detail is not None or self.field is not None:
            back = np.sqrt(np.subtract(1.0, q, out=q), out=q)
            back *= FRONT
            for a, center in enumerate(self.centers):
                per_right, per_up, per_back = self.frame[:, a, None] * balls.radii[ball]
                place = back * per_back.take(tile)
                place += (up * per_up[:, None] + center[ball][:, None]).take(row)
                place += (right * per_right[:, None]).take(column)
                places.append(place)
        number = ball.take(tile)
        # 2. What the noise there leaves of the footprint.
        noise = None
        if self.detail is not None:
            noise = self.detail.at(places)
            low = np.subtract(np.float32(1.0), noise)
            low *= np.float32(look.erosion)
            weight -= low
            kept = np.flatnonzero(weight > -self.slack)
            at, number = at.take(kept), number.take(kept)
            weight, noise, low = (a.take(kept) for a in (weight, noise, low))
            places = [place.take(kept) for place in places]
            np.maximum(weight, np.float32(0.0), out=weight)
            weight *= np.float32(1.0 + SOFT)
            weight /= np.subtract(np.float32(1.0 + SOFT), low, out=low)
        # 3. Opacities, and what rounding may change of each.
        opacity = []
        for strong in self.strong:
            hidden = strong.take(number)
            hidden *= weight
            if self.beer:
                np.negative(hidden, out=hidden)
                np.expm1(hidden, out=hidden)
                np.negative(hidden, out=hidden)
            opacity.append(hidden)
        doubt = [each.take(number) for each in self.doubt]
        return Looked(at, self._colours(number, places, noise), opacity, doubt)

    def _colours(
        self, number: Whole, places: list[Array], noise: Floats | None
    ) -> list[Floats]:
        """Give the colour of each sample, red, green and blue of shape (M,)."""
        look, channels = self.look, 3 * (1 + len(self.toward))
        if self.field is None:
            rows = self.own.take(number, axis=0)
        else:
            nodes = [
                place * scale + shift
                for place, scale, shift in zip(places, *self.to_nodes, strict=True)
            ]
            rows = self.field.at(nodes, number)
        light = np.ascontiguousarray(rows[:, :channels].T)
        color = light[-3:]
        for s, toward in enumerate(self.toward):
            sunlit = light[3 * s : 3 * s + 3]
            if noise is not None and self.detail is not None and look.relief > 0.0:
                ahead = self.detail.at(
                    [p + step for p, step in zip(places, toward, strict=True)]
                )
                sunlit *= lit_share_of(noise, ahead, look.relief)
            color += sunlit
        if not self.hazed:
            return list(color)
        clear = self.clear.take(number)
        color *= clear
        np.subtract(np.float32(1.0), clear, out=clear)
        air = self.seen.air.astype(np.float32)
        return [c + a * clear for c, a in zip(color, air, strict=True)]
