"""Carving by Worley noise beside its plain twins."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import refcloud.cloudmap as array
from refcloud.cloudmap.billows import HIGHEST, LOWEST, MEAN, OCTAVES, PERSISTENCE
from refcloud.plain import billows as plain
from twins import Draw, twin
from twins.noise import seeds

WITHOUT = {"refcloud.cloudmap.billows.billows": "composed of functions that have rows"}

share = st.floats(0.0, 1.0)
places = st.lists(st.floats(-50.0, 50.0), min_size=1, max_size=1)
lengths = st.floats(0.1, 20.0)


@twin(
    array.lumps_grid,
    plain.lumps_grid,
    tolerance=4e-14,
    why="worst seen 4.7e-15, times 8: places of up to 200 cells know 13 digits",
)
def lumps_grid(draw: Draw):
    assert (plain.OCTAVES, plain.PERSISTENCE) == (OCTAVES, PERSISTENCE)
    assert (plain.LOWEST, plain.HIGHEST, plain.MEAN) == (LOWEST, HIGHEST, MEAN)
    axes, seed = [draw(places) for _ in range(3)], draw(seeds)
    finest = draw(st.sampled_from([0.0, 0.3, 0.5, 2.0]))
    actual, _ = array.lumps_grid(*axes, seed=seed, finest=finest)
    return actual, plain.lumps_grid(*axes, seed, finest)


@twin(
    array.carve,
    plain.carve,
    tolerance=1e-12,
    why="worst seen 3e-14; 1 - erosion and the gain magnify a last bit a hundredfold",
)
def carve(draw: Draw):
    count = draw(st.integers(1, 4))
    rows = [
        (
            draw(st.floats(-20.0, 20.0)),
            draw(share),
            draw(share),
            draw(st.floats(-2, 20)),
        )
        for _ in range(count)
    ]
    how = {
        "rise": draw(lengths),
        "cover": draw(share),
        "erosion": draw(st.floats(0.0, 0.9)),
        "base": draw(lengths),
        "foot": draw(lengths),
        "gain": draw(st.floats(0.5, 10.0)),
    }
    depth, lumps, detail, y = (np.array(column) for column in zip(*rows, strict=True))
    fields = [values[None, :, None] for values in (depth, lumps, detail)]
    actual = array.carve(*fields, y, **how)[0, :, 0]
    return actual, [plain.carve(*row, **how) for row in rows]
