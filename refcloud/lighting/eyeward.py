"""Pass 2: the light that the balls send to the eye (paper M, section 4.2).

Balls are drawn far to near over the background; each adds what it scatters toward the
eye and lets through the rest: c = 1 g* + T c (eq 28, 29). Nothing is read back.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import AnyCamera, axes, project
from refcloud.checking import checked
from refcloud.conventions import Array, Range, Seed, Shape, Skipped, Tolerance
from refcloud.lighting.colours import Haze, ball_colours, clearness
from refcloud.lighting.erosion import detail_grid
from refcloud.lighting.lightfield import light_field
from refcloud.lighting.order import depth_order
from refcloud.lighting.shading import Ball, Shading, draw_ball
from refcloud.lighting.sunward import LitMetaballs, ball_depths

Observer = Callable[[str, Any], None]
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
    """Draw lit balls as the camera sees them: pass 2, the literal loop.

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
        Largest change of a channel that leaving out faint balls may make.
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
    visible, skipped = _on_screen(x, y, radius, camera)
    dark = sum(1 for sun in lit.suns if not sun.irradiance.any())
    if dark:
        skipped.append(Skipped("light", "suns without light", dark, len(lit.suns)))
    sigma_ts = lit.medium.sigma_t_rgb
    tau = np.stack([_eye_depths(lit, float(s), depth) for s in sigma_ts])
    colours = ball_colours(lit, camera)
    brightest = max(colours.sum(axis=1).max(initial=0.0), pixels.max(initial=0.0))
    if haze is not None:
        brightest = max(brightest, float(haze.color.max()))
    visible, faint = _without_faint(visible, tau.max(axis=0), brightest, tolerance)
    skipped += faint

    # 3. Light as a field, and the noise that erodes footprints.
    field = detail = None
    if look.light_reach > 0.0 and visible.any():
        values = colours.reshape(len(colours), -1)
        field = light_field(balls, values, reach=look.light_reach)
    middling = float(np.median(balls.radii)) if len(balls.radii) else 1.0
    cell = look.erosion_cell * middling
    if look.erosion > 0.0 and visible.any():
        places, reach = balls.centers[visible], balls.radii[visible][:, None]
        lower, upper = (places - reach).min(axis=0), (places + reach).max(axis=0)
        pixel = 1.0 / float(scale[visible].max())
        detail = detail_grid(lower, upper, cell=cell, pixel=pixel, seed=seed)
        skipped += detail.skipped
        watch("detail", detail)
    toward = np.array([sun.direction for sun in lit.suns]).reshape(-1, 3)
    shading = Shading(
        axes(camera), look, balls.kernel, detail, field, toward * (RISE * cell)
    )
    clear = clearness(haze, balls.centers, camera)
    air = np.zeros(3) if haze is None else haze.color

    # 4. Far to near: draw. A grey medium needs one pass, a coloured one three (L12).
    order = depth_order(balls, depth)[::-1]
    order = order[visible[order]]
    watch("eye order", order)
    groups = [np.flatnonzero(sigma_ts == s) for s in dict.fromkeys(sigma_ts.tolist())]
    parts = [pixels, *(pixels.copy() for _ in groups[1:])]
    for channels, part in zip(groups, parts, strict=True):
        for k in order:
            ball = Ball(
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
            draw_ball(part, shading, ball)
    if len(groups) > 1:
        alpha = sum(
            len(c) * part[..., 3] for c, part in zip(groups, parts, strict=True)
        )
        for channels, part in zip(groups, parts, strict=True):
            pixels[..., channels] = part[..., channels]
        pixels[..., 3] = alpha / 3.0
    return pixels, tuple(skipped)


def _eye_depths(lit: LitMetaballs, sigma_t: float, depth: Array) -> Array:
    """Give optical depths as the eye counts them.

    A ball fades in as the eye leaves it, so that none pops at the near plane.
    """
    nearness = np.clip(depth / lit.balls.radii, 0.0, 1.0)
    fade = nearness * nearness * (3.0 - 2.0 * nearness)
    return ball_depths(lit.balls, sigma_t, lit.look) * fade * lit.look.erosion_depth


def _on_screen(
    x: Array, y: Array, radius: Array, camera: AnyCamera
) -> tuple[NDArray[np.bool_], list[Skipped]]:
    """Tell which balls touch the picture; the others change nothing."""
    in_front = radius > 0.0
    across = (x + radius > 0.0) & (x - radius < camera.width)
    down = (y + radius > 0.0) & (y - radius < camera.height)
    visible = in_front & across & down
    hidden = len(x) - int(visible.sum())
    rows = [Skipped("eye", "balls off the picture", hidden, len(x))] if hidden else []
    return visible, rows


def _without_faint(
    visible: NDArray[np.bool_], tau: Array, brightest: float, tolerance: float
) -> tuple[NDArray[np.bool_], list[Skipped]]:
    """Leave out the faintest balls while their total effect stays in the tolerance.

    Proved: every colour in the buffer and in the balls lies in [0, brightest], so a
    ball of opacity a changes no pixel by more than a times brightest, and the changes
    of several add up at most.
    """
    effect = -np.expm1(-tau) * brightest
    candidates = np.flatnonzero(visible)
    ranked = candidates[np.argsort(effect[candidates], kind="stable")]
    total = np.cumsum(effect[ranked])
    faint = ranked[total <= tolerance]
    if not len(faint):
        return visible, []
    kept = visible.copy()
    kept[faint] = False
    bound = float(total[len(faint) - 1])
    return kept, [
        Skipped("eye", "balls too faint to show", len(faint), len(tau), bound)
    ]
