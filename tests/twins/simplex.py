"""Simplex noise beside its plain twins, and how the room's tests draw it."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import refcloud.noise as array
from refcloud.plain import simplex as plain
from twins import twin
from twins.gradient import hashes
from twins.noise import seeds

ROUNDED = "worst seen 7.8e-16 in 600 examples, times 13"
STEEP = "worst seen 1.8e-15 in 600 examples, times 11"

radii = st.sampled_from(["continuous", "usual"])
ways = st.fixed_dictionaries({"seed": seeds, "radius": radii, "hash": hashes})
# The sum of four coordinates rounds by their size, in an order that differs between
# the two forms, and with the continuous radius that moves a place by no more. With the
# usual radius a place on a face may fall to either side of its jump (E30): drawn places
# are multiples of 1/1024 off the faces x = y by a different odd offset on each axis.
coordinate = st.integers(-(2**20), 2**20).map(lambda n: n / 1024.0)
OFF = np.array([0.00021, 0.00039, 0.00064, 0.00017])


@st.composite
def places(draw, dimensions: int, most: int = 4) -> np.ndarray:
    """Draw a few places of a dimension, away from the faces of simplices."""
    rows = st.lists(st.tuples(*[coordinate] * dimensions), min_size=1, max_size=most)
    return np.array(draw(rows)) + OFF[:dimensions]


@twin(array.simplex, plain.simplex, tolerance=1e-14, why=ROUNDED)
def simplex(draw):
    at, how = draw(places(draw(st.integers(2, 4)))), draw(ways)
    return array.simplex(at, **how), [plain.simplex(place, **how) for place in at]


@twin(array.simplex_derivative, plain.simplex_derivative, tolerance=2e-14, why=STEEP)
def simplex_derivative(draw):
    at, how = draw(places(draw(st.integers(2, 4)))), draw(ways)
    noise, slope = array.simplex_derivative(at, **how)
    expected = [plain.simplex_derivative(place, **how) for place in at]
    return np.column_stack((noise, slope)), [[n, *s] for n, s in expected]


@twin(array.simplex_grid, plain.simplex_grid, tolerance=1e-14, why=ROUNDED)
def simplex_grid(draw):
    dimensions, how = draw(st.integers(2, 4)), draw(ways)
    lines = draw(places(dimensions, 2)).T
    return array.simplex_grid(*lines, **how), plain.simplex_grid(*lines, **how)
