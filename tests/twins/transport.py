"""The transport room beside its plain twins, and the strategies of the room's tests."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import refcloud.transport as array
from refcloud.plain import transport as plain
from twins import Draw, twin
from twins.cloudmap import grids, plain_grid

WITHOUT: dict[str, str] = {}

part = st.floats(-1.0, 1.0) | st.sampled_from([-1.0, 0.0, 1.0, 0.5])
directions = st.tuples(part, part, part).filter(lambda d: max(map(abs, d)) > 0.1)


@twin(
    array.column_density,
    plain.column_density,
    tolerance=5e-14,
    why="worst seen 5e-16; in cells of 0.08 at 5 a place is known to 1e-14 of a cell",
)
def column_density(draw: Draw):
    grid, direction = draw(grids()), draw(directions)
    shares = draw(st.lists(st.tuples(*[st.floats(-0.2, 1.2)] * 3), max_size=4))
    points = grid.lower + np.reshape(shares, (-1, 3)) * (grid.upper - grid.lower)
    expected = [
        plain.column_density(*plain_grid(grid), p, direction) for p in points.tolist()
    ]
    return array.column_density(grid, points, direction), expected


@twin(
    array.sun_depths,
    plain.sun_depths,
    tolerance=5e-14,
    why="worst seen 9e-16 in 600 examples; slopes of cells of 0.08 round to 1e-14",
)
def sun_depths(draw: Draw):
    grid, direction = draw(grids()), draw(directions)
    scale = draw(st.sampled_from([1, 2]))
    found = array.sun_depths(grid, direction, scale=scale).density
    places = st.tuples(*[st.integers(0, n - 1) for n in found.shape])
    samples = draw(st.lists(places, min_size=1, max_size=4))
    expected = [
        plain.sun_depths(*plain_grid(grid), direction, sample[::-1], scale=scale)
        for sample in samples
    ]
    return [found[sample] for sample in samples], expected
