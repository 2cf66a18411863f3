"""Eroded footprints: they only shrink, and their noise stays where it is."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.lighting import seeds

from refcloud.cloudmap import trilinear
from refcloud.lighting import detail_grid, eroded, lit_share
from refcloud.lighting.erosion import (
    MOST_CELLS,
    NEARLY_ALL,
    OCTAVES,
    PERSISTENCE,
    SAMPLES,
)
from refcloud.noise import octave_bound, octave_sum, uniform

unit = st.floats(0.0, 1.0)
shares = st.floats(0.0, 1.0, exclude_max=True)
BIT = 4e-16  # two products round: two last bits


@given(unit, unit, shares)
def test_erosion_only_takes(weight, noise, erosion) -> None:
    kept = eroded([weight], [noise], erosion=erosion)[0]
    assert 0.0 <= kept <= weight * (1.0 + BIT)


@given(unit, unit, unit, unit, shares)
def test_thicker_places_and_higher_noise_keep_more(w, more, n, higher, e) -> None:
    kept = eroded([w, max(w, more)], [n, max(n, higher)], erosion=e)
    assert kept[0] <= kept[1] * (1.0 + BIT)


@given(unit, unit)
def test_where_nothing_is_taken_all_stays(weight, noise) -> None:
    assert eroded([weight], [noise], erosion=0.0)[0] == pytest.approx(weight, rel=BIT)
    assert eroded([weight], [1.0], erosion=0.9)[0] == pytest.approx(weight, rel=BIT)


@given(unit, unit, unit)
def test_relief_only_takes_light(noise, ahead, relief) -> None:
    share = lit_share([noise], [ahead], relief=relief)[0]
    assert 1.0 - relief - BIT <= share <= 1.0
    if relief > 1e-3 and ahead > noise + 1e-3:
        level = lit_share([noise], [noise], relief=relief)[0]
        assert share < level, "noise that rises toward the sun casts shade"


@settings(max_examples=30)
@given(seeds, st.floats(0.5, 4.0), st.sampled_from([0.0, 0.2, 1.0]))
def test_two_overlapping_boxes_agree_everywhere(seed, cell, pixel) -> None:
    lower = 9.0 * uniform(np.arange(3), 0, seed=seed)
    size = cell * (0.1 + 0.2 * uniform(np.arange(3), 1, seed=seed))
    share = uniform(np.arange(20)[:, None], np.arange(3), seed=seed)
    small, large = (
        detail_grid(
            lower - more, lower + size + more, cell=cell, pixel=pixel, seed=seed
        )
        for more in (0.0, 0.3 * cell)
    )
    # Up to the very border of the smaller box nothing is clamped.
    points = lower + np.round(share) * size
    for places in (lower + share * size, points):
        np.testing.assert_allclose(
            trilinear(small, places), trilinear(large, places), rtol=0.0, atol=1e-12
        )


@settings(max_examples=30)
@given(seeds, st.floats(0.5, 4.0))
def test_values_lie_between_0_and_1(seed, cell) -> None:
    table = detail_grid([0, 0, 0], [cell / 2] * 3, cell=cell, seed=seed)
    assert table.density.min() >= 0.0
    assert table.density.max() <= 1.0


def test_noise_nearly_always_stays_below_the_clip() -> None:
    # The constant's own words: 99 % lie below; of 20,000 places that is to 0.1 %.
    places = 1e4 * uniform(np.arange(20_000)[:, None], np.arange(3), seed=1)
    how = {"octaves": OCTAVES, "persistence": PERSISTENCE, "normalize": "none"}
    below = octave_sum(places, seed=1, **how) < NEARLY_ALL
    assert below.mean() == pytest.approx(0.99, abs=0.005)
    assert NEARLY_ALL < octave_bound(OCTAVES, PERSISTENCE)


def test_octaves_finer_than_a_pixel_are_left_out() -> None:
    sizes, left = [], []
    for pixel in (0.0, 0.3, 0.6, 1.2, 5.0):
        table = detail_grid([0, 0, 0], [1, 1, 1], cell=1.0, pixel=pixel)
        sizes.append(table.density.size)
        left.append(sum(row.skipped for row in table.skipped))
        size = (table.upper - table.lower)[0] / table.density.shape[2]
        assert size * SAMPLES >= pixel
    assert sizes == sorted(sizes, reverse=True)
    assert left == sorted(left)
    assert left[0] == 0


def test_a_wide_box_gets_a_coarser_table_and_says_so() -> None:
    table = detail_grid([0, 0, 0], [1e4, 1e4, 1e4], cell=1.0)
    assert table.density.size <= MOST_CELLS
    (row,) = table.skipped
    assert (row.stage, row.skipped, row.of) == ("erosion", OCTAVES, OCTAVES)


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda: eroded([1.1], [0.0], erosion=0.5), "weight"),
        (lambda: eroded([1.0], [0.0], erosion=1.0), "erosion"),
        (lambda: lit_share([0.0], [2.0], relief=0.5), "ahead"),
        (lambda: detail_grid([0, 0, 0], [1, 1, 1], cell=0.0), "cell"),
    ],
)
def test_refusals_name_the_argument_in_one_line(call, name: str) -> None:
    with pytest.raises(ValueError, match=rf"^{name}: expected [^\n]*$"):
        call()
