"""Simplex noise from kernels of blocks is the noise point by point."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.noise import seeds

from refcloud.noise import simplex, simplex_grid
from refcloud.noise.simplex_phases import LEAST, _regular

# Worst seen 9e-15 within 64 units of the origin, where coordinates round by 7e-15 and
# the noise slopes up to 8 per unit.
SAME = 1e-12
SINGLE = 5e-6  # float32: worst seen 5e-7, times 10

hashes = st.sampled_from(["mixed", "table"])
# Samples per unit and where an axis starts.
axes = st.tuples(st.integers(1, 19), st.integers(-4096, 4096))


def line(per_unit: int, start: int, size: int) -> np.ndarray:
    """Give a regular axis that starts at a multiple of 1/64, about the origin."""
    return start / 64.0 + np.arange(size) / per_unit


def at_points(lines, **how) -> np.ndarray:
    """Give the noise of a grid's places as scattered points."""
    mesh = np.stack(np.meshgrid(*lines[::-1], indexing="ij")[::-1], axis=-1)
    return simplex(mesh, **how)


@settings(max_examples=40)
@given(st.tuples(axes, axes, axes), seeds, hashes)
def test_blocks_equal_points(ways, seed: int, hash) -> None:
    # Sizes are no multiples of the samples per unit: last blocks reach past the end.
    sizes = (29, 23, 17)
    lines = [line(*way, size) for way, size in zip(ways, sizes, strict=True)]
    how = {"seed": seed, "hash": hash}
    exact = at_points(lines, **how)
    np.testing.assert_allclose(simplex_grid(*lines, **how), exact, rtol=0, atol=SAME)
    single = simplex_grid(*lines, **how, dtype="float32")
    assert single.dtype == np.float32
    assert single.shape == sizes[::-1]
    np.testing.assert_allclose(single, exact, rtol=0, atol=SINGLE)


def test_a_piece_of_a_unit_is_one_block_of_any_samples() -> None:
    inside = np.sqrt(np.arange(20.0)) / 5.0 - 7.3
    lines = [inside, inside[::-1], line(8, 5, 20)]
    assert _regular(lines) is not None
    exact = at_points(lines)
    np.testing.assert_allclose(simplex_grid(*lines), exact, rtol=0, atol=SAME)


def test_far_away_blocks_are_exact_where_coordinates_are() -> None:
    # Float64 has steps of 5e-10 this far out, which
    # the way by points rounds by, and the noise slopes up to 8 per unit.
    lines = [line(4, 3 * 2**26, 24), line(4, -3 * 2**26, 24), line(4, 7, 24)]
    exact = at_points(lines)
    np.testing.assert_allclose(simplex_grid(*lines), exact, rtol=0, atol=1e-8)


@pytest.mark.parametrize("step", [0.31, 1 / 8 + 1e-9, 3.0])
def test_other_grids_go_point_by_point(step: float) -> None:
    lines = [np.arange(24) * step, line(8, 0, 24), line(8, 0, 24)]
    assert _regular(lines) is None
    exact = at_points(lines)
    np.testing.assert_allclose(simplex_grid(*lines), exact, rtol=0, atol=SAME)


def test_a_unit_that_turns_back_is_no_block() -> None:
    x = line(8, 0, 24)
    assert _regular([x[::-1], x, x]) is None
    assert _regular([np.tile(x[:8], 3), x, x]) is not None  # one piece of a unit
    assert _regular([x, x]) is None
    assert _regular([x[:1], x[:1], x]) is None
    assert LEAST > 24


def test_the_usual_radius_reaches_past_its_simplices() -> None:
    x = line(8, 3, 20)
    exact = at_points([x, x, x], radius="usual")
    noise = simplex_grid(x, x, x, radius="usual")
    # A place on a face may fall to either side of its jump (E30): few do.
    assert (np.abs(noise - exact) < SAME).mean() > 0.999
