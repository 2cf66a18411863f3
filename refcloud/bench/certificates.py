"""How often a certificate fails: generated scenes, exactly and to a tolerance.

A certified saving was compared with the exact method on a sample of its own picture,
which may miss the worst place (`Skipped.how`). Here that risk is counted: scenes are
drawn by an integer hash of their number, so that each can be drawn again.

Measured, tolerances from 1e-4 to 1e-1: of 6000 pictures of splats by the paper's
rules none was off by more than asked, nor of 3000 of the look cumulus, of 1000 marched
ones or of 30 of every order of scattering; of 50 large marched ones one was, by .2 %.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from refcloud.bench.scattering import lumpy
from refcloud.bench.subject import columns
from refcloud.camera import Camera
from refcloud.compose import WHITE
from refcloud.conventions import Array
from refcloud.metaballs import Metaballs
from refcloud.noise import uniform
from refcloud.optics import Medium, Sun
from refcloud.render import render

Kind = Literal[
    "splats, man", "splats, cumulus", "march", "march, every order", "march, large"
]
# What the command line calls them.
Word = Literal[
    "splats-man", "splats-cumulus", "march", "march-every-order", "march-large"
]
KINDS: dict[Word, Kind] = dict(zip(get_args(Word), get_args(Kind), strict=True))
COUNTS: dict[Kind, int] = {
    "splats, man": 6000,
    "splats, cumulus": 3000,
    "march": 1000,
    "march, every order": 30,
    "march, large": 50,
}
QUICK: dict[Kind, int] = {
    "splats, man": 20,
    "splats, cumulus": 10,
    "march": 3,
    "march, every order": 1,
    "march, large": 1,
}
WIDTHS = (24, 48, 96)  # pixels
LARGE = 256  # pixels of a large one: many rays to each that is checked
LEAST, MOST = -4.0, -1.0  # powers of ten of the tolerances
ROUNDED = 1e-12  # two orders of a sum of a few dozen numbers


@dataclass(frozen=True)
class Tally:
    """What became of scenes of a kind.

    Attributes
    ----------
    scenes, certified
        How many were drawn, and how many of them by a certified saving.
    failed
        How many were off by more than the tolerance.
    worst
        The largest error, in tolerances.
    """

    scenes: int
    certified: int
    failed: int
    worst: float


def tally(kind: Kind, count: int, first: int = 0) -> Tally:
    """Draw scenes of a kind, exactly and to a tolerance each.

    Parameters
    ----------
    kind
        Which.
    count, first
        How many, from which number on.

    Returns
    -------
    What became of them.
    """
    certified = failed = 0
    worst = 0.0
    for number in range(first, first + count):
        off, tolerance, by_sample = drawn(kind, number)
        certified += by_sample
        failed += off > tolerance + ROUNDED
        worst = max(worst, off / tolerance)
    return Tally(count, certified, failed, worst)


def drawn(kind: Kind, number: int) -> tuple[float, float, bool]:
    """Draw one scene: its error, the tolerance, and whether a sample vouched for it."""
    draws = uniform(np.arange(32), number, seed=9 + get_args(Kind).index(kind))
    tolerance = 10.0 ** (LEAST + (MOST - LEAST) * draws[0])
    large = kind == "march, large"
    width = LARGE if large else WIDTHS[int(3.0 * draws[1])]
    if kind == "march, every order":
        width = 12
    eye, fov_y = 5.0 * way_of(draws[2:4]), 0.45 if large else 0.5 + draws[4]
    camera = Camera(eye, np.zeros(3), fov_y=fov_y, width=width, height=width)
    sun = Sun(way_of(draws[5:7]))
    power = 10.0 ** (2.0 * draws[7] - 1.0)  # from 0.1 to 10
    g = 1.5 * draws[8] - 0.7
    medium = Medium(power, 1.0 - 0.2 * draws[9], g, "hg")
    how: dict[str, Any] = {"camera": camera, "suns": sun, "medium": medium}
    if kind.startswith("splats"):
        cloud = scattered(number, 1 + int(80.0 * draws[10] ** 2))
        how["look"] = kind.split()[-1]
    else:
        voxels = 8 + 20.0 * draws[10] if large else 6 + 11.0 * draws[10]
        cloud = lumpy(int(voxels), number)
        if "order" in kind:
            how["scattering"] = "multiple"
    exact = render(cloud, **how).linear
    found = render(cloud, tolerance=tolerance, **how)
    by_sample = any(r.how == "certified" and r.unit == WHITE for r in found.skipped)
    off = float(np.abs(found.linear - exact).max())
    return off, float(tolerance), by_sample


def way_of(pair: Array) -> Array:
    """Give a direction, even over the sphere, from two numbers in [0, 1)."""
    z, turn = 2.0 * pair[0] - 1.0, 2.0 * math.pi * pair[1]
    across = math.sqrt(max(1.0 - z * z, 0.0))
    return np.array([across * math.cos(turn), across * math.sin(turn), z])


def scattered(number: int, count: int) -> Metaballs:
    """Scatter balls of many sizes and densities over a box."""
    k = np.arange(count)[:, None]
    places = uniform(k, np.arange(5), number, seed=4)
    radii = 0.05 + 1.2 * places[:, 3] ** 2
    return Metaballs(
        2.4 * (places[:, :3] - 0.5), radii, 10.0 ** (2.0 * places[:, 4] - 1.0)
    )


def tallies(quick: bool, only: Word | None = None) -> dict[Kind, Tally]:
    """Draw scenes of every kind, or of one, few of them where quick."""
    counts = QUICK if quick else COUNTS
    kinds = counts if only is None else (KINDS[only],)
    return {kind: tally(kind, counts[kind]) for kind in kinds}


def table_of(found: dict[Kind, Tally]) -> str:
    """Write what became of scenes of every kind.

    Parameters
    ----------
    found
        Of `tallies`.

    Returns
    -------
    Lines of text.
    """
    lines = [["scenes", "drawn", "certified", "failed", "worst error, of asked"]]
    for kind, one in found.items():
        numbers = (one.scenes, one.certified, one.failed)
        lines.append([kind, *map(str, numbers), f"{one.worst:.4g}"])
    return "\n".join(columns(lines, 1))
