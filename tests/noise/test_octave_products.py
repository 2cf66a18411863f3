"""Octaves summed by products of small matrices: the same noise, rounded once."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from refcloud.noise import octave_sum_grid, uniform
from refcloud.noise.octave_products import EDGE, octave_sum_products

ROUNDED = 2.0**-25 + 1e-13  # to float32, below 1; and the order of a few dozen sums


@settings(max_examples=30)
@given(
    st.integers(0, 2**40),
    st.tuples(*[st.integers(1, 40)] * 3),
    st.integers(1, 4),
    st.floats(-1e4, 1e4),
    st.sampled_from([1.0, 0.5, 0.125, 0.03]),
)
def test_wanted_cubes_hold_the_sum_and_others_nothing(
    seed, size, octaves, start, spacing
) -> None:
    axes = tuple(start + spacing * np.arange(n) for n in size)
    cubes = [-(-n // EDGE) for n in size[::-1]]
    wanted = uniform(*np.indices(cubes), seed=seed) < 0.5
    how = {"octaves": octaves, "persistence": 0.6, "seed": seed}
    found = octave_sum_products(axes, wanted, per=0.64, **how)
    whole, _ = octave_sum_grid(*axes, normalize="none", **how)
    # Cubes between two wanted ones of a row are made as well.
    ahead = np.maximum.accumulate(wanted, axis=2)
    made = ahead & np.maximum.accumulate(wanted[..., ::-1], axis=2)[..., ::-1]
    inside = np.kron(made, np.ones((EDGE,) * 3, bool))
    inside = inside[tuple(slice(n) for n in whole.shape)].astype(bool)
    expected = np.where(inside, np.minimum(whole / 0.64, 1.0), 0.0)
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=ROUNDED)


def test_no_octave_is_no_noise() -> None:
    axes = (np.zeros(1), np.zeros(2), np.zeros(3))
    none = octave_sum_products(
        axes, np.ones((1, 1, 1), bool), octaves=0, persistence=0.6, seed=0, per=1.0
    )
    assert none.shape == (3, 2, 1)
    assert not none.any()
