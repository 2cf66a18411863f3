"""Pass 2: the light that the balls send to the eye (paper M, section 4.2).

Balls are drawn far to near over the background; each adds what it scatters toward the
eye and lets through the rest: c = 1 g* + T c (eq 28, 29). Nothing is read back. With a
tolerance they are drawn near to far, under each other: the same sums, and what lies
behind an opaque front need not be drawn.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np

from refcloud.camera import AnyCamera, axes, project
from refcloud.checking import checked
from refcloud.conventions import Array, Observer, Range, Seed, Shape, Skipped, Tolerance
from refcloud.lighting.colours import Haze, ball_colours, clearness
from refcloud.lighting.depths import ball_depths
from refcloud.lighting.erosion import detail_grid
from refcloud.lighting.hidden import on_screen, without_faint
from refcloud.lighting.lightfield import light_field
from refcloud.lighting.lit import LitMetaballs
from refcloud.lighting.order import depth_order
from refcloud.lighting.shading import Ball, Shading, draw_over, draw_under
from refcloud.raster.blending import blend_patch

RISE = 0.25  # of the noise's coarsest cell: the step toward a sun that shows its relief


@checked
def eyeward(
    lit: LitMetaballs,
    camera: AnyCamera,
    *,
    background: Annotated[Array, Shape("H", "W", 3), Range(0.0)] | None = None,
    haze: Haze | None = None,
    tolerance: Tolerance = 0.0,
    seed: Seed = 0,
    observe: Observer | None = None,
) -> tuple[Array, tuple[Skipped, ...]]:
    """Draw lit balls as the camera sees them: pass 2.

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
    tolerance
        Largest change of a channel that leaving out faint and hidden balls may make.
    seed
        Chooses the noise of eroded footprints.
    observe
        Called with (name, value): the drawing order, the detail noise.

    Returns
    -------
    RGBA of shape (H, W, 4), colour multiplied by alpha; and what was skipped.

    Raises
    ------
    ValueError
        The background has another size than the picture.

    Source: paper M, eq 28 and 29, L10, L11; E04, E25, E26.
    """
    watch = observe or (lambda name, value: None)
    size = (camera.height, camera.width)
    if background is not None and background.shape != (*size, 3):
        raise ValueError(
            f"background: expected shape {(*size, 3)}, that of the picture,"
            f" got {background.shape}"
        )
    # 1. The framebuffer starts as what lies behind: I*_0.
    pixels = np.zeros((*size, 4))
    if background is not None:
        pixels[..., :3], pixels[..., 3] = background, 1.0
    balls, look = lit.balls, lit.look
    x, y, depth, scale = project(camera, balls.centers)
    radius = balls.radii * scale

    # 2. Leave out what cannot show.
    order = depth_order(balls, depth)
    shown, skipped = on_screen(x, y, radius, camera)
    dark = sum(1 for sun in lit.suns if not sun.irradiance.any())
    if dark:
        skipped.append(Skipped("light", "suns without light", dark, len(lit.suns)))
    sigma_ts = lit.medium.sigma_t_rgb
    tau = np.stack([_eye_depths(lit, float(s), depth) for s in sigma_ts])
    colours = ball_colours(lit, camera)
    # Alpha counts as a channel: what may change is 1 at least.
    brightest = max(colours.sum(axis=1).max(initial=1.0), pixels.max())
    if haze is not None:
        brightest = max(brightest, float(haze.color.max()))
    visible, rows = without_faint(
        order, shown, tau.max(axis=0), brightest, tolerance / 2.0
    )
    skipped += rows

    # 3. Light as a field, and the noise that erodes footprints.
    field = detail = None
    if look.light_reach > 0.0 and visible.any():
        values = colours.reshape(len(colours), -1)
        field = light_field(balls, values, reach=look.light_reach)
    middling = float(np.median(balls.radii)) if len(balls.radii) else 1.0
    cell = look.erosion_cell * middling
    if look.erosion > 0.0 and visible.any():
        # The faint balls count too: the noise must not change with the tolerance.
        places = balls.centers[shown]
        reach = balls.radii[shown][:, None] + RISE * cell
        lower, upper = (places - reach).min(axis=0), (places + reach).max(axis=0)
        pixel = 1.0 / float(scale[shown].max())
        detail = detail_grid(lower, upper, cell=cell, pixel=pixel, seed=seed)
        skipped += detail.skipped
        watch("detail", detail)
    toward = np.array([sun.direction for sun in lit.suns]).reshape(-1, 3)
    shading = Shading(
        axes(camera), look, balls.kernel, detail, field, toward * (RISE * cell)
    )
    clear = clearness(haze, balls.centers, camera)
    air = np.zeros(3) if haze is None else haze.color

    # 4. Draw. A grey medium needs one pass, a coloured one three (L12).
    order = order[visible[order]]
    watch("eye order", order)
    # Behind pixels that let no more than this through, all together changes less than
    # half the tolerance: it is between 0 and the brightest, and is seen through them.
    least = 0.5 * tolerance / brightest
    # Only this box of pixels changes; the rest is neither copied nor blended.
    box = _touched(x[order], y[order], radius[order], camera)
    behind = pixels[box].copy()
    drawn = np.zeros_like(behind)
    groups = [np.flatnonzero(sigma_ts == s) for s in dict.fromkeys(sigma_ts.tolist())]
    hidden = len(order)
    for channels in groups:
        chosen = (
            Ball(
                float(x[k]),
                float(y[k]),
                float(radius[k]),
                float(tau[channels[0], k]),
                balls.centers[k],
                float(balls.radii[k]),
                colours[k],
                float(clear[k]),
                air * (1.0 - clear[k]),
            )
            for k in (order if tolerance > 0.0 else order[::-1])
        )
        if tolerance > 0.0:
            part = np.zeros_like(pixels)
            seen = sum(draw_under(part, shading, ball, least) for ball in chosen)
            hidden = min(hidden, len(order) - seen)
            blend_patch(part[box], behind, "ONE_MINUS_DST_ALPHA", "ONE")
        else:
            part = pixels.copy()
            for ball in chosen:
                draw_over(part, shading, ball)
            hidden = 0
        drawn[..., channels] = part[box][..., channels]
        drawn[..., 3] += part[box][..., 3] * (len(channels) / 3.0)
    pixels[box] = drawn
    if hidden:
        row = Skipped(
            "eye", "balls behind opaque ones", hidden, len(x), tolerance / 2.0
        )
        skipped.append(row)
    return pixels, tuple(skipped)


def _touched(
    x: Array, y: Array, radius: Array, camera: AnyCamera
) -> tuple[slice, slice]:
    """Give the rows and columns of the picture that balls may touch."""
    if not len(x):
        return slice(0, 0), slice(0, 0)
    left, top = max(float((x - radius).min()), 0.0), max(float((y - radius).min()), 0.0)
    right = min(float((x + radius).max()), camera.width)
    bottom = min(float((y + radius).max()), camera.height)
    return (
        slice(math.floor(top), math.ceil(bottom)),
        slice(math.floor(left), math.ceil(right)),
    )


def _eye_depths(lit: LitMetaballs, sigma_t: float, depth: Array) -> Array:
    """Give optical depths as the eye counts them.

    A ball fades in as the eye leaves it, so that none pops at the near plane.
    """
    nearness = np.clip(depth / lit.balls.radii, 0.0, 1.0)
    fade = nearness * nearness * (3.0 - 2.0 * nearness)
    return ball_depths(lit.balls, sigma_t, lit.look) * fade * lit.look.erosion_depth
