"""Tiles that are shaded place by place, within a tolerance: in single precision.

Its error is bounded by what is summed while tiles are drawn (see `single_places`), so
that no sample has to vouch for it. Where that bound is above what was asked, as with
balls of extreme depth, tiles are drawn again in double precision.
"""

from __future__ import annotations

import functools
from collections.abc import Callable

from refcloud.conventions import Skipped
from refcloud.lighting.exact_places import ExactPlaces
from refcloud.lighting.flat_tiles import Drawn
from refcloud.lighting.seen import Seen
from refcloud.lighting.shaded_tiles import shaded_tiles
from refcloud.lighting.shading import Shading
from refcloud.lighting.single_places import (
    COLOR,
    ROUNDING,
    SinglePlaces,
    weight_doubt,
)
from refcloud.raster.tile_lists import TileLists, Whole

# Balls as deep as the deepest that a pixel sees through their rims, one behind the
# other: a guess, of the clouds of the scenes. A wrong one costs time alone.
RIMS = 3.0
DIGITS = 3.0 / 16.0  # of a tolerance: for what rounding may change


def digits_of(seen: Seen, drawn: Whole, brightest: float, tolerance: float) -> float:
    """Give what single precision may change of a picture; 0 where it does not pay.

    Parameters
    ----------
    seen, drawn
        The balls, and those that are drawn.
    brightest
        Largest colour, at least 1.
    tolerance
        Of all of pass 2.
    """
    if not len(drawn):
        return 0.0
    look = seen.lit.look
    deep = float(seen.tau[:, drawn].max(initial=0.0))
    if look.transmittance == "linear":
        deep = 1.0
    doubt = RIMS * (deep * weight_doubt(look.erosion) + 5.0 * ROUNDING)
    found = brightest * (doubt + COLOR * ROUNDING)
    return DIGITS * tolerance if found <= DIGITS * tolerance else 0.0


class ProvedTiles:
    """Draws tiles of a picture, in single precision where that is enough.

    Parameters
    ----------
    seen, drawn
        The balls, and those that are drawn, near to far.
    shading
        What all balls share, with noise in single precision where `digits` is not 0.
    again
        Gives the same in double precision, where single precision was not enough.
    digits
        What single precision may change; 0 for double precision.
    brightest
        Largest colour, at least 1.
    """

    def __init__(
        self,
        seen: Seen,
        drawn: Whole,
        shading: Shading,
        again: Callable[[], Shading],
        digits: float,
        brightest: float,
    ) -> None:
        self.seen, self.drawn = seen, drawn
        self.digits, self.brightest = digits, brightest
        self.single = SinglePlaces(seen, shading) if digits > 0.0 else None
        given = functools.partial(ExactPlaces, seen)
        self.exact = functools.cache(
            (lambda: given(again())) if digits > 0.0 else (lambda: given(shading))
        )
        self.count = self.saved = 0
        self.bound = 0.0

    def draw(self, lists: TileLists, least: float) -> Drawn:
        """Composite tiles, as `shaded_tiles`."""
        groups = self.seen.channel_groups()
        self.count += len(lists.count)
        if self.single is not None:
            found = shaded_tiles(lists, self.drawn, groups, self.single, least)
            bound = self.brightest * (found.doubt + COLOR * ROUNDING)
            if bound <= self.digits:
                self.saved += len(lists.count)
                self.bound = max(self.bound, bound)
                return found
        return shaded_tiles(lists, self.drawn, groups, self.exact(), least)

    def rows(self) -> list[Skipped]:
        """Tell what was saved."""
        if not self.saved:
            return []
        what = "tiles of shaded balls in double precision"
        return [Skipped("eye", what, self.saved, self.count, self.bound)]
