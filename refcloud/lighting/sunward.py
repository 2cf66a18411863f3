"""Pass 1: how much of each sun's light reaches each ball (paper M, section 4.1).

The camera stands at the sun. Balls are drawn near to far; before a ball is drawn, the
framebuffer is read back over its projection: the mean is the light that reaches it.
`literal_light` does just that; here all balls read at once, in `sweeps`.
"""

from __future__ import annotations

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Observer, Skipped, Tolerance
from refcloud.lighting.coarser import Sized, may_shrink, sized_share
from refcloud.lighting.ends import refuse_extreme
from refcloud.lighting.gain import gain_of
from refcloud.lighting.lightview import light_view
from refcloud.lighting.lit import LitMetaballs
from refcloud.lighting.look import Look, LookName, named
from refcloud.lighting.reuse import same_lights
from refcloud.lighting.share import Carry
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun, phase

FROM_ABOVE = np.array([0.0, 1.0, 0.0])


@checked
def sunward(
    balls: Metaballs,
    suns: tuple[Sun, ...],
    *,
    medium: Medium,
    look: Look | LookName = "cumulus",
    tolerance: Tolerance = 0.0,
    earlier: LitMetaballs | None = None,
    observe: Observer | None = None,
) -> LitMetaballs:
    """Carry every sun's light through the balls: pass 1.

    Formula: I_k = g_{k-1} + T_{k-1} I_{k-1}, I_1 = I_0, T = exp(-tau), where I_k is the
    mean of the framebuffer over ball k

    Parameters
    ----------
    balls
        The cloud.
    suns
        Each is carried by itself; the results add up.
    medium
        Extinction and albedo; coloured ones are carried channel by channel.
    look
        The rules, or their name.
    tolerance
        Largest change of a ball's colour, toward any eye, that ending the sweeps early
        and smaller buffers may make; 0 carries the light as exactly as float64 allows.
    earlier
        What an earlier call of that tolerance gave: a light that shines on the same
        balls by the same rules as there is not carried again (L15).
    observe
        Called with (name, value): order and framebuffer of each light, as "sun 0
        order", "sun 0 buffer", ..., "sky ...", "ground ..."; of a coloured medium once
        for each channel.

    Returns
    -------
    The lit balls; their `skipped` tells of the sweeps and the buffers.

    Raises
    ------
    ValueError
        With gain="refuse", where eq 26 would make light.

    Source: paper M, eq 26 to 28, L04 to L09, L12, L13; E22 to E27.
    """
    refuse_extreme(balls, suns, medium)
    return lit_by(balls, suns, medium, named(look), tolerance, earlier, observe)


def lit_by(
    balls: Metaballs,
    suns: tuple[Sun, ...],
    medium: Medium,
    rules: Look,
    tolerance: float,
    earlier: LitMetaballs | None,
    observe: Observer | None,
    carry: Carry | None = None,
) -> LitMetaballs:
    """Carry every light through the balls without a check: the inner form of `sunward`.

    Parameters
    ----------
    balls, suns, medium, rules, tolerance, earlier, observe
        As `sunward`.
    carry
        How one light is carried; None for the fastest way in numpy.

    Returns
    -------
    As `sunward`.
    """
    count = len(balls.radii)
    lights = [
        (f"sun {number}", sun.direction, sun.irradiance)
        for number, sun in enumerate(suns)
    ]
    lights += [
        ("sky", FROM_ABOVE, rules.sky_light),
        ("ground", -FROM_ABOVE, rules.ground_light),
    ]
    worth = worth_of_light(balls, suns, medium, rules)
    light = np.zeros((len(suns), count, 3))
    ambient = np.zeros((count, 3))
    carried: list[Sized] = []
    kept = same_lights(earlier, balls, suns, medium, rules)
    most = tolerance / worth if worth > 0.0 else 0.0
    views = [
        light_view(balls, way, rules.buffer if k < len(suns) else rules.sky_buffer)
        if color.any() and count
        else None
        for k, (_, way, color) in enumerate(lights)
    ]
    # Where one buffer may shrink all sweeps get less, so that the bounds add up.
    shrinks = carry is None and any(
        may_shrink(view, medium, rules, most) for view in views if view is not None
    )
    for number, (name, _, color) in enumerate(lights):
        view = views[number]
        if view is None:
            continue
        is_sun = number < len(suns)
        if earlier is not None and is_sun and number in kept.suns:
            light[number] = earlier.light[kept.suns[number]]
            continue
        if earlier is not None and not is_sun and kept.ambient:
            ambient = earlier.ambient
            continue
        found = sized_share(
            view,
            medium,
            rules,
            rules.forward if is_sun else rules.sky_forward,
            most,
            shrinks,
            _labelled(observe, name),
            carry,
        )
        carried.append(found)
        if is_sun:
            light[number] = found.share * color
        else:
            ambient += found.share * color
    skipped: list[Skipped] = []
    if tolerance > 0.0:
        skipped += _savings(carried, count, worth)
    if earlier is not None and kept.number:
        what = "lights that were carried before"
        skipped.append(Skipped("light", what, kept.number, len(suns) + 2))
        skipped += [row for row in earlier.skipped if row.bound > 0.0]
    return LitMetaballs(
        balls, tuple(suns), light, ambient, medium, rules, tuple(skipped)
    )


def _savings(carried: list[Sized], count: int, worth: float) -> list[Skipped]:
    """Report the sweeps and the pixels that a tolerance saved, over all lights."""
    rows = []
    if sweeps := [run for found in carried for run in found.sweeps]:
        # Nilpotent: as many sweeps as balls are exact, whatever the cloud.
        left = sum(max(count - run.number, 0) for run in sweeps)
        bound = worth * max(run.bound for run in sweeps)
        what = "sweeps over all balls"
        rows.append(Skipped("light", what, left, count * len(sweeps), bound))
    if left := sum(found.whole - found.pixels for found in carried):
        what, of = "pixels of the lights' buffers", sum(f.whole for f in carried)
        bound = worth * max(found.bound for found in carried)
        rows.append(Skipped("light", what, left, of, bound, how="certified"))
    return rows


def _labelled(watch: Observer | None, light: str) -> Observer | None:
    """Let what is watched say which light it is of."""
    return watch and (lambda name, value: watch(f"{light} {name}", value))


def worth_of_light(
    balls: Metaballs, suns: tuple[Sun, ...], medium: Medium, look: Look
) -> float:
    """Bound how much a ball's colour changes where all lights' shares change by 1.

    Proved: a colour is the sum over the lights of share times irradiance, albedo,
    phase function and the rule's gain, or of share times albedo and the light of sky
    or ground (`ball_colours`); a phase function is largest forward or backward. A
    pixel shows a mean of colours, so it changes by no more.
    """
    peak = float(np.max(phase(medium, np.array([-1.0, 1.0]))))
    light = sum((sun.irradiance for sun in suns), np.zeros(3))
    gain = gain_of(balls, medium, look).max(axis=0, initial=0.0)
    sky = look.sky_light + look.ground_light
    return float(np.max(medium.albedo_rgb * (peak * gain * light + sky)))
