"""Gradient noise beside its plain twins, and how the room's tests draw it."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import refcloud.noise as array
from refcloud.plain import gradient as plain
from twins import Draw, twin
from twins.noise import EXACT, coordinates, drawn_wholes, seeds

ROUNDED = "worst seen 2.4e-15 in 600 examples, times 12: other order of the corners"
STEEP = "worst seen 4.4e-15 in 600 examples, times 11: slopes of the fade reach 1.9"

hashes = st.sampled_from(["mixed", "table"])
fades = st.sampled_from(["quintic", "hermite"])
periods = st.none() | st.integers(1, 9) | st.integers(2**31 - 2, 2**31)
SETS = {
    2: ["directions8", "diagonals4"],
    3: ["edges12", "corners8"],
    4: ["edges32"],
}


def ways(dimensions: int, **more) -> st.SearchStrategy[dict]:
    """Draw how gradient noise is made."""
    return st.fixed_dictionaries(
        {
            "seed": seeds,
            "fade": fades,
            "gradients": st.none() | st.sampled_from(SETS[dimensions]),
            "period": periods,
            "hash": hashes,
            **more,
        }
    )


def places(dimensions: int, most: int = 4) -> st.SearchStrategy[list]:
    """Draw a few places of a dimension."""
    place = st.tuples(*[coordinates] * dimensions)
    return st.lists(place, min_size=1, max_size=most)


def drawn(draw: Draw) -> tuple[list, dict]:
    dimensions = draw(st.sampled_from([2, 3, 4]))
    return draw(places(dimensions)), draw(ways(dimensions))


@twin(array.lattice_bits, plain.lattice_bits, tolerance=0.0, why=EXACT)
def lattice_bits(draw):
    words, rows = drawn_wholes(draw, draw(st.integers(1, 4)))
    how = {"seed": draw(seeds), "hash": draw(hashes)}
    actual = array.lattice_bits(*words, **how)
    return actual, [plain.lattice_bits(*row, **how) for row in rows]


@twin(array.permutation_table, plain.permutation_table, tolerance=0.0, why=EXACT)
def permutation_table(draw):
    seed = draw(seeds)
    return array.permutation_table(seed), plain.permutation_table(seed)


@twin(array.gradient_set, plain.gradient_set, tolerance=0.0, why=EXACT)
def gradient_set(draw):
    dimensions = draw(st.integers(2, 4))
    name = draw(st.none() | st.sampled_from(SETS[dimensions]))
    actual = array.gradient_set(name, dimensions=dimensions)
    return actual, plain.gradient_set(name, dimensions=dimensions)


@twin(array.gradient, plain.gradient, tolerance=3e-14, why=ROUNDED)
def gradient(draw):
    at, how = drawn(draw)
    expected = [plain.gradient(place, **how) for place in at]
    return array.gradient(np.array(at), **how), expected


@twin(array.gradient_derivative, plain.gradient_derivative, tolerance=5e-14, why=STEEP)
def gradient_derivative(draw):
    at, how = drawn(draw)
    noise, slope = array.gradient_derivative(np.array(at), **how)
    expected = [plain.gradient_derivative(place, **how) for place in at]
    return np.column_stack((noise, slope)), [[n, *s] for n, s in expected]


axes = st.lists(coordinates, min_size=1, max_size=3)


@twin(array.gradient_grid, plain.gradient_grid, tolerance=3e-14, why=ROUNDED)
def gradient_grid(draw):
    dimensions = draw(st.sampled_from([2, 3]))
    at, how = [draw(axes) for _ in range(dimensions)], draw(ways(dimensions))
    return array.gradient_grid(*at, **how), plain.gradient_grid(*at, **how)
