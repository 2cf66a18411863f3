"""Tiles of balls of one colour each: the paper's splats, exact in float64."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.lighting.look import Look
from refcloud.lighting.seen import Seen
from refcloud.lighting.tints import tinted
from refcloud.raster.quadratics import EXACT, Floats, cancelling
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
    lights
        What each ball shows where it is opaque, by group, each of shape (L, N).
    shown
        Of each channel the number of its light, counted over all groups, and the share
        of that which it shows.
    groups
        Channels of one extinction each.
    look
        The rules.
    """

    discs: Discs
    tau: Sequence[Array]
    lights: Sequence[Array]
    shown: Sequence[tuple[int, float]]
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
        What the balls add, shape (T, L, S): of each light, or channel.
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
    colours = seen.flat_colours().T.take(drawn, axis=1)
    lights: list[Array] = []
    shown, before = [(0, 0.0)] * len(colours), 0
    for channels in groups:
        mine = tinted(colours[channels])
        for channel, (number, share) in zip(channels, mine.shown, strict=True):
            shown[channel] = before + number, share
        before += len(mine.lights)
        lights.append(mine.lights)
    return Flat(
        Discs(seen.x.take(drawn), seen.y.take(drawn), seen.radius.take(drawn)),
        [seen.tau[channels[0]].take(drawn) for channels in groups],
        lights,
        shown,
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
        measured = flat.cancelling(dtype, EXACT) if direct is None else direct
        self.compositors = [
            Compositor(
                lists,
                flat.discs,
                tau,
                lights.T,
                name=flat.look.footprint,
                law=flat.look.transmittance,
                dtype=dtype,
                direct=balls,
            )
            for tau, lights, balls in zip(flat.tau, flat.lights, measured, strict=True)
        ]

    def on(self, lists: TileLists) -> FlatTiles:
        """Give the same balls for other lists."""
        other = copy.copy(self)
        other.compositors = [each.on(lists) for each in self.compositors]
        return other

    def at(
        self,
        places: tuple[Array, Array],
        least: float,
        which: Whole | None = None,
    ) -> Drawn:
        """Composite some tiles at given places, as `Compositor.at`."""
        found = [each.at(places, least, which) for each in self.compositors]
        if len(found) == 1:
            return Drawn(found[0].light, found[0].clear[:, None], found[0].unseen)
        light = np.concatenate([each.light for each in found], axis=1)
        clear = np.stack([each.clear for each in found], axis=1)
        unseen = np.sum([each.unseen for each in found], axis=0)
        return Drawn(light, clear, unseen)


def exact_tiles(lists: TileLists, flat: Flat, least: float) -> Drawn:
    """Composite tiles in float64 at every pixel."""
    return FlatTiles(lists, flat).at(pixel_places(), least)
