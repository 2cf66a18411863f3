"""A picture that is written tile by tile, over a background or over nothing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from refcloud.conventions import Array
from refcloud.raster.framebuffer import CHANNELS
from refcloud.raster.quadratics import Floats
from refcloud.raster.tile_lists import SIDE, TileLists


class Canvas:
    """RGBA that starts as what lies behind and takes finished tiles.

    Each channel lies in one piece of memory, in whole tiles; the picture is a view.

    Parameters
    ----------
    width, height
        Size of the picture, pixels.
    background
        RGB, shape (H, W, 3); None for nothing, that is 0.
    """

    def __init__(self, width: int, height: int, background: Array | None) -> None:
        across, down = -(-width // SIDE), -(-height // SIDE)
        self.size = width, height
        self.over = background is not None
        self.planes = np.zeros((CHANNELS, down * SIDE, across * SIDE))
        if background is not None:
            self.planes[:3, :height, :width] = background.transpose(2, 0, 1)
            self.planes[3] = 1.0
        tiled = self.planes.reshape(CHANNELS, down, SIDE, across, SIDE)
        self.tiles = tiled.transpose(0, 1, 3, 2, 4)  # (4, down, across, SIDE, SIDE)

    def paint(
        self,
        lists: TileLists,
        groups: Sequence[Sequence[int]],
        light: Floats,
        clear: Floats,
        shown: Sequence[tuple[int, float]] = ((0, 1.0), (1, 1.0), (2, 1.0)),
    ) -> None:
        """Write finished tiles.

        Parameters
        ----------
        lists
            The tiles.
        groups
            Channels of one transmittance each.
        light
            What is added, shape (T, L, pixels of a tile): of each light.
        clear
            Share of what lies behind that passes, shape (T, G, pixels of a tile).
        shown
            Of each channel the number of its light, and the share of that which it
            shows.
        """
        where = lists.row, lists.column
        squares, through = (
            part.reshape(*part.shape[:2], SIDE, SIDE) for part in (light, clear)
        )
        for group, channels in enumerate(groups):
            passed = through[:, group]
            for channel in channels:
                number, share = shown[channel]
                added = squares[:, number]
                if share != 1.0:
                    added = added * share
                if self.over:
                    added = added + passed * self.tiles[channel][where]
                self.tiles[channel][where] = added
        if not self.over:
            alpha = 1.0 - through[:, 0]
            if len(groups) > 1:  # the mean over the channels
                alpha *= len(groups[0]) / 3.0
                for group, channels in enumerate(groups[1:], 1):
                    alpha += len(channels) / 3.0 * (1.0 - through[:, group])
            self.tiles[3][where] = alpha

    def pixels(self) -> Array:
        """Give the picture, RGBA of shape (H, W, 4), colour multiplied by alpha."""
        width, height = self.size
        return self.planes[:, :height, :width].transpose(1, 2, 0)
