"""Tiles of balls of one colour each: the paper's splats, exact in float64."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

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

    def cancelling(self, dtype: type, most: float) -> list[NDArray[np.bool_]]:
        """Tell by group which balls' opacities rounding would change by too much."""
        law = self.look.transmittance
        return [
            cancelling(self.discs, tau, law, most=most, dtype=dtype) for tau in self.tau
        ]


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
    """

    light: Floats
    clear: Floats
    unseen: Whole
    closed: int = 0


def flat_balls(seen: Seen, drawn: Whole) -> Flat:
    """Collect what tiles need of the balls that are drawn, near to far."""
    groups = seen.channel_groups()
    return Flat(
        Discs(seen.x.take(drawn), seen.y.take(drawn), seen.radius.take(drawn)),
        [seen.tau[channels[0]].take(drawn) for channels in groups],
        seen.flat_colours().take(drawn, axis=0),
        groups,
        seen.lit.look,
    )


def one_ball_a_pair(lists: TileLists, flat: Flat) -> tuple[TileLists, Flat]:
    """Give a few tiles' lists and their balls alone, one for each pair.

    What is computed for each ball then costs as much as these tiles have pairs, however
    many balls the picture has.
    """
    ball, discs = lists.ball, flat.discs
    theirs = dataclasses.replace(
        flat,
        discs=Discs(discs.x.take(ball), discs.y.take(ball), discs.radius.take(ball)),
        tau=[tau.take(ball) for tau in flat.tau],
        colours=flat.colours.take(ball, axis=0),
    )
    return dataclasses.replace(lists, ball=np.arange(len(ball))), theirs


class FlatTiles:
    """Tiles of one picture, ready to be composited at any places, unchecked.

    Parameters
    ----------
    lists, flat
        The tiles' lists and the balls.
    dtype
        As `Compositor`.
    direct
        By group of channels, the balls whose places are measured one by one, as
        `cancelling` tells them; None for those of float64.
    """

    def __init__(
        self,
        lists: TileLists,
        flat: Flat,
        dtype: type = np.float64,
        direct: Sequence[NDArray[np.bool_]] | None = None,
    ) -> None:
        self.lists, self.groups, self.dtype = lists, flat.groups, dtype
        measured = flat.cancelling(dtype, EXACT) if direct is None else direct
        self.compositors = [
            Compositor(
                lists,
                flat.discs,
                tau,
                flat.colours[:, channels],
                name=flat.look.footprint,
                law=flat.look.transmittance,
                dtype=dtype,
                direct=balls,
            )
            for tau, channels, balls in zip(
                flat.tau, flat.groups, measured, strict=True
            )
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
