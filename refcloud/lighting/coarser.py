"""Pass 1 in a smaller framebuffer where a tolerance allows it.

The mean over a ball is a sum over pixels: how far it is from that of the rules' own
buffer falls with the square of the balls' radii in pixels. So there are two tests, and
both must pass. The radii promise an error, from the worst of generated scenes; and the
light itself is carried at the side and at half of it, where the error is about four
times as large: what changes between them is certified to be small.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from refcloud.conventions import Array, Observer
from refcloud.lighting.depths import ball_depths
from refcloud.lighting.lightview import LightView
from refcloud.lighting.look import Look
from refcloud.lighting.share import Carry, Sweeps, light_share
from refcloud.optics import Medium

# Error of a share times the squared rise of the steepest ball in pixels, by `readback`.
# Worst seen where the change from half the side does not tell, in 17,700 sides of
# generated scenes: 0.019, 0.020, 0.17. The mean over a square has no such law. In 2,279
# other scenes the error was at most 0.57 of the bound that the two tests give.
PER_RISE = {"footprint": 0.05, "antialiased": 0.05, "disc": 0.5}
PER_CHANGE = 2.0  # over the change from half the side; 0.3 is common
LEAST_RISE = 1.0  # pixels: below it balls slip between pixels
LEAST_SIDE = 16  # pixels; half of it is the coarsest buffer
BUFFER, SWEEPS = 0.5, 1.0 / 16.0  # shares of what is allowed, where a side is tried


@dataclass(frozen=True, eq=False)
class Sized:
    """One light, carried in a buffer of some side.

    Attributes
    ----------
    share
        Of the light that reaches each ball, shape (N, 3), at least 0.
    sweeps
        Of each channel.
    pixels, whole
        Of the buffer, and of the rules' own.
    bound
        What the smaller buffer may change of a share; 0 in the rules' own.
    """

    share: Array
    sweeps: list[Sweeps]
    pixels: int
    whole: int
    bound: float = 0.0


def sized_share(
    view: LightView,
    medium: Medium,
    look: Look,
    forward: float,
    most: float,
    shrinks: bool,
    watch: Observer | None,
    carry: Carry | None = None,
) -> Sized:
    """Carry one light, in as small a buffer as its error allows, unchecked.

    Parameters
    ----------
    view
        The balls as the light sees them, in the rules' own buffer.
    medium, look, forward, watch, carry
        As `light_share`.
    most
        Largest error of a share.
    shrinks
        Whether half of that is kept for smaller buffers: see `may_shrink`.

    Returns
    -------
    The light.
    """
    whole = view.side**2
    if shrinks:
        allowed = BUFFER * most
        coarse = None  # the light at half the side that is tried
        for side in _promising(view, medium, look, most):
            how = medium, look, forward, SWEEPS * most, watch is not None
            fine, sweeps, seen = _at(side, view, *how)
            if coarse is not None:
                change = np.abs(fine - coarse[0]).max(initial=0.0)
                rough = max(run.bound for run in (*sweeps, *coarse[1], NONE))
                promised = (
                    PER_RISE[look.readback] / _rise(view, medium, look, side) ** 2
                )
                bound = max(PER_CHANGE * (float(change) + 2.0 * rough), promised)
                if bound <= allowed:
                    for name, value in seen:
                        if watch:
                            watch(name, value)
                    return Sized(fine, sweeps, side**2, whole, bound)
            coarse = fine, sweeps
        most -= allowed  # so that the errors of all lights add up to what is allowed
    share, sweeps = light_share(view, medium, look, forward, most, watch, carry)
    return Sized(share, sweeps, whole, whole)


NONE = Sweeps(0, 0.0)


def may_shrink(view: LightView, medium: Medium, look: Look, most: float) -> bool:
    """Tell whether a light's buffer may be smaller than the rules', as far as is seen.

    Parameters
    ----------
    view, medium, look, most
        As `sized_share`; an error of 0 keeps the buffer.

    Returns
    -------
    Whether it is worth a try.
    """
    return bool(_promising(view, medium, look, most))


def _promising(view: LightView, medium: Medium, look: Look, most: float) -> list[int]:
    """List the sides to try, ascending, after half of the first; none may be worth it.

    Half the rules' own side is the largest: from there on nothing is saved.
    """
    sides: list[int] = []
    side = view.side // 2
    if most <= 0.0 or look.readback not in PER_RISE:
        return sides
    while side >= LEAST_SIDE:
        rise = _rise(view, medium, look, side)
        if rise < LEAST_RISE or PER_RISE[look.readback] / rise**2 > BUFFER * most:
            break
        sides.append(side)
        side //= 2
    return [sides[-1] // 2, *sides[::-1]] if sides else []


def _rise(view: LightView, medium: Medium, look: Look, side: int) -> float:
    """Give the pixels over which the steepest ball becomes opaque, at a side."""
    deepest = ball_depths(view.balls, float(medium.sigma_t_rgb.max()), look)
    rise = view.radius / np.sqrt(np.maximum(deepest, 1.0))
    return float(rise.min()) * side / view.side


def _at(
    side: int,
    view: LightView,
    medium: Medium,
    look: Look,
    forward: float,
    most: float,
    watched: bool,
) -> tuple[Array, list[Sweeps], list[tuple[str, Any]]]:
    """Carry the light at another side; what would be watched is kept for later."""
    scale = side / view.side
    resized = dataclasses.replace(
        view,
        side=side,
        x=view.x * scale,
        y=view.y * scale,
        radius=view.radius * scale,
    )
    seen: list[tuple[str, Any]] = []
    share, sweeps = light_share(
        resized,
        medium,
        look,
        forward,
        most,
        (lambda name, value: seen.append((name, value))) if watched else None,
    )
    return share, sweeps, seen
