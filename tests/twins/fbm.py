"""Fractal sums of each kind beside their plain twins, and how tests draw them."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import refcloud.noise as array
from refcloud.plain import fbm as plain
from twins import Draw, twin
from twins.noise import coordinates, seeds, unit
from twins.simplex import coordinate

ROUNDED = "worst seen 3.7e-15 in 300 examples, times 8: places of the octaves round"

# Coordinates (time not among them) that each kind takes without and with time.
COUNTS = {
    "value": ((3,), (2,)),
    "gradient": ((2, 3), (2, 3)),
    "simplex": ((2, 3), (2, 3)),
}


def drawn(draw: Draw) -> tuple[int, st.SearchStrategy, dict]:
    """Draw how many coordinates a place has, how each is drawn, and a way to sum."""
    kind = draw(st.sampled_from(sorted(COUNTS)))
    timed = draw(st.booleans())
    how = {
        "kind": kind,
        "seed": draw(seeds),
        "octaves": draw(st.integers(1, 3)),
        "persistence": draw(unit),
        "normalize": draw(st.sampled_from(["bound", "clip", "none"])),
    }
    if timed:
        how["time"] = draw(coordinate)
    if kind != "simplex":
        how["period"] = draw(st.none() | st.integers(1, 9))
    # Far out a simplex place rounds by more than the tolerance.
    each = coordinate if kind == "simplex" else coordinates
    return draw(st.sampled_from(COUNTS[kind][timed])), each, how


def drawn_sum(draw: Draw, name: str) -> tuple:
    dimensions, each, how = drawn(draw)
    rows = draw(st.lists(st.tuples(*[each] * dimensions), min_size=1, max_size=2))
    expected = [getattr(plain, name)(row, **how) for row in rows]
    return getattr(array, name)(np.array(rows), **how), expected


def drawn_grid(draw: Draw, name: str) -> tuple:
    dimensions, each, how = drawn(draw)
    lines = [draw(st.lists(each, min_size=1, max_size=2)) for _ in range(dimensions)]
    how["finest"] = draw(st.none() | st.floats(0.05, 1.0))
    actual, _ = getattr(array, name)(*lines, **how)
    return actual, getattr(plain, name)(*lines, **how)


@twin(array.fbm, plain.fbm, tolerance=3e-14, why=ROUNDED)
def fbm(draw):
    return drawn_sum(draw, "fbm")


@twin(array.turbulence, plain.turbulence, tolerance=3e-14, why=ROUNDED)
def turbulence(draw):
    return drawn_sum(draw, "turbulence")


@twin(array.fbm_grid, plain.fbm_grid, tolerance=3e-14, why=ROUNDED)
def fbm_grid(draw):
    return drawn_grid(draw, "fbm_grid")


@twin(array.turbulence_grid, plain.turbulence_grid, tolerance=3e-14, why=ROUNDED)
def turbulence_grid(draw):
    return drawn_grid(draw, "turbulence_grid")
