"""Noise alone, as the page's choice."""

from __future__ import annotations

import dataclasses
from typing import Any

from refcloud.noise_pictures import CHANNELS, noise_picture
from refcloud.refusal import complaint
from refcloud.studio.knobs import group_of
from refcloud.studio.recipe import Call, Recipe, Stage
from refcloud.studio.setups import (
    FILE,
    MOST_HIGH,
    MOST_WIDE,
    Frame,
    Setup,
    Values,
    differing,
    saving,
)

COARSE_SIDE = 160  # pixels of a panel

NOISE_GROUPS = (
    group_of(
        "noise",
        "Noise",
        noise_picture,
        start={"kind": "worley_smooth", "size": 384},
    ),
    dataclasses.replace(FILE, start={"tone": "none", "dither": False}),
)


def noisy(values: Values, frame: Frame) -> Recipe:
    """Write a picture of noise; its size is its own."""
    noise = differing(NOISE_GROUPS[0], values["noise"] or {})
    kind = noise.pop("kind")
    _refuse_large(values["noise"] or {})
    call = Call("noise_picture", noise_picture, (kind,), noise)
    small = call.but(size=min(noise.get("size", 256), COARSE_SIDE))
    return Recipe((Stage("picture", call, small),), saving(values))


def _refuse_large(noise: dict[str, Any]) -> None:
    """Refuse panels that are larger together than any picture of the page."""
    panels = {"slice": 1, "channels": CHANNELS + 1, "octaves": 2 * noise["octaves"]}
    number, size = panels[noise["view"]], noise["size"]
    if number * size * size > MOST_WIDE * MOST_HIGH:
        expected = f"panels of at most {MOST_WIDE * MOST_HIGH / 1e6:.1f} megapixels"
        advice = "choose a smaller size or the view slice"
        raise ValueError(
            complaint("noise.size", expected, f"{number} of {size} x {size}", advice)
        )


NOISE = Setup("noise", "noise alone", NOISE_GROUPS, noisy)
