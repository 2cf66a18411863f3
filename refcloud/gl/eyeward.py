"""Pass 2 on OpenGL: the literal loop, one quad for each ball, blended far to near.

The balls' places, depths and colours are those of refcloud.lighting.seen; what a ball
adds to a pixel is computed by the shader, in float32.
"""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import AnyCamera
from refcloud.checking import checked
from refcloud.cloudmap import cell_size
from refcloud.conventions import Array, Observer, Range, Seed, Shape, Skipped, Tolerance
from refcloud.gl.fragments import clear
from refcloud.gl.quads import ball_rows, bind, compiled, draw, set_uniforms
from refcloud.gl.shaders import BALL, DETAIL, FIELD, FIXED, HAZE, eyeward_source
from refcloud.gl.tables import cells_from, table
from refcloud.gl.target import Target, framebuffer, read_pixels, write_pixels
from refcloud.lighting.colours import Haze
from refcloud.lighting.hidden import without_faint
from refcloud.lighting.lit import LitMetaballs
from refcloud.lighting.seen import Seen, seen_by, shading_of
from refcloud.lighting.shading import Shading


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
    """Draw lit balls as the camera sees them, on OpenGL: pass 2.

    Formula: I*_k = g*_k + T_k I*_{k-1} from the farthest ball on, I*_0 the background

    Parameters
    ----------
    lit
        The balls and their light, of either `sunward`.
    camera
        Pinhole or orthographic.
    background
        Linear RGB, shape (H, W, 3) of the camera's size; None leaves it transparent.
    haze
        Air in front of the balls; None for none.
    tolerance
        Largest change of a channel that leaving out faint balls may make. float32 adds
        its own errors, below 1e-4 of the brightest; N equal layers may add N / 2^25.
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
        There is no OpenGL, it cannot hold the picture, or the background has another
        size.

    Source: paper M, eq 28 and 29, L10, L11; E04, E25, E26.
    """
    watch = observe or (lambda name, value: None)
    size = (camera.height, camera.width)
    if background is not None and background.shape != (*size, 3):
        raise ValueError(
            f"background: expected shape {(*size, 3)}, that of the picture,"
            f" got {background.shape}"
        )
    # 1. What the eye sees of every ball, as in numpy.
    seen, skipped = seen_by(lit, camera, haze)
    behind = 0.0 if background is None else float(background.max(initial=0.0))
    brightest = max(1.0, seen.brightest(), behind)
    visible, rows = without_faint(
        seen.order, seen.shown, seen.tau.max(axis=0), brightest, tolerance
    )
    skipped += rows
    shading, more = shading_of(seen, seed, watch)
    skipped += more
    drawn = seen.order[visible[seen.order]][::-1]
    watch("eye order", drawn[::-1])

    # 2. The framebuffer starts as what lies behind. Light is counted in a unit that
    #    keeps it near 1: float32 has no room for every irradiance.
    unit = 2.0 ** math.floor(math.log2(brightest))
    target = framebuffer(camera.width, camera.height)
    quads = _quads_for(seen, shading)
    held = _shared_tables(quads, shading, unit)

    # 3. Draw, far to near. A grey medium needs one pass, a coloured one three (L12).
    parts = []
    for channels in seen.channel_groups():
        _start(target, background, unit)
        rows = _table_of(seen, shading, drawn, channels[0], unit)
        balls = table(rows.reshape(-1, 4))  # held until all is drawn
        bind(target, balls, rows.shape[1], quads)
        draw(quads, len(rows))
        parts.append((channels, read_pixels(target, slice(None), slice(None))))
    del held
    pixels = parts[0][1]
    if len(parts) > 1:
        alpha = sum(part[..., 3] * (len(channels) / 3.0) for channels, part in parts)
        for channels, part in parts:
            pixels[..., channels] = part[..., channels]
        pixels[..., 3] = alpha
    if unit != 1.0:
        pixels[..., :3] *= unit
    return pixels, tuple(skipped)


def _start(target: Target, background: Array | None, unit: float) -> None:
    """Fill the framebuffer with what lies behind, or with nothing."""
    if background is None:
        clear(target, np.zeros(4))
        return
    behind = np.ones((*background.shape[:2], 4))
    np.divide(background, unit, out=behind[..., :3])
    write_pixels(target, behind)


def _table_of(
    seen: Seen, shading: Shading, drawn: NDArray[np.intp], channel: int, unit: float
) -> Array:
    """Lay out what the shader needs of each ball, (balls, columns, 4), in order."""
    balls = seen.lit.balls
    colours = seen.colours[drawn] / unit
    rows = ball_rows(
        FIXED + colours.shape[1],
        seen.x[drawn],
        seen.y[drawn],
        seen.radius[drawn],
        seen.tau[channel][drawn],
        (seen.camera.width, seen.camera.height),
    )
    clear = seen.clear[drawn]
    rows[:, BALL, 3] = clear
    rows[:, HAZE, :3] = seen.air * (1.0 - clear)[:, None] / unit
    centers, R = balls.centers[drawn], balls.radii[drawn]
    if shading.detail is not None:
        size = cell_size(shading.detail)
        cells = cells_from(centers, shading.detail.lower + 0.5 * size, size)
        rows[:, DETAIL : DETAIL + 2, :3] = np.stack(cells, axis=1)
        rows[:, DETAIL, 3] = R / size[0]
    if shading.field is not None:
        cells = cells_from(centers, shading.field.lower, shading.field.spacing)
        rows[:, FIELD : FIELD + 2, :3] = np.stack(cells, axis=1)
        rows[:, FIELD, 3] = R / shading.field.spacing
    rows[:, FIXED:, :3] = colours
    return rows


def _quads_for(seen: Seen, shading: Shading) -> Any:
    """Compile the shaders for these rules, and tell them what all balls share."""
    look, suns = shading.look, len(seen.lit.suns)
    quads = compiled(
        eyeward_source(
            look,
            shading.kernel,
            detail=shading.detail is not None,
            field=shading.field is not None,
            suns=suns,
        )
    )
    frame = shading.frame.ravel().tolist()
    set_uniforms(
        quads, suns=suns, frame=frame, erosion=look.erosion, relief=look.relief
    )
    return quads


def _shared_tables(quads: Any, shading: Shading, unit: float) -> list[Any]:
    """Put the noise and the light field into textures; whoever draws holds them."""
    held, detail, field = [], shading.detail, shading.field
    if detail is not None:
        D, H, W = detail.density.shape
        held.append(table(detail.density.reshape(-1, 1)))
        held[-1].use(1)
        size = cell_size(detail)
        steps = (shading.toward / size).tolist() or [(0.0, 0.0, 0.0)]
        set_uniforms(quads, detail=1, detail_count=(W, H, D))
        set_uniforms(quads, toward=steps if len(steps) > 1 else tuple(steps[0]))
    if field is not None:
        D, H, W, channels = field.sums.shape
        # One texel for each light: the sums of its colour, and of the weights.
        lights = (channels - 1) // 3
        texels = np.empty((D * H * W, lights, 4))
        texels[..., :3] = field.sums[..., :-1].reshape(-1, lights, 3) / unit
        texels[..., 3] = field.sums[..., -1].reshape(-1, 1)
        held.append(table(texels.reshape(-1, 4)))
        held[-1].use(2)
        set_uniforms(quads, field=2, field_count=(W, H, D))
    return held
