"""The pixels of the light's framebuffer tile by tile: for sweeps within a tolerance.

As `fragments`, but a ball is listed by the tile, at all of its 4 x 4 pixels, whether it
covers them or not: pairs of ball and tile are far fewer than fragments, nothing is
sorted or looked up by the pixel, and one small product of matrices, in float32, gives
a ball's squared distances to 16 pixels (see `quadratics`).
"""

from __future__ import annotations

import numpy as np

from refcloud.conventions import Array
from refcloud.lighting.fragments import MOST_FRAGMENTS, Fragments, slot_after_slot
from refcloud.lighting.lightview import LightView
from refcloud.lighting.look import Look
from refcloud.raster.quadratics import FORMS
from refcloud.raster.splat import SOFT_EDGE
from refcloud.raster.tile_lists import Discs, ranges_of, tile_lists

EDGE = 4  # pixels along a tile's edge: balls of a few pixels touch few others
TOGETHER = 2048  # pairs at a time: they stay in the cache, and products are small ones
READ = ("footprint", "antialiased")  # means that no rounding makes jump


def light_tiles(view: LightView, look: Look, tau: Array) -> Fragments | None:
    """List the tiles of a light's view with their balls, in float32.

    Parameters
    ----------
    view
        The balls as the light sees them.
    look
        Its `footprint` and `readback`.
    tau
        Largest optical depth of each ball on its axis, shape (N,).

    Returns
    -------
    The tiles; None where they do not serve: other kernels and means, balls between
    pixels, too many pairs.
    """
    side, order = view.side, view.order
    if view.balls.kernel != "wyvill" or look.readback not in READ:
        return None
    x, y, radius = (np.asarray(a[order]) for a in (view.x, view.y, view.radius))
    soft = SOFT_EDGE if look.readback == "antialiased" else 0.0

    # 1. The balls of each tile, near to far, then slot after slot.
    discs = Discs(x, y, radius + soft)
    ranges = ranges_of(discs, side, side, EDGE)
    listed = ranges.tiles()
    if float(listed.sum(dtype=np.float64)) * EDGE**2 > 4.0 * MOST_FRAGMENTS:
        return None
    across = -(-side // EDGE)
    lists = tile_lists(discs, ranges, listed, (0, across, 0, across), EDGE)
    ranked, counts, place = slot_after_slot(lists.count)
    ball = lists.ball.take(place)
    tile = np.concatenate([ranked[:count] for count in counts] or [ranked])
    inverse = (1.0 / radius).take(ball)
    middle = [(at + 0.5) * EDGE for at in (lists.column, lists.row)]
    cx, cy = (
        (at.take(ball) - mid.take(tile)) * inverse
        for at, mid in zip((x, y), middle, strict=True)
    )

    # 2. q = cx^2 + cy^2 - 2 cx x / r - 2 cy y / r + (x^2 + y^2) / r^2 as a product.
    four = np.empty((len(ball), 4), np.float32)
    four[:, 0] = cx * cx + cy * cy
    four[:, 1] = -2.0 * cx * inverse
    four[:, 2] = -2.0 * cy * inverse
    four[:, 3] = inverse * inverse
    step = np.arange(0.5 - EDGE / 2, EDGE / 2)
    px, py = np.tile(step, EDGE), np.repeat(step, EDGE)
    basis = np.stack([np.ones_like(px), px, py, px * px + py * py]).astype(np.float32)
    wide = radius.astype(np.float32).take(ball)[:, None]
    form, zeros = FORMS[look.footprint], np.zeros((TOGETHER, EDGE**2), np.float32)
    ones = zeros + np.float32(1.0)
    # In one piece: the system maps large ones in large pages, which is soon done.
    weight, read = np.empty((2, len(ball), EDGE**2), np.float32)
    if look.readback == "footprint":
        read = weight
    for begin in range(0, len(ball), TOGETHER):
        here = slice(begin, begin + TOGETHER)
        q = four[here] @ basis
        n = len(q)
        np.maximum(q, zeros[:n], out=q)
        v = np.subtract(ones[:n], q)
        np.maximum(v, zeros[:n], out=v)
        np.add(v, np.float32(form.shift), out=weight[here])
        weight[here] *= np.float32(form.leading)
        form.times_power(v, weight[here])
        if look.readback == "antialiased":
            np.sqrt(q, out=q)
            q *= -wide[here]
            q += wide[here] + np.float32(soft)
            np.minimum(q, ones[:n], out=q)
            np.maximum(q, zeros[:n], out=read[here])

    # 3. Pixels beyond the buffer's edge are not read.
    used = ranked[: counts[0] if counts else 0]
    i = (lists.column[used] * EDGE)[:, None] + np.tile(np.arange(EDGE), EDGE)
    j = (lists.row[used] * EDGE)[:, None] + np.repeat(np.arange(EDGE), EDGE)
    inside = (i < side) & (j < side)
    if not inside.all():
        if read is weight:
            read = weight.copy()
        begin = 0
        for count in counts:
            read[begin : begin + count] *= inside[:count]
            begin += count
    number = order.take(ball)
    sums = np.einsum("ts->t", read)
    total = np.bincount(number, sums, minlength=len(order)).astype(np.float64)
    if not (total > 0.0).all():
        return None

    # 4. Roundings, as of `cancelling`: q's terms are up to (1 + d / r)^2 together at a
    #    distance d from a tile's middle; what passes a ball, and a mean, change by so
    #    many times that. A pixel's list is at most its tile's.
    terms = np.square(1.0 + (EDGE - 1.0) * np.sqrt(0.5) / radius)
    steep = 3.0 if look.transmittance == "linear" else 1.7 * np.sqrt(tau[order])
    each = 1.0 + 2.0 * terms * steep
    added = float(np.add.reduceat(each.take(lists.ball), lists.first).max())
    return Fragments(
        number,
        weight,
        read,
        total,
        counts,
        np.where(inside, j * side + i, side * side),
        added + 8.0 * (1.0 + 4.0 * float(terms.max())),
    )
