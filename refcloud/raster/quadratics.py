"""Wyvill footprints of many balls at the same places of many tiles, as a product.

Inside a tile p = 1 - (distance / radius)^2 is a quadratic in the place,

    p = 1 - cx^2 - cy^2 + 2 cx x / r + 2 cy y / r - (x^2 + y^2) / r^2

with the ball's centre (cx, cy) from the tile's middle in radii r: four numbers of the
ball times 1, x, y and x^2 + y^2 of the places.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.metaballs.kernels import WYVILL_CHORD
from refcloud.raster.footprint import PER_AXIS, Law
from refcloud.raster.tile_lists import SIDE, Discs, TileLists, Whole

Floats = NDArray[np.floating]
EXACT = 1e-13  # of an opacity: what rounding may change in float64


@dataclass(frozen=True)
class Form:
    """A Wyvill footprint as w = leading p^power (p + shift)."""

    leading: float
    power: float
    shift: float

    def times_power(self, v: Floats, factor: Floats) -> None:
        """Multiply `factor` by v^power in place; v is lost."""
        if self.power == 2.5:
            factor *= np.sqrt(v)
        factor *= np.square(v, out=v)


_C5, _C7 = (float(c) for c in WYVILL_CHORD)
FORMS = {
    "profile": Form(4.0 / 9.0, 2.0, 5.0 / 4.0),
    "chord": Form(_C7 * PER_AXIS["wyvill"], 2.5, _C5 / _C7),
}


def cancelling(
    discs: Discs, tau: Array, law: Law, *, most: float = EXACT, dtype: type = np.float64
) -> NDArray[np.bool_]:
    """Tell which balls' opacities four rounded numbers would change too much.

    The terms of p are up to (1 + d / r)^2 together where d, half a tile's diagonal, is
    their distance from its middle; each is rounded four times, by half an eps. Opacity
    rises with p by 3 tau at most, and by 1.7 sqrt(tau), for chord and profile; by 3 in
    the linear law.

    Parameters
    ----------
    discs, tau, law, dtype
        As `composite`.
    most
        Largest change of an opacity.

    Returns
    -------
    Shape (N,).
    """
    with np.errstate(over="ignore"):  # beyond all numbers is too much as well
        terms = np.square(1.0 + SIDE * math.sqrt(0.5) / discs.radius)
        deep = np.minimum(3.0 * np.minimum(tau, 1.0), 1.7 * np.sqrt(tau))
        steep = np.full(len(tau), 3.0) if law == "linear" else deep
        return 2.0 * float(np.finfo(dtype).eps) * terms * steep > most


class Quadratics:
    """The pairs of `lists` as four numbers each, and their products with places.

    Parameters
    ----------
    lists, discs
        The tiles' lists, and the balls near to far.
    strength
        What w is multiplied by, shape (N,): `taken` gives -strength w.
    form
        The footprint.
    places
        x and y of the S places from a tile's middle, pixels.
    direct
        Balls whose four numbers would cancel, shape (N,): for them p is computed from
        each place's own distance to the centre.
    dtype
        Of the products; the numbers themselves are formed in float64.
    """

    def __init__(
        self,
        lists: TileLists,
        discs: Discs,
        strength: Array,
        form: Form,
        places: tuple[Array, Array],
        direct: NDArray[np.bool_] | None,
        dtype: type,
    ) -> None:
        self.lists, self.discs, self.form, self.places = lists, discs, form, places
        # With v = scale p the strength and the leading factor are in already.
        self.scale = (strength * form.leading) ** (1.0 / (form.power + 1.0))
        # One more pair, of p = 0, and one more ball stand for the empty slots.
        self.ball = np.append(lists.ball, len(strength))
        self.direct = None
        if direct is not None and direct.any():
            self.direct = np.append(direct, False)
        x, y = places
        self.basis = np.stack([np.ones_like(x), x, y, x * x + y * y]).astype(dtype)
        self.against = -self.basis

        ball, inverse = lists.ball, (1.0 / discs.radius)[lists.ball]
        tile = np.repeat(np.arange(len(lists.count)), lists.count)
        cx = (discs.x[ball] - (lists.column[tile] + 0.5) * SIDE) * inverse
        cy = (discs.y[ball] - (lists.row[tile] + 0.5) * SIDE) * inverse
        scale = self.scale[ball]
        first = scale * (1.0 - cx * cx - cy * cy)
        self.four = np.zeros((len(ball) + 1, 4), dtype)
        self.shifted = np.zeros(len(ball) + 1, dtype)  # the first, for p + shift
        self.four[:-1, 0], self.shifted[:-1] = first, first + form.shift * scale
        self.four[:-1, 1] = 2.0 * cx * (scale * inverse)
        self.four[:-1, 2] = 2.0 * cy * (scale * inverse)
        self.four[:-1, 3] = -scale * inverse * inverse

    def taken(
        self, pair: Whole, live: Whole, v: Floats, out: Floats, zero: Floats
    ) -> None:
        """Give -strength w of some pairs at all places.

        Parameters
        ----------
        pair
            Positions in the list of pairs, shape (slots, tiles).
        live
            The tiles, shape (tiles,).
        v
            Work space, shape (slots, tiles, S).
        out
            The result, of that shape.
        zero
            Zeros of that shape: numpy compares two arrays faster than with a number.
        """
        four = self.four.take(pair, axis=0)
        np.matmul(four, self.basis, out=v)
        four[..., 0] = self.shifted.take(pair)
        np.matmul(four, self.against, out=out)
        if self.direct is not None:
            self._directly(pair, live, v, out)
        np.maximum(v, zero, out=v)
        self.form.times_power(v, out)

    def _directly(self, pair: Whole, live: Whole, v: Floats, out: Floats) -> None:
        """Write the rows of chosen balls from each place's own distance."""
        assert self.direct is not None
        which = self.ball.take(pair)
        slots, tiles = np.nonzero(self.direct[which])
        if not len(slots):
            return
        ball, tile = which[slots, tiles], live[tiles]
        # As `patch` has it, to the last bit: a rim at a depth of 1e30 shows every one.
        square = np.zeros((len(ball), len(self.places[0])))
        for center, middle, place in (
            (self.discs.x, self.lists.column, self.places[0]),
            (self.discs.y, self.lists.row, self.places[1]),
        ):
            gap = place + ((middle[tile] + 0.5) * SIDE)[:, None]
            gap -= center[ball][:, None]
            gap /= self.discs.radius[ball][:, None]
            square += np.square(gap, out=gap)
        p = np.subtract(1.0, square, out=square)
        scale = self.scale[ball][:, None]
        v[slots, tiles] = p * scale
        out[slots, tiles] = -(p + self.form.shift) * scale
