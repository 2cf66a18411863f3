"""The largest connected part, beside a flood fill."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from refcloud.cloudmap import largest_part
from refcloud.noise import uniform
from refcloud.plain.cloudmap import largest_part as flooded

shapes = st.tuples(*[st.integers(1, 6)] * 3)
grids_of = shapes.flatmap(
    lambda shape: arrays(np.float64, shape, elements=st.sampled_from([0.0, 0.0, 1.0]))
)


@given(grids_of)
def test_it_is_what_a_flood_fill_finds(density) -> None:
    np.testing.assert_array_equal(largest_part(density), flooded(density.tolist()))


@given(st.integers(0, 2**32), st.floats(0.2, 0.8))
def test_it_holds_in_large_winding_clouds(seed: int, share: float) -> None:
    # Around a share of 0.31 parts wind through the whole grid.
    full = uniform(np.arange(9 * 8 * 7), seed=seed).reshape(9, 8, 7) < share
    density = full.astype(np.float64)
    np.testing.assert_array_equal(largest_part(density), flooded(density.tolist()))


@given(grids_of)
def test_once_more_changes_nothing_and_nothing_is_added(density) -> None:
    kept = largest_part(density)
    np.testing.assert_array_equal(largest_part(kept), kept)
    assert ((kept == density) | (kept == 0.0)).all()
    assert kept.any() == density.any()


def test_a_spiral_hangs_together() -> None:
    walls = np.zeros((1, 9, 9))
    walls[0, ::2] = 1.0
    walls[0, 1::4, -1] = walls[0, 3::4, 0] = 1.0
    np.testing.assert_array_equal(largest_part(walls), walls)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_edges_and_corners_do_not_join(axis: int) -> None:
    density = np.zeros((2, 2, 2))
    density[0, 0, 0] = density[1, 1, 1] = 1.0
    near = [1, 1, 1]
    near[axis] = 0
    density[tuple(near)] = 2.0  # shares a face with (1, 1, 1), an edge with (0, 0, 0)
    kept = largest_part(density)
    assert kept[0, 0, 0] == 0.0
    assert kept.sum() == 3.0
