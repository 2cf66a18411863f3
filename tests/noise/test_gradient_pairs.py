"""Gradient noise from a box of pairs has the bits of noise that hashes each corner."""

from __future__ import annotations

import importlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.gradient import SETS, ways

from refcloud.noise import gradient, uniform
from refcloud.noise.directions import USUAL

SAME = 1e-12  # the contract

pairs = importlib.import_module("refcloud.noise.gradient_pairs")
plain = importlib.import_module("refcloud.noise.gradient")


def close_places(n: int, seed: int, corner: float) -> np.ndarray:
    """Give places that share the cells of a small box: 300 of them in 3 along axes."""
    return corner + 3.0 * uniform(np.arange(300)[:, None], np.arange(n), seed=seed)


@settings(max_examples=40)
@given(
    st.sampled_from([2, 3]),
    st.integers(0, 99),
    st.sampled_from([0.0, -1.5, 2.0**31 - 1.75, 3.0 - 2.0**32, 2.0**32 - 3.0]),
    st.sampled_from(["float64", "float32"]),
    st.data(),
)
def test_a_box_does_not_show(n: int, seed: int, corner: float, dtype, data) -> None:
    at, how = close_places(n, seed, corner), data.draw(ways(n))
    if how["period"] is None:
        lattice = pairs.Lattice(12, seed, how["hash"], None)
        assert pairs._pair_box(at, lattice) is not None
    boxed = gradient(at, dtype=dtype, **how)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pairs, "WORTH", 0)
        np.testing.assert_array_equal(gradient(at, dtype=dtype, **how), boxed)


@pytest.mark.parametrize("n", [2, 3])
def test_the_readable_form_is_the_noise_of_a_box(n: int) -> None:
    at = close_places(n, 1, -1.5)
    assert SETS[n][0] == USUAL[n]
    literal = plain._literal(at, 5, "quintic", USUAL[n])
    assert np.abs(gradient(at, seed=5) - literal).max() < SAME


def test_far_and_not_finite_places_have_no_box() -> None:
    lattice = pairs.Lattice(12, 0, "mixed", None)
    for bad in (1e9, np.nan, np.inf):
        at = close_places(3, 0, 0.0)
        at[0] = bad
        assert pairs._pair_box(at, lattice) is None
