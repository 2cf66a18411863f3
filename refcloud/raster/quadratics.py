"""Wyvill footprints of many balls at the same places of many tiles, as a product.

Inside a tile p = 1 - (distance / radius)^2 is a quadratic in the place,

    p = 1 - cx^2 - cy^2 + 2 cx x / r + 2 cy y / r - (x^2 + y^2) / r^2

with the ball's centre (cx, cy) from the tile's middle in radii r: four numbers of the
ball times 1, x, y and x^2 + y^2 of the places.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
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


class Places:
    """Places in a tile, as the second factors of the products.

    Parameters
    ----------
    x, y
        From the tile's middle, pixels, shape (S,).
    dtype
        Of the products.
    """

    def __init__(self, x: Array, y: Array, dtype: type) -> None:
        self.x, self.y = x, y
        # 1, x, y and x^2 + y^2, and once more with the other sign and the 1 last.
        self.ahead, self.against = np.empty((2, 4, len(x)), dtype)
        self.ahead[0], self.ahead[1], self.ahead[2] = 1.0, x, y
        self.ahead[3] = x * x + y * y
        np.negative(self.ahead[1:], out=self.against[:3])
        self.against[3] = -1.0


class Quadratics:
    """The pairs of `lists` as rows of numbers, and their products with places.

    Parameters
    ----------
    lists, discs
        The tiles' lists, and the balls near to far.
    strength
        What w is multiplied by, shape (N,): `taken` gives -strength w.
    form
        The footprint.
    beside
        Numbers of each ball that are looked up with it, C times of shape (N,): of each
        pair the change from the ball before it in its list.
    direct
        Balls whose numbers would cancel, shape (N,): for them p is computed from each
        place's own distance to the centre.
    dtype
        Of the products; the numbers themselves are formed in float64.
    """

    def __init__(
        self,
        lists: TileLists,
        discs: Discs,
        strength: Array,
        form: Form,
        beside: Sequence[Array],
        direct: NDArray[np.bool_] | None,
        dtype: type,
    ) -> None:
        self.discs, self.form, self.dtype, self.beside = discs, form, dtype, beside
        self.direct = direct if direct is not None and direct.any() else None
        # With v = scale p the strength and the leading factor are in already.
        self.scale = (strength * form.leading) ** (1.0 / (form.power + 1.0))
        self.inverse = 1.0 / discs.radius
        self.use(lists)

    def use(self, lists: TileLists) -> None:
        """Make the rows of the pairs of some lists."""
        self.lists, form, ball = lists, self.form, lists.ball
        # 1. Of each pair the ball's middle from the tile's, in radii.
        inverse = self.inverse.take(ball)
        cx, cy = lists.from_middles(self.discs)
        cx *= inverse
        cy *= inverse
        # 2. A row for each pair, one more of zeros for the empty slots: the four
        #    numbers, the first again for p + shift, and what is looked up with them.
        self.rows = np.empty((len(ball) + 1, 5 + len(self.beside)), self.dtype)
        self.rows[-1] = 0.0
        of = self.rows[:-1].T
        scale = self.scale.take(ball)
        first = scale * (1.0 - cx * cx - cy * cy)
        of[0], of[4] = first, first + form.shift * scale
        scaled = inverse * scale
        of[1] = 2.0 * cx * scaled
        of[2] = 2.0 * cy * scaled
        of[3] = -scaled * inverse
        # 3. What is looked up: of a list's first ball all, of others the change.
        self.looked_up = [values.take(ball) for values in self.beside]
        for kind, values in enumerate(self.looked_up, 5):
            of[kind, 1:] = values[1:] - values[:-1]
            of[kind, lists.first] = values[lists.first]

    def taken(
        self,
        pair: Whole,
        tile: Whole,
        places: Places,
        v: Floats,
        out: Floats,
        zero: Floats,
    ) -> Floats:
        """Give -strength w of some pairs at all places.

        Parameters
        ----------
        pair
            Positions in the list of pairs, shape (slots, tiles); -1 for none.
        tile
            Numbers of the tiles, shape (tiles,).
        places
            In those tiles, S of them.
        v
            Work space, shape (slots, tiles, S).
        out
            The result, of that shape.
        zero
            Zeros of that shape: numpy compares two arrays faster than with a number.

        Returns
        -------
        What is looked up with the pairs, shape (slots, tiles, C); 0 for none.
        """
        rows = self.rows.take(pair, axis=0, mode="wrap")
        np.matmul(rows[..., :4], places.ahead, out=v)
        np.matmul(rows[..., 1:5], places.against, out=out)
        if self.direct is not None:
            self._directly(pair, tile, places, v, out)
        np.maximum(v, zero, out=v)
        self.form.times_power(v, out)
        return rows[..., 5:]

    def _directly(
        self,
        pair: Whole,
        tile: Whole,
        places: Places,
        v: Floats,
        out: Floats,
    ) -> None:
        """Write the rows of chosen balls from each place's own distance."""
        assert self.direct is not None
        which = self.lists.ball.take(pair, mode="wrap")
        slots, tiles = np.nonzero(self.direct[which] & (pair >= 0))
        if not len(slots):
            return
        ball, tile = which[slots, tiles], tile[tiles]
        # As `patch` has it, to the last bit: a rim at a depth of 1e30 shows every one.
        square = np.zeros((len(ball), len(places.x)))
        for center, middle, place in (
            (self.discs.x, self.lists.column, places.x),
            (self.discs.y, self.lists.row, places.y),
        ):
            gap = place + ((middle[tile] + 0.5) * self.lists.edge)[:, None]
            gap -= center[ball][:, None]
            gap /= self.discs.radius[ball][:, None]
            square += np.square(gap, out=gap)
        p = np.subtract(1.0, square, out=square)
        scale = self.scale[ball][:, None]
        v[slots, tiles] = p * scale
        out[slots, tiles] = -(p + self.form.shift) * scale
