"""Pass 1 as a fixed point: all balls read the framebuffer at once, again and again.

What reaches ball k depends only on nearer balls: with the direct light d and the share
C_kj of what ball j scatters that ball k reads, I = d + C I, C strictly lower
triangular. The literal loop solves it ball by ball. A sweep puts a guess of all I into
the framebuffer's recurrence and reads all means:

    I_{n+1} = d + C I_n        (the Neumann series: d + C d + C^2 d + ...)

C is nilpotent, so that enough sweeps are exact. Far fewer do: a row of C sums to at
most kappa = max g / (1 - T) < 1, since a buffer that starts at 0 and takes in g times 1
never passes g / (1 - T). So the error after a sweep that changed I by delta is at most
kappa / (1 - kappa) delta: proved, and the sweeps end when that is small enough.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from refcloud.conventions import Array
from refcloud.lighting.fragments import Floats, Fragments
from refcloud.lighting.lightview import handed_on
from refcloud.lighting.look import Look
from refcloud.raster.tiles import DEEPEST

CACHED = 1 << 15  # fragments whose g and T are computed at a time
ROUNDED = 1e-15  # of the light: sweeps that change less only move last bits


@dataclass(frozen=True, eq=False)
class Carried:
    """What the sweeps found.

    Attributes
    ----------
    reached
        Share of the light that reaches each ball, shape (N,).
    bound
        Largest error of it.
    changes
        How much each sweep changed it, at most.
    buffer
        The framebuffer behind the last ball, one channel, by `Fragments.pixel`.
    """

    reached: Array
    bound: float
    changes: list[float]
    buffer: Floats


def carried(
    found: Fragments,
    tau: Array,
    albedo: float,
    look: Look,
    forward: float,
    most: float,
) -> Carried:
    """Run pass 1 for one light and one colour channel by sweeps, unchecked.

    Parameters
    ----------
    found
        The fragments of the light's view.
    tau, albedo, look, forward
        As `carried_literally`.
    most
        Largest error of a share; 0 for all that float64 gives.

    Returns
    -------
    The light.
    """
    # 1. What each fragment scatters on and lets through, g and T of eq 27.
    scatter = handed_on(look, albedo, forward)
    on_axis = scatter(tau)
    dtype = found.weight.dtype
    if look.transmittance == "linear":
        g: Floats = found.weight * found.spread(on_axis.astype(dtype))
        T: Floats = 1.0 - found.weight * found.spread((-np.expm1(-tau)).astype(dtype))
    else:
        deep = np.minimum(tau, DEEPEST[dtype.type]).astype(dtype)
        depth = found.spread(deep)
        both: Floats = np.empty((2, *found.weight.shape), dtype)  # in large pages
        g, T = both[0], both[1]
        piece = max(CACHED * len(g) // max(g.size, 1), 1)
        for begin in range(0, len(g), piece):
            here = slice(begin, begin + piece)
            thickness = found.weight[here] * depth[here]
            g[here] = scatter(thickness)
            np.negative(thickness, out=thickness)
            np.exp(thickness, out=T[here])
    kappa = largest_gain(tau, albedo, look, forward)

    # 2. The first guess: every pixel's light meets the ball as if it were the mean.
    reached = _read(found, T, g, None, len(tau))[0]
    # 3. Sweep until the proved bound is small enough.
    target = max(most, ROUNDED)
    changes: list[float] = []
    # Each step of a list rounds, and a change smaller than that means nothing.
    rough = found.rough
    still = ROUNDED if dtype == np.float64 else rough
    while True:
        sent = found.spread(reached.astype(dtype))
        again, buffer = _read(found, T, g, sent, len(tau))
        change = float(np.abs(again - reached).max(initial=0.0))
        reached = again
        changes.append(change)
        bound = rough * len(tau)  # where no light is lost, all roundings add up
        if kappa < 1.0:
            bound = (kappa * change + rough) / (1.0 - kappa)
        if (kappa < 1.0 and bound <= target) or change <= still:
            break
        if len(changes) > len(tau):
            break  # nilpotent: this is exact
    return Carried(reached, bound, changes, buffer)


def largest_gain(tau: Array, albedo: float, look: Look, forward: float) -> float:
    """Give the largest g / (1 - T) of any ball at any place, in [0, 1].

    For "split" it is k where a ball is thin, and less elsewhere. For eq 26 it rises
    with the depth, so that the axis of the deepest ball has it.

    Parameters
    ----------
    tau, albedo, look, forward
        As `carried`.

    Returns
    -------
    kappa; below 1 the sweeps are known to converge by at least that factor each.
    """
    if look.scattering == "split":
        return albedo * forward
    opacity = -np.expm1(-tau)
    shown = opacity > 0.0
    ratio = handed_on(look, albedo, forward)(tau[shown]) / opacity[shown]
    return min(float(np.max(ratio, initial=0.0)), 1.0)


def _read(
    found: Fragments, T: Floats, g: Floats, sent: Floats | None, count: int
) -> tuple[Array, Floats]:
    """Run c = T c + g sent over every pixel's list, and read the mean of each ball.

    Without `sent` the pixel's own light is taken for the mean: c = (T + g) c.

    Returns
    -------
    The means, shape (count,), and the buffer behind the last ball.
    """
    buffer = np.ones(found.pixel.shape, T.dtype)
    space = np.empty_like(buffer)
    together = T.ndim == 2
    every = np.ones(T.shape[1:], T.dtype)
    before = np.empty(len(T), T.dtype)  # found in the buffer
    begin = 0
    for n in found.counts:
        here, room = buffer[:n], space[:n]
        now = slice(begin, begin + n)
        if together:
            np.matmul(np.multiply(here, found.read[now], out=room), every, before[now])
        else:
            before[now] = here
        if sent is None:
            here *= np.add(T[now], g[now], out=room)
        else:
            here *= T[now]
            here += np.multiply(g[now], sent[now], out=room)
        begin += n
    if not together:
        before *= found.read
    return np.bincount(found.ball, before, minlength=count) / found.total, buffer
