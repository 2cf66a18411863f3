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
from refcloud.lighting.order import depth_order
from refcloud.lighting.shading import Shading, draw_ball
from refcloud.lighting.smoothing import blended_colours, colour_blend
from refcloud.lighting.sunward import LitMetaballs, ball_depths

Observer = Callable[[str, Any], None]


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
    colours = ball_colours(lit, camera)

    # 2. Leave out what cannot show.
    visible, skipped = _on_screen(x, y, radius, camera)
    dark = sum(1 for sun in lit.suns if not sun.irradiance.any())
    if dark:
        row = Skipped("light", "suns without light", dark, len(lit.suns))
        skipped.append(row)
    # A ball fades in as the eye leaves it, so that none pops at the near plane.
    nearness = np.clip(depth / balls.radii, 0.0, 1.0)
    fade = nearness * nearness * (3.0 - 2.0 * nearness) * look.erosion_depth
    tau = np.stack(
        [ball_depths(balls, float(s), look) * fade for s in lit.medium.sigma_t]
    )
    brightest = max(colours.max(initial=0.0), pixels.max(initial=0.0))
    if haze is not None:
        brightest = max(brightest, float(haze.color.max()))
    visible, row = _without_faint(visible, tau.max(axis=0), brightest, tolerance)
    skipped += row

    # 3. Colours at the centres, and how they change over each ball.
    share = clearness(haze, balls.centers, camera)[:, None]
    haze_color = np.zeros(3) if haze is None else haze.color
    if look.neighbours and len(colours):
        blend = colour_blend(balls, neighbours=look.neighbours)
        colours, change = blended_colours(blend, colours)
    else:
        change = np.zeros((len(colours), 3, 3))
    colours = colours * share + haze_color * (1.0 - share)
    frame = axes(camera)
    change = np.einsum("fa,nac->nfc", frame, change * share[:, :, None])

    # 4. The noise that erodes footprints, over the visible balls only.
    detail = None
    if look.erosion > 0.0 and visible.any():
        seen = balls.centers[visible], balls.radii[visible][:, None]
        lower, upper = (seen[0] - seen[1]).min(axis=0), (seen[0] + seen[1]).max(axis=0)
        cell = look.erosion_cell * float(np.median(balls.radii))
        detail = detail_grid(lower, upper, cell=cell, seed=seed)
        skipped += detail.skipped
        watch("detail", detail)

    # 5. Far to near: draw. A grey medium needs one pass, a coloured one three (L12).
    order = depth_order(balls, depth)[::-1]
    order = order[visible[order]]
    watch("eye order", order)
    shading = Shading(frame, look, balls.kernel, detail)
    result = np.array(pixels)
    alphas = []
    for sigma_t in dict.fromkeys(lit.medium.sigma_t.tolist()):
        channels = np.flatnonzero(lit.medium.sigma_t == sigma_t)
        part = np.array(pixels)
        for k in order:
            draw_ball(
                part,
                shading,
                (float(x[k]), float(y[k]), float(radius[k])),
                float(tau[channels[0], k]),
                balls.centers[k],
                float(balls.radii[k]),
                colours[k],
                change[k],
            )
        result[..., channels] = part[..., channels]
        alphas += [part[..., 3]] * len(channels)
    result[..., 3] = alphas[0] if len(set(map(id, alphas))) == 1 else np.mean(alphas, 0)
    return result, tuple(skipped)


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
