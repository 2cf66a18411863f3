"""The two passes of light, setting by setting: buffers, sweeps and tolerances.

The scene is that of the splat benchmark, 1200 balls. Pass 1 is told in shares of the
sun's light that reach the balls, pass 2 in displayed white.
"""

from __future__ import annotations

import dataclasses
import functools

from refcloud.bench import splat_scene
from refcloud.bench.splat import FINE_SIDE, lit
from refcloud.bench.subject import MS, Subject
from refcloud.bench.timing import Contender
from refcloud.conventions import Array
from refcloud.lighting import eyeward
from refcloud.lighting.look import Look

SIDES = (32, 64, 128, 256, 512)  # pixels of the sun's buffer
# In a buffer as fine as the reference's the sweeps' own error shows.
SWEPT = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6)
TOLERANCES = (1e-1, 3e-2, 1e-2, 1.0 / 255.0, 1e-3, 1e-4, 1e-5)
COUNT, QUICK_COUNT = 1200, 100
READBACKS = ("disc", "antialiased", "footprint")


def light(count: int, look: Look, side: int, share: float) -> Array:
    """Give the share of the sun's light that reaches each ball, to a tolerance."""
    sized = dataclasses.replace(look, buffer=side)
    scale = splat_scene.worth(count)  # a tolerance counts colours: this is their scale
    made = splat_scene.lit(count, sized, tolerance=min(share * scale, 1.0))
    return made.light[0, :, 0] / splat_scene.SUN.irradiance[0]


def buffers(count: int) -> list[Contender]:
    """List sides of the sun's buffer and ways to read it, each exactly swept."""
    found = []
    for readback in READBACKS:
        look = dataclasses.replace(splat_scene.FLAT, readback=readback)
        # The square of the footprint weighs a ball's middle: another mean, on purpose.
        own = readback if readback == "footprint" else "antialiased"
        fine = dataclasses.replace(look, readback=own)
        exact = functools.cache(functools.partial(light, count, fine, FINE_SIDE, 0.0))
        found += [
            Contender(
                f"buffer, {readback}",
                f"refcloud side {side}",
                1,
                functools.partial(light, count, look, side, 0.0),
                exact,
            )
            for side in SIDES
        ]
    return found


def sweeps(count: int) -> list[Contender]:
    """List tolerances of the sweeps, against as many as float64 can tell apart."""
    look = dataclasses.replace(splat_scene.FLAT, readback="antialiased")
    side = 192
    exact = functools.cache(functools.partial(light, count, look, side, 0.0))
    return [
        Contender(
            f"sweeps, side {side}",
            f"refcloud share off by {share:g}" if share else "refcloud exact",
            1,
            functools.partial(light, count, look, side, share),
            exact,
        )
        for share in (*SWEPT, 0.0)
    ]


def seen(count: int, name: str) -> list[Contender]:
    """List tolerances of pass 2 for a look by name: "flat" or "cumulus"."""
    camera = splat_scene.eye()

    def drawn(tolerance: float) -> Array:
        return eyeward(lit(count, name), camera, tolerance=tolerance)[0]

    exact = functools.cache(functools.partial(drawn, 0.0))
    return [
        Contender(
            f"pass 2, {name}",
            f"refcloud tolerance {tolerance:.2g}" if tolerance else "refcloud exact",
            1,
            functools.partial(drawn, tolerance),
            exact,
        )
        for tolerance in (*TOLERANCES, 0.0)
    ]


def flat(count: int) -> list[Contender]:
    """List pass 2 for balls of one colour each."""
    return seen(count, "flat")


def cumulus(count: int) -> list[Contender]:
    """List pass 2 for the look "cumulus": light as a field, eroded footprints."""
    return seen(count, "cumulus")


SUNWARD = Subject(
    name="sunward",
    title="pass 1: sides of the sun's buffer, ways to read it, sweeps",
    about=f"CPU time of pass 1 for {COUNT} balls, medians; error: largest of a share of"
    " the sun's light, and rms",
    lists=((buffers, COUNT, QUICK_COUNT), (sweeps, COUNT, QUICK_COUNT)),
    unit=MS,
    digits=2,
    rms=True,
    reference=f"a buffer of {FINE_SIDE} pixels, exactly swept; of sweeps all of them",
)

EYEWARD = Subject(
    name="eyeward",
    title="pass 2: tolerances, for flat balls and for the look cumulus",
    about=f"CPU time of pass 2 for {COUNT} balls at 1024x768, medians; error: largest"
    " of a channel, and rms, in displayed white",
    lists=((flat, COUNT, QUICK_COUNT), (cumulus, COUNT, QUICK_COUNT)),
    unit=MS,
    digits=2,
    rms=True,
    reference="tolerance 0, 1e-12 from the literal loop",
)
