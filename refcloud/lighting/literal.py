"""Pass 2 to the letter: ball after ball, far to near. It defines every picture.

`eyeward` makes the same picture faster and in another order of sums; tests hold both
equal to 1e-12. Read this one first.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.camera import AnyCamera
from refcloud.checking import checked
from refcloud.conventions import Array, Range, Seed, Shape
from refcloud.lighting.colours import Haze
from refcloud.lighting.lit import LitMetaballs
from refcloud.lighting.seen import seen_by, shading_of
from refcloud.lighting.shading import draw_over


@checked
def eyeward_literal(
    lit: LitMetaballs,
    camera: AnyCamera,
    *,
    background: Annotated[Array, Shape("H", "W", 3), Range(0.0)] | None = None,
    haze: Haze | None = None,
    seed: Seed = 0,
) -> Array:
    """Draw lit balls one by one, each blended over what lies behind it.

    Formula: I*_k = g*_k + T_k I*_{k-1} from the farthest ball on, I*_0 the background

    Parameters
    ----------
    lit
        The balls and their light, of `sunward`.
    camera
        Pinhole or orthographic.
    background
        Linear RGB, shape (H, W, 3) of the camera's size; None leaves it transparent.
    haze
        Air in front of the balls; None for none.
    seed
        Chooses the noise of eroded footprints.

    Returns
    -------
    RGBA of shape (H, W, 4), colour multiplied by alpha.

    Source: paper M, eq 28 and 29, L10, L11; E04, E25, E26.
    """
    # 1. The framebuffer starts as what lies behind: I*_0.
    pixels = np.zeros((camera.height, camera.width, 4))
    if background is not None:
        pixels[..., :3], pixels[..., 3] = background, 1.0
    seen, _ = seen_by(lit, camera, haze)
    shading, _ = shading_of(seen, seed, lambda name, value: None)
    # 2. Draw. A grey medium needs one pass, a coloured one three (L12).
    drawn = np.zeros_like(pixels)
    for channels in seen.channel_groups():
        part = pixels.copy()
        for k in seen.order[::-1]:
            if seen.shown[k]:
                draw_over(part, shading, seen.ball(k, channels[0]))
        drawn[..., channels] = part[..., channels]
        drawn[..., 3] += part[..., 3] * (len(channels) / 3.0)
    return drawn
