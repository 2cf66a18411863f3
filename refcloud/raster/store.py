"""The state of the rasteriser, and how fragments that lie within the scissor are kept.

Depth test, blending, rounding, colour mask, for boxes and for lists of pixels alike.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from refcloud.checking import check_fields
from refcloud.conventions import Array
from refcloud.raster.blending import blended_as
from refcloud.raster.factors import Blending
from refcloud.raster.formats import Arithmetic, Format, stored
from refcloud.raster.framebuffer import CHANNELS, Framebuffer, clipped

DepthFunc = Literal[
    "NEVER", "LESS", "EQUAL", "LEQUAL", "GREATER", "NOTEQUAL", "GEQUAL", "ALWAYS"
]
ColorMask = tuple[bool, bool, bool, bool]
EVERY_CHANNEL: ColorMask = (True, True, True, True)

# Whether a fragment passes: of (its depth, the buffer's).
DEPTH_FUNCS: dict[str, Callable[[Any, Any], Any]] = {
    "NEVER": lambda new, old: np.zeros_like(old, dtype=bool),
    "LESS": lambda new, old: new < old,
    "EQUAL": lambda new, old: new == old,
    "LEQUAL": lambda new, old: new <= old,
    "GREATER": lambda new, old: new > old,
    "NOTEQUAL": lambda new, old: new != old,
    "GEQUAL": lambda new, old: new >= old,
    "ALWAYS": lambda new, old: np.ones_like(old, dtype=bool),
}


@dataclass(frozen=True)
class State:
    """Which operations fragments go through; all are off by default.

    Attributes
    ----------
    blending
        Factors and equations; None writes the new colour (glDisable of BLEND).
    color_mask
        Which of RGBA may be written (glColorMask).
    scissor
        Rows and columns outside which nothing is written, as slices with both ends;
        they may leave the buffer (glScissor). None for everywhere.
    depth_func
        Which depths pass against the buffer's (glDepthFunc); None neither tests nor
        writes depths (glDisable of DEPTH_TEST).
    depth_mask
        Whether depths may be written (glDepthMask).
    """

    blending: Blending | None = None
    color_mask: ColorMask = EVERY_CHANNEL
    scissor: tuple[slice, slice] | None = None
    depth_func: DepthFunc | None = None
    depth_mask: bool = True

    def __post_init__(self) -> None:
        check_fields(self)
        for part in self.scissor or ():
            clipped("scissor", part, 1)


class Store(NamedTuple):
    """A framebuffer's numbers, in whatever shape they are written in."""

    pixels: Array
    depth: Array | None
    format: Format
    arithmetic: Arithmetic


def stored_in(buffer: Framebuffer) -> Store:
    """Give a framebuffer's numbers as they lie there."""
    return Store(buffer.pixels, buffer.depth, buffer.format, buffer.arithmetic)


def flattened(buffer: Framebuffer) -> Store:
    """Give a framebuffer as lists of pixels (H W, 4) and depths (H W,).

    Views where its memory allows that; it does in those that `framebuffer` makes.
    """
    depth = None if buffer.depth is None else buffer.depth.reshape(-1)
    pixels = buffer.pixels.reshape(-1, CHANNELS)
    return Store(pixels, depth, buffer.format, buffer.arithmetic)


def unflattened(store: Store, buffer: Framebuffer) -> None:
    """Put lists of pixels and depths back where they are no views."""
    for numbers, whole in ((store.pixels, buffer.pixels), (store.depth, buffer.depth)):
        if numbers is not None and whole is not None:
            if not np.may_share_memory(numbers, whole):
                whole[:] = numbers.reshape(whole.shape)


def write(
    store: Store,
    where: tuple[Any, ...],
    source: Array,
    depths: Array | None,
    state: State,
) -> None:
    """Send fragments that lie within the scissor to their pixels, unchecked.

    Parameters
    ----------
    store
        The framebuffer's numbers, written in place.
    where
        Their places: slices, or lists in which no pixel comes twice.
    source
        Colours, shape (h, w, 4) or (n, 4), float64 or float32.
    depths
        Shape (h, w) or (n,); None where the state tests none.
    state
        The operations that are on.
    """
    # 2. Depth test, and the depths of those that pass.
    passed = None
    if state.depth_func is not None and store.depth is not None:
        before = store.depth[where]
        passed = DEPTH_FUNCS[state.depth_func](depths, before)
        if state.depth_mask:
            new_depths: Any = depths
            store.depth[where] = np.where(passed, new_depths, before)

    # 3. Blend, and round to what the format holds.
    colors = source
    if state.blending is not None:
        how = store.format, store.arithmetic
        source = source.astype(np.float64, copy=False)
        colors = blended_as(source, store.pixels[where], state.blending, *how)
    elif store.format != "RGBA64F":
        source = source.astype(np.float64, copy=False)
        colors = stored(source, store.format, arithmetic=store.arithmetic)

    # 4. Write, channel by channel.
    for channel in written(state):
        new, plane = colors[..., channel], store.pixels[..., channel]
        if passed is not None:
            new = np.where(passed, new, plane[where])
        plane[where] = new


def written(state: State) -> list[int]:
    """List the channels that the colour mask lets by."""
    return [channel for channel in range(CHANNELS) if state.color_mask[channel]]
