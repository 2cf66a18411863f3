"""Document C's cloud sheet beside its plain twins."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import refcloud.noise as array
from refcloud.plain import sheet as plain
from twins import Draw, twin
from twins.noise import EXACT, coordinates, seeds

SAME = "the same sums in the same order; a last bit, if a compiler fuses them elsewhere"
FILTER = "a last bit of 255, 2.8e-14, is left of 255 less 255; times 8"

greys = st.floats(0.0, 256.0)
small = st.integers(1, 5)
covers = st.floats(0.0, 300.0)
numbers = st.sampled_from(["elias", "hashed"])


def drawn_map(draw: Draw) -> np.ndarray:
    """Draw a small map of grey levels."""
    return draw(arrays(np.float64, (draw(small), draw(small)), elements=greys))


@twin(array.sheet_map, plain.sheet_map, tolerance=1e-15, why=SAME)
def sheet_map(draw):
    size, how = draw(small), {"seed": draw(seeds), "numbers": draw(numbers)}
    return array.sheet_map(size, **how), plain.sheet_map(size, **how)


@twin(array.wrap_halo, plain.wrap_halo, tolerance=0.0, why=EXACT)
def wrap_halo(draw):
    values = drawn_map(draw)
    return array.wrap_halo(values), plain.wrap_halo(values.tolist())


@twin(array.wrapped_bilinear, plain.wrapped_bilinear, tolerance=0.0, why=EXACT)
def wrapped_bilinear(draw):
    values = drawn_map(draw)
    x, y = (draw(arrays(np.float64, 3, elements=coordinates)) for _ in range(2))
    rows = values.tolist()
    expected = [
        plain.wrapped_bilinear(rows, *place)
        for place in zip(x.tolist(), y.tolist(), strict=True)
    ]
    return array.wrapped_bilinear(values, x, y), expected


@twin(array.overlap_octaves, plain.overlap_octaves, tolerance=1e-15, why=SAME)
def overlap_octaves(draw):
    values, size, octaves = drawn_map(draw), draw(small), draw(small)
    expected = plain.overlap_octaves(values.tolist(), size, octaves=octaves)
    return array.overlap_octaves(values, size, octaves=octaves), expected


@twin(array.exponential_filter, plain.exponential_filter, tolerance=2.3e-13, why=FILTER)
def exponential_filter(draw):
    values = draw(arrays(np.float64, 4, elements=st.floats(-100.0, 500.0)))
    how = {"cover": draw(covers), "sharpness": draw(st.floats(0.0, 1.0))}
    expected = [plain.exponential_filter(value, **how) for value in values.tolist()]
    return array.exponential_filter(values, **how), expected


@twin(
    array.cloud_sheet,
    plain.cloud_sheet,
    tolerance=1e-11,
    why="a last bit of the sum, 5.7e-14, grows 177 times where sharpness is 0.5",
)
def cloud_sheet(draw):
    size = draw(small)
    how = {
        "seed": draw(seeds),
        "map_size": draw(small),
        "octaves": draw(small),
        "cover": draw(covers),
        # Toward 0 the edge is hard: a last bit before it decides on cloud or none.
        "sharpness": draw(st.floats(0.5, 1.0)),
        "numbers": draw(numbers),
    }
    return array.cloud_sheet(size, **how), plain.cloud_sheet(size, **how)
