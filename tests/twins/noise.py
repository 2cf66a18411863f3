"""The noise room beside its plain twins, and the strategies of the room's tests."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import refcloud.noise as array
from refcloud.noise.weights import PEAKS
from refcloud.plain import noise as plain
from twins import Draw, twin

WITHOUT: dict[str, str] = {}

INTERPOLANTS = sorted(PEAKS)
TWO_POINT = [name for name in INTERPOLANTS if PEAKS[name] == 1.0]

EXACT = "whole numbers to the last step: no rounding may differ"
ROUNDED = "worst seen 6.3e-16 in 500 examples, times 8: other libraries round cos apart"

POLYNOMIAL = "worst seen 5.1e-15 in 500 examples, times 10: quintic terms reach 15"

seeds = st.integers(-(2**63), 2**63 - 1)
seeds_or_none = st.none() | seeds
# Whole numbers near zero, around the wrap at 2^32, and anywhere in 64 bits.
wholes = (
    st.integers(-70, 70)
    | st.integers(2**32 - 3, 2**32 + 3)
    | st.integers(-(2**63), 2**63 - 1)
)
unit = st.floats(0.0, 1.0)
lattice_values = st.floats(-1.0, 1.0)
# Places as clouds have them, at and beside cell faces, and any finite float at all.
coordinates = (
    st.floats(-20.0, 20.0)
    | st.integers(-5, 5).map(float)
    | st.sampled_from([-5e-324, -1e-17, 1e-17, 2.0**32 - 0.5, 1e300, -1e9 - 0.25])
    | st.floats(allow_nan=False, allow_infinity=False)
)
points = st.tuples(coordinates, coordinates, coordinates)


def drawn_wholes(draw: Draw, words: int) -> tuple[list, list[tuple]]:
    """Draw arrays of whole numbers, and the same as rows."""
    rows = draw(st.lists(st.tuples(*[wholes] * words), min_size=1, max_size=4))
    return [np.array(word, dtype=np.int64) for word in zip(*rows, strict=True)], rows


@twin(array.man2003, plain.man2003, tolerance=0.0, why=EXACT)
def man2003(draw):
    words, rows = drawn_wholes(draw, 3)
    how = {
        "shift": draw(st.sampled_from(["plain", "rotate"])),
        "divisor": draw(st.sampled_from([2**30, 2**30 - 1])),
    }
    return array.man2003(*words, **how), [plain.man2003(*row, **how) for row in rows]


@twin(array.elias2d, plain.elias2d, tolerance=0.0, why=EXACT)
def elias2d(draw):
    words, rows = drawn_wholes(draw, 2)
    seed = draw(seeds)
    actual = array.elias2d(*words, seed=seed)
    return actual, [plain.elias2d(*row, seed=seed) for row in rows]


@twin(array.lattice_random, plain.lattice_random, tolerance=0.0, why=EXACT)
def lattice_random(draw):
    words, rows = drawn_wholes(draw, 3)
    seed = draw(seeds_or_none)
    actual = array.lattice_random(*words, seed=seed)
    return actual, [plain.lattice_random(*row, seed=seed) for row in rows]


@twin(array.uniform, plain.uniform, tolerance=0.0, why=EXACT)
def uniform(draw):
    words, rows = drawn_wholes(draw, draw(st.integers(1, 4)))
    seed = draw(seeds)
    actual = array.uniform(*words, seed=seed)
    return actual, [plain.uniform(*row, seed=seed) for row in rows]


@twin(array.smoothed, plain.smoothed, tolerance=5e-15, why=ROUNDED)
def smoothed(draw):
    words, rows = drawn_wholes(draw, 3)
    seed = draw(seeds_or_none)
    actual = array.smoothed(*words, seed=seed)
    return actual, [plain.smoothed(*row, seed=seed) for row in rows]


def drawn_interpolation(draw: Draw, name: str, count: int) -> tuple:
    """Interpolate a few drawn rows of values by both functions of a name."""
    row = st.tuples(*[lattice_values] * count, unit)
    rows = draw(st.lists(row, min_size=1, max_size=4))
    columns = [np.array(column) for column in zip(*rows, strict=True)]
    expected = [getattr(plain, name)(*row) for row in rows]
    return getattr(array, name)(*columns), expected


@twin(array.linear, plain.linear, tolerance=5e-15, why=ROUNDED)
def linear(draw):
    return drawn_interpolation(draw, "linear", 2)


@twin(array.cosine, plain.cosine, tolerance=5e-15, why=ROUNDED)
def cosine(draw):
    return drawn_interpolation(draw, "cosine", 2)


@twin(array.hermite, plain.hermite, tolerance=5e-15, why=ROUNDED)
def hermite(draw):
    return drawn_interpolation(draw, "hermite", 2)


@twin(array.quintic, plain.quintic, tolerance=5e-14, why=POLYNOMIAL)
def quintic(draw):
    return drawn_interpolation(draw, "quintic", 2)


@twin(array.cubic, plain.cubic, tolerance=5e-15, why=ROUNDED)
def cubic(draw):
    return drawn_interpolation(draw, "cubic", 4)


@twin(array.catmull_rom, plain.catmull_rom, tolerance=5e-15, why=ROUNDED)
def catmull_rom(draw):
    return drawn_interpolation(draw, "catmull_rom", 4)


@twin(array.taps, plain.taps, tolerance=5e-14, why=POLYNOMIAL)
def taps(draw):
    name, t = draw(st.sampled_from(INTERPOLANTS)), draw(unit)
    weights, offsets = array.taps(name, t)
    expected_weights, expected_offsets = plain.taps(name, t)
    return [*weights, *offsets], [*expected_weights, *expected_offsets]


def drawn_value(draw: Draw) -> dict:
    """Draw how value noise is made."""
    return {
        "seed": draw(seeds_or_none),
        "interpolant": draw(st.sampled_from(INTERPOLANTS)),
        "smooth": draw(st.booleans()),
        "period": draw(st.none() | st.integers(1, 9) | st.just(2**31)),
    }


@twin(array.value, plain.value, tolerance=5e-14, why=POLYNOMIAL)
def value(draw):
    places, how = draw(st.lists(points, min_size=1, max_size=3)), drawn_value(draw)
    expected = [plain.value(place, **how) for place in places]
    return array.value(np.array(places), **how), expected


axes = st.lists(coordinates, min_size=1, max_size=2)


@twin(array.value_grid, plain.value_grid, tolerance=5e-14, why=POLYNOMIAL)
def value_grid(draw):
    x, y, z, how = draw(axes), draw(axes), draw(axes), drawn_value(draw)
    return array.value_grid(x, y, z, **how), plain.value_grid(x, y, z, **how)


@twin(array.octave_bound, plain.octave_bound, tolerance=5e-15, why=ROUNDED)
def octave_bound(draw):
    octaves, persistence = draw(st.integers(1, 32)), draw(unit)
    actual = array.octave_bound(octaves, persistence)
    return actual, plain.octave_bound(octaves, persistence)


@twin(array.octave_frame, plain.octave_frame, tolerance=0.0, why=EXACT)
def octave_frame(draw):
    octave, seed = draw(st.integers(0, 31)), draw(seeds_or_none)
    own, shift = array.octave_frame(octave, seed=seed)
    plain_own, plain_shift = plain.octave_frame(octave, seed=seed)
    assert own == plain_own, "63 bits do not fit the float64 of the table"
    return shift, plain_shift


def drawn_octaves(draw: Draw) -> dict:
    """Draw how octaves are summed."""
    return {
        "seed": draw(seeds_or_none),
        "octaves": draw(st.integers(1, 3)),
        "persistence": draw(unit),
        "interpolant": draw(st.sampled_from(INTERPOLANTS)),
        "normalize": draw(st.sampled_from(["clip", "bound", "none"])),
        "absolute": draw(st.booleans()),
        "period": draw(st.none() | st.integers(1, 9)),
    }


@twin(array.octave_sum, plain.octave_sum, tolerance=5e-14, why=POLYNOMIAL)
def octave_sum(draw):
    places, how = draw(st.lists(points, min_size=1, max_size=2)), drawn_octaves(draw)
    expected = [plain.octave_sum(place, **how) for place in places]
    return array.octave_sum(np.array(places), **how), expected


@twin(array.octave_sum_grid, plain.octave_sum_grid, tolerance=5e-14, why=POLYNOMIAL)
def octave_sum_grid(draw):
    x, y, how = draw(axes), draw(axes), drawn_octaves(draw)
    how["finest"] = draw(st.none() | st.floats(0.05, 1.0))
    actual, _ = array.octave_sum_grid(x, y, [0.5], **how)
    return actual, plain.octave_sum_grid(x, y, [0.5], **how)
