"""Interpolants: the error of each against the spacing of its samples (E13).

The curve is sin(x); its slopes are nowhere larger than 1, so that the errors are those
of the form alone. Halving the spacing divides an error by 2 to the order of the form:
orders are told by the figure's steps from task to task. Smooth is not accurate.
"""

from __future__ import annotations

import functools
import math
from typing import get_args

import numpy as np

from refcloud.bench.subject import NS, Subject
from refcloud.bench.timing import Contender
from refcloud.conventions import Array
from refcloud.noise import taps
from refcloud.noise.weights import Interpolant

SPACINGS = (8, 16, 32, 64, 128)  # samples of one turn


def interpolated(interpolant: Interpolant, per_turn: int, count: int) -> Array:
    """Interpolate sin at places over one turn, from samples of it.

    Parameters
    ----------
    interpolant
        Which form.
    per_turn
        Samples of one turn, at least 4.
    count
        How many places.

    Returns
    -------
    Shape (count,).
    """
    known = np.sin(np.arange(-2, per_turn + 3) * (2.0 * math.pi / per_turn))
    cells = places(count) * per_turn
    first = np.floor(cells).astype(np.int64)
    weights, offsets = taps(interpolant, cells - first)
    found = np.zeros(count)
    for weight, offset in zip(weights, offsets, strict=True):
        found += weight * known[first + offset + 2]
    return found


def places(count: int) -> Array:
    """Spread places over one turn, in [0, 1), no two at the same place of a cell."""
    return (np.arange(count) + 0.5) / count


def closed_form(count: int) -> Array:
    """Give sin at the places."""
    return np.sin(2.0 * math.pi * places(count))


def interpolants(count: int) -> list[Contender]:
    """List every form at every spacing."""
    exact = functools.cache(functools.partial(closed_form, count))
    return [
        Contender(
            f"{per_turn:3d} samples a turn",
            f"refcloud {name}",
            count,
            functools.partial(interpolated, name, per_turn, count),
            exact,
        )
        for per_turn in SPACINGS
        for name in get_args(Interpolant)
    ]


INTERPOLANTS = Subject(
    name="interpolants",
    title="interpolants of noise: error against spacing, on sin",
    about="CPU time per value, medians; error: largest distance from sin",
    lists=((interpolants, 500_000, 5_000),),
    unit=NS,
    digits=2,
    reference="sin, to the last digit or two of float64",
    one_task=True,
)
