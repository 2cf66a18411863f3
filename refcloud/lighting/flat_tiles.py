"""Tiles of balls of one colour each: the paper's splats, exact in float64."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from refcloud.conventions import Array
from refcloud.lighting.look import Look
from refcloud.lighting.seen import Seen
from refcloud.raster.quadratics import EXACT, Floats, Moved, cancelling
from refcloud.raster.tile_lists import Discs, TileLists, Whole
from refcloud.raster.tiles import Compositor, pixel_places


@dataclass(frozen=True, eq=False)
class Flat:
    """Balls of one colour each, near to far.

    Attributes
    ----------
    discs
        Where they are in the picture.
    tau
        By group of channels, each of shape (N,).
    colours
        Shape (N, 3).
    groups
        Channels of one extinction each.
    look
        The rules.
    """

    discs: Discs
    tau: Sequence[Array]
    colours: Array
    groups: Sequence[Sequence[int]]
    look: Look


class Drawn(NamedTuple):
    """What was drawn of some tiles.

    Attributes
    ----------
    light
        What the balls add, shape (T, 3, S).
    clear
        Share of the background that passes, by group, shape (T, G, S).
    unseen
        List entries behind an opaque front, shape (T,).
    closed
        Pixels of other entries that are complete, each counted for every such entry.
    doubt
        What rounding of opacities may change at a pixel, for colours up to 1; 0 where
        it does not count.
    """

    light: Floats
    clear: Floats
    unseen: Whole
    closed: int = 0
    doubt: float = 0.0


def flat_balls(seen: Seen, drawn: Whole) -> Flat:
    """Collect what tiles need of the balls that are drawn, near to far."""
    groups = seen.channel_groups()
    return Flat(
        Discs(seen.x[drawn], seen.y[drawn], seen.radius[drawn]),
        [seen.tau[channels[0]][drawn] for channels in groups],
        seen.flat_colours()[drawn],
        groups,
        seen.lit.look,
    )


class FlatTiles:
    """Tiles of one picture, ready to be composited at any places, unchecked.

    Parameters
    ----------
    lists, flat
        The tiles' lists and the balls.
    dtype
        As `Compositor`.
    most
        Of a ball's opacity: what rounding may change.
    """

    def __init__(
        self,
        lists: TileLists,
        flat: Flat,
        dtype: type = np.float64,
        most: float = EXACT,
    ) -> None:
        self.lists, self.groups, self.dtype = lists, flat.groups, dtype
        law = flat.look.transmittance
        self.compositors = [
            Compositor(
                lists,
                flat.discs,
                tau,
                flat.colours[:, channels],
                name=flat.look.footprint,
                law=law,
                dtype=dtype,
                direct=cancelling(flat.discs, tau, law, most=most, dtype=dtype),
            )
            for tau, channels in zip(flat.tau, flat.groups, strict=True)
        ]

    def at(
        self,
        places: tuple[Array, Array],
        least: float,
        which: Whole | None = None,
        moved: Moved = None,
    ) -> Drawn:
        """Composite some tiles at given places, as `Compositor.at`."""
        found = [each.at(places, least, which, moved) for each in self.compositors]
        if len(found) == 1:
            return Drawn(found[0].light, found[0].clear[:, None], found[0].unseen)
        count, size = found[0].clear.shape
        light = np.empty((count, 3, size), self.dtype)
        for channels, each in zip(self.groups, found, strict=True):
            light[:, channels] = each.light
        clear = np.stack([each.clear for each in found], axis=1)
        unseen = np.sum([each.unseen for each in found], axis=0)
        return Drawn(light, clear, unseen)


def exact_tiles(lists: TileLists, flat: Flat, least: float) -> Drawn:
    """Composite tiles in float64 at every pixel."""
    return FlatTiles(lists, flat).at(pixel_places(), least)
