"""Balls in order: by depth, whatever its digits, and equal depths by what they are."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from refcloud.lighting.order import depth_order
from refcloud.metaballs import Metaballs
from refcloud.noise import uniform

# Depths that fill their range, lie close together, or have few values.
spans = st.sampled_from([1e-300, 1e-12, 1.0, 1e40, 1e300])
offsets = st.sampled_from([0.0, -1.0, 1e6])
steps = st.sampled_from([0, 1 << 40, 1 << 33, 7])


def balls_at(count: int, seed: int) -> Metaballs:
    """Scatter balls."""
    k = np.arange(count)
    return Metaballs(
        uniform(k[:, None], np.arange(3), seed=seed), np.ones(count), np.ones(count)
    )


@settings(max_examples=100)
@given(st.integers(0, 2**63 - 1), st.integers(1, 300), spans, offsets, steps)
def test_it_is_that_of_one_sort_by_all_keys(seed, count, span, offset, step):
    balls = balls_at(count, seed)
    depth = uniform(np.arange(count), 3, seed=seed)
    if step:
        depth = np.floor(depth * step) / step
    depth = offset + depth * span
    expected = np.lexsort((*balls.centers.T[::-1], depth))
    np.testing.assert_array_equal(depth_order(balls, depth), expected)


def test_depths_that_differ_by_less_than_short_keys_tell() -> None:
    # 2000 neighbouring floats and one far off: their keys are all the same.
    depth = np.append(1.0 + np.arange(2000) * 2.0**-52, 1e9)
    mixed = np.argsort(uniform(np.arange(len(depth)), seed=5))
    found = depth_order(balls_at(len(depth), 1), depth[mixed])
    np.testing.assert_array_equal(mixed[found], np.arange(len(depth)))


def test_no_balls_and_one_ball() -> None:
    empty = Metaballs(np.empty((0, 3)), np.empty(0), np.empty(0))
    assert depth_order(empty, np.empty(0)).tolist() == []
    assert depth_order(balls_at(1, 0), np.array([3.0])).tolist() == [0]
