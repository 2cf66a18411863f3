"""Pass 2: the light that the balls send to the eye (paper M, section 4.2).

Balls are drawn far to near over the background; each adds what it scatters toward the
eye and lets through the rest: c = 1 g* + T c (eq 28, 29). Nothing is read back. With a
tolerance they are drawn near to far, under each other: the same sums, and what lies
behind an opaque front need not be drawn.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.camera import AnyCamera
from refcloud.checking import checked
from refcloud.conventions import Array, Observer, Range, Seed, Shape, Skipped, Tolerance
from refcloud.lighting.certified_tiles import certified_tiles
from refcloud.lighting.colours import Haze
from refcloud.lighting.ends import refuse_extreme_eye
from refcloud.lighting.flat_tiles import flat_balls
from refcloud.lighting.fronts import fill, half_width, hull_of
from refcloud.lighting.hidden import without_faint
from refcloud.lighting.lit import LitMetaballs
from refcloud.lighting.proved_tiles import DIGITS, ProvedTiles, digits_of
from refcloud.lighting.seen import seen_by, shading_of
from refcloud.raster.canvas import Canvas
from refcloud.raster.tile_lists import PIXELS, parts

# Shares of the tolerance: for balls left out as faint, and for those behind an opaque
# front. Nodes need most of a tolerance that is large enough for them; float32 needs
# less; elsewhere the front has all the rest.
FAINT, OPAQUE, OPAQUE_OF_NODES = 1.0 / 16.0, 0.5, 1.0 / 16.0
NODES_FROM = 4e-4
ROUNDED = 2.0**-50  # what passes less than this changes the last bits of a sum alone


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
    refuse_extreme_eye(camera)
    size = (camera.height, camera.width)
    if background is not None and background.shape != (*size, 3):
        raise ValueError(
            f"background: expected shape {(*size, 3)}, that of the picture,"
            f" got {background.shape}"
        )
    # 1. What the eye sees of every ball; leave out what cannot show.
    seen, skipped = seen_by(lit, camera, haze)
    # Alpha counts as a channel: what may change is 1 at least.
    over = background is not None
    behind = 0.0 if background is None else float(background.max(initial=0.0))
    brightest = max(1.0, seen.brightest(), behind)
    visible, rows = without_faint(
        seen.order,
        seen.shown,
        seen.tau.max(axis=0),
        brightest,
        FAINT * tolerance,
    )
    skipped += rows
    left = tolerance - sum(row.bound for row in rows)

    drawn = seen.order[visible[seen.order]]
    flat, look = flat_balls(seen, drawn), lit.look
    smooth = not (look.light_reach > 0.0 or look.erosion > 0.0)
    by_products = smooth and lit.balls.kernel == "wyvill"
    shows = flat.shown if by_products else [(channel, 1.0) for channel in range(3)]

    # 2. What the rest of the tolerance goes to. Behind pixels that let no more than
    # `least` pass, all together changes less than the front's part: it is between 0 and
    # the brightest, or off the middle of what it can be by less, seen through them.
    front, digits, width = left, 0.0, brightest
    low = high = np.zeros(3)
    if by_products:
        front = (OPAQUE_OF_NODES if tolerance >= NODES_FROM else OPAQUE) * tolerance
    elif tolerance > 0.0:
        digits = digits_of(seen, drawn, brightest, tolerance)
        low, high = hull_of(seen, background)
        front -= DIGITS * tolerance  # whatever comes of it: rows of clouds add up
        width = max(half_width(low, high, over), front)
    least = max(front / width, ROUNDED)
    most = left - front

    # 3. Light as a field, and the noise that erodes footprints.
    shading, rows = shading_of(seen, seed, observe, single=digits > 0.0)
    skipped += rows
    watch("eye order", drawn)

    # 4. Draw tile after tile, each from the front, before the background.
    canvas = Canvas(camera.width, camera.height, background)
    shaded = ProvedTiles(
        seen,
        drawn,
        shading,
        lambda: shading_of(seen, seed, None)[0],
        digits,
        brightest,
    )
    hidden = looked = 0
    for lists in parts(flat.discs, camera.width, camera.height):
        if by_products:
            found, rows = certified_tiles(lists, flat, least, most, brightest, behind)
            skipped += rows
        else:
            found = shaded.draw(lists, least)
            if tolerance > 0.0:
                fill(found, flat.groups, least, low, high, over)
        canvas.paint(lists, flat.groups, found.light, found.clear, shows)
        hidden += PIXELS * int(found.unseen.sum()) + found.closed
        looked += PIXELS * len(lists.ball)
    skipped += shaded.rows()
    if hidden:
        what = "pixels of balls' tiles behind opaque ones"
        skipped.append(Skipped("eye", what, hidden, looked, least * width))
    return canvas.pixels(), tuple(skipped)
