"""The splat benchmark: both passes of light, the literal loops against what is faster.

Ratios are to the literal loop in float64; errors are to the picture it draws, and for
pass 1 to the light of a buffer so fine that it no longer matters.
"""

from __future__ import annotations

import dataclasses
import functools
import importlib.util
from collections.abc import Callable
from typing import Any

from refcloud.bench import splat_scene
from refcloud.bench.subject import MS, Subject
from refcloud.bench.timing import Contender
from refcloud.conventions import Array
from refcloud.lighting import (
    LitMetaballs,
    Look,
    eyeward,
    eyeward_literal,
)
from refcloud.lighting.depths import ball_depths
from refcloud.lighting.lightview import light_view
from refcloud.lighting.literal_light import carried_literally

TOLERANCES = (1e-5, 1e-3, 1.5e-2)
# Numbers of balls, and those of a quick look: small, and no two alike.
COUNTS = {1200: 100, 10_000: 200, 100_000: 400}
LITERAL_SIDE, FINE_SIDE = 512, 700  # pixels of the sun's buffer
# Antialiased discs are read in smaller ones: of no larger error, up to 1200 and beyond.
SIDE, SIDE_OF_MANY = 184, 208
# Light that is off by less than this share of the sun's: the buffer's own error is
# larger, whether hard discs at 512 or antialiased ones.
LIGHT = 3e-3
LOOKS = {
    "flat": splat_scene.FLAT,
    "coloured": splat_scene.COLOURED,
    "cumulus": Look(),
}


@functools.cache
def lit(count: int, name: str) -> LitMetaballs:
    """Light the scene by one sun, once, for a look by name."""
    return splat_scene.lit(count, LOOKS[name])


def second_pass(count: int, name: str = "flat") -> list[Contender]:
    """List the ways to draw so many lit balls: the paper's splats, or the cumulus look.

    Parameters
    ----------
    count
        How many balls.
    name
        "flat", balls of one colour each under one white light; "coloured", such balls
        under sun, sky and ground; or "cumulus".

    Returns
    -------
    The contenders; the literal loop is the rival.
    """
    balls, camera = lit(count, name), splat_scene.eye()
    task = f"second pass N={count}" + ("" if name == "flat" else f" {name}")
    literal = functools.partial(eyeward_literal, balls, camera)
    reference = functools.cache(literal)

    def drawn(tolerance: float) -> Array:
        return eyeward(balls, camera, tolerance=tolerance)[0]

    listed: list[tuple[str, Callable[[], Any]]] = [
        ("refcloud tiles float64, exact", functools.partial(drawn, 0.0))
    ]
    listed += [
        (f"refcloud tolerance={tolerance:g}", functools.partial(drawn, tolerance))
        for tolerance in TOLERANCES
    ]
    found = [Contender(task, "literal loop float64", 1, literal, rival=True)]
    found += [Contender(task, what, 1, work, reference) for what, work in listed]
    if name == "flat" and (gl := _opengl()):
        found += gl.second_pass_with_opengl(count, reference)
    return found


def cumulus_look(count: int) -> list[Contender]:
    """List the ways to draw balls with eroded edges and light as a field."""
    return second_pass(count, "cumulus")


def coloured_light(count: int) -> list[Contender]:
    """List the ways to draw flat balls whose channels differ by more than a factor."""
    return second_pass(count, "coloured")


def first_pass(count: int) -> list[Contender]:
    """List the ways to light so many balls; errors are to the converged disc mean."""
    balls = splat_scene.balls(count)
    task = f"first pass N={count}"
    hard = splat_scene.FLAT
    soft = dataclasses.replace(hard, readback="antialiased")
    tau = ball_depths(balls, 1.0, hard)
    worth = splat_scene.worth(count)
    side = SIDE if count <= 1200 else SIDE_OF_MANY

    def literal() -> Array:
        view = light_view(balls, splat_scene.SUN.direction, LITERAL_SIDE)
        how = tau, splat_scene.ALBEDO, hard, hard.forward
        return carried_literally(view, *how)[0]

    def swept(look: Look, side: int, share: float) -> Array:
        # One light of its own: a tolerance counts colours, and this is their scale.
        sized = dataclasses.replace(look, buffer=side)
        lit = splat_scene.lit(count, sized, tolerance=share * worth)
        return lit.light[0, :, 0] / splat_scene.SUN.irradiance[0]

    reference = functools.cache(functools.partial(swept, soft, FINE_SIDE, 1e-4))
    rows = (
        (f"literal loop, hard discs, {LITERAL_SIDE}", literal),
        (
            f"sweeps, exact, hard discs, {LITERAL_SIDE}",
            functools.partial(swept, hard, LITERAL_SIDE, 0.0),
        ),
        (
            f"sweeps, exact, antialiased discs, {side}",
            functools.partial(swept, soft, side, 0.0),
        ),
        (
            f"sweeps, tolerance, antialiased discs, {side}",
            functools.partial(swept, soft, side, LIGHT),
        ),
    )
    found = [
        Contender(task, name, 1, work, reference, rival=name.startswith("literal"))
        for name, work in rows
    ]
    if gl := _opengl():
        found += gl.first_pass_with_opengl(count)
    return found


def _opengl() -> Any:
    """Give the contenders on OpenGL, None where there is no moderngl."""
    if importlib.util.find_spec("moderngl") is None:
        return None
    return importlib.import_module("refcloud.bench.splat_gl")


SPLAT = Subject(
    name="splat",
    title="both passes of light: the literal loops and what is faster",
    about=(
        "CPU time per frame of 1024x768, medians; error: largest, and rms over the"
        " picture, from the literal loop; of pass 1 from a converged buffer"
    ),
    lists=(
        *((second_pass, count, quick) for count, quick in COUNTS.items()),
        *((coloured_light, count, COUNTS[count]) for count in (1200, 10_000)),
        (cumulus_look, 1200, COUNTS[1200]),
        *((first_pass, count, COUNTS[count]) for count in (1200, 10_000)),
    ),
    peers=("moderngl",),
    unit=MS,
    rms=True,
    reference="the literal loop, 1e-12 from its plain twin; of pass 1 a buffer of"
    f" {FINE_SIDE} pixels",
)
