"""Worley noise beside its plain twins, and the strategies of its tests."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import refcloud.noise as array
from refcloud.plain import worley as plain
from twins import Draw, twin
from twins.noise import EXACT, coordinates, seeds, wholes

ROUNDED = "worst seen 2.2e-16 in 1,500 examples, times 8: squares are summed otherwise"

# Periods that wrap within the neighbours (1 to 4 cells), beyond them, and none.
periods = st.none() | st.integers(1, 9) | st.integers(2**32 - 2, 2**32)
features = st.sampled_from(["F1", "F2"])
searches = st.sampled_from(["exact", "neighbours"])
scales = st.sampled_from(["none", "bound", "inverted", "clip"])
dimensions = st.sampled_from([2, 3])
ways = st.fixed_dictionaries(
    {"seed": seeds, "period": periods, "feature": features, "search": searches}
)


def drawn_places(draw: Draw, n: int, most: int = 3) -> list[tuple[float, ...]]:
    """Draw places of n coordinates."""
    return draw(st.lists(st.tuples(*[coordinates] * n), min_size=1, max_size=most))


@twin(array.worley, plain.worley, tolerance=1.8e-15, why=ROUNDED)
def worley(draw):
    places = drawn_places(draw, draw(dimensions))
    how = draw(ways) | {"normalize": draw(scales)}
    expected = [plain.worley(place, **how) for place in places]
    return array.worley(np.array(places), **how), expected


@twin(array.worley_grid, plain.worley_grid, tolerance=1.8e-15, why=ROUNDED)
def worley_grid(draw):
    line = st.lists(coordinates, min_size=1, max_size=2)
    axes = [draw(line) for _ in range(draw(dimensions))]
    how = draw(ways) | {"normalize": draw(scales)}
    return array.worley_grid(*axes, **how), plain.worley_grid(*axes, **how)


@twin(array.worley_points, plain.worley_points, tolerance=0.0, why=EXACT)
def worley_points(draw):
    cell = draw(st.lists(wholes, min_size=2, max_size=3))
    how = {"seed": draw(seeds), "period": draw(periods)}
    return array.worley_points(*cell, **how), plain.worley_points(*cell, **how)


@twin(array.worley_bound, plain.worley_bound, tolerance=5e-16, why="one root")
def worley_bound(draw):
    n, feature = draw(dimensions), draw(features)
    return array.worley_bound(n, feature), plain.worley_bound(n, feature)


@twin(
    array.worley_drawn,
    plain.worley_drawn,
    tolerance=1.2e-13,
    why="values up to 255, whose last bit is 2.8e-14; times 4",
)
def worley_drawn(draw):
    width, height = draw(st.integers(1, 5)), draw(st.integers(1, 5))
    how = {
        "count": draw(st.integers(1, 5)),
        "seed": draw(seeds),
        "inverted": draw(st.booleans()),
    }
    actual = array.worley_drawn(width, height, **how)
    return actual, plain.worley_drawn(width, height, **how)
