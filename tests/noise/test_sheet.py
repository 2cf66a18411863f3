"""Document C's cloud sheet: no seam, its faults by name, a filter that only rises."""

from __future__ import annotations

import importlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from twins.noise import seeds
from twins.sheet import covers, drawn_map, numbers

from refcloud.noise import (
    cloud_sheet,
    elias2d,
    exponential_filter,
    overlap_octaves,
    sheet_map,
    wrap_halo,
    wrapped_bilinear,
)


def test_n06_smoothing_keeps_the_mean_and_one_level() -> None:
    raw = 128.0 + 128.0 * elias2d(np.arange(1, 33), np.arange(1, 33)[:, None], seed=3)
    assert sheet_map(seed=3).mean() == pytest.approx(raw.mean(), rel=1e-14)


@given(st.data())
def test_n07_the_halo_is_the_opposite_side(data) -> None:
    values = drawn_map(data.draw)
    halo = wrap_halo(values)
    height, width = values.shape
    j, i = np.indices(halo.shape)
    np.testing.assert_array_equal(halo, values[(j - 1) % height, (i - 1) % width])


@given(seeds, st.integers(1, 12), numbers)
def test_range_of_the_map(seed, size, source) -> None:
    values = sheet_map(size, seed=seed, numbers=source)
    assert ((values > 0.0) & (values <= 256.0)).all()


def test_e31_256_is_reached_and_four_octaves_reach_480(monkeypatch) -> None:
    # Hash bits 0 give the number 1: grey level 256, which no byte holds.
    sheet = importlib.import_module("refcloud.noise.sheet_map")
    monkeypatch.setattr(sheet, "elias2d", lambda x, y, seed: np.ones((x + y).shape))
    values = sheet.sheet_map(4)
    assert (values == 256.0).all()
    assert (overlap_octaves(values, 16) == 480.0).all()


def test_pitfall_a_normalised_sum_has_no_cloud() -> None:
    total = overlap_octaves(sheet_map(seed=7))
    assert total.mean() == pytest.approx(240.0, abs=10.0)
    assert 0.4 < (exponential_filter(total) > 0.0).mean() < 0.8
    normalised = total / 1.875
    assert (exponential_filter(normalised) > 0.0).mean() < 0.01


@settings(max_examples=40)
@given(st.data(), st.integers(1, 4), st.integers(1, 24))
def test_n17_the_sheet_has_no_seam(data, octaves, size) -> None:
    values = drawn_map(data.draw)
    sheet = overlap_octaves(values, size, octaves=octaves)
    # One size further on, each octave stands where it stood: the sum continues there.
    height, width = values.shape
    further = np.arange(size, 2 * size)
    expected = sum(
        wrapped_bilinear(
            values,
            further * (2.0**o / size) * width,
            (further * (2.0**o / size) * height)[:, None],
        )
        / 2.0**o
        for o in range(octaves)
    )
    # Places up to 2^5 maps of 5 samples round by 3e-14, slopes are up to 256 each way.
    np.testing.assert_allclose(sheet, expected, rtol=0, atol=1e-10)


def test_n17_steps_across_the_seam_are_like_steps_inside() -> None:
    for seed in range(5):
        total = overlap_octaves(sheet_map(seed=seed))
        inside = np.abs(np.diff(total, axis=0)).max()
        assert np.abs(total[0] - total[-1]).max() <= inside
        inside = np.abs(np.diff(total, axis=1)).max()
        assert np.abs(total[:, 0] - total[:, -1]).max() <= inside


@given(st.data())
def test_n14_interpolation_hits_the_samples_and_stays_between(data) -> None:
    values = drawn_map(data.draw)
    y, x = np.indices(values.shape)
    np.testing.assert_array_equal(wrapped_bilinear(values, x, y), values)
    place = data.draw(arrays(np.float64, (2, 5), elements=st.floats(-50.0, 50.0)))
    between = wrapped_bilinear(values, *place)
    assert (between >= values.min() - 1e-12).all()
    assert (between <= values.max() + 1e-12).all()


def test_n17_the_last_octave_shows_the_map_itself() -> None:
    values = sheet_map(8, seed=5)
    three, four = (overlap_octaves(values, 64, octaves=n) for n in (3, 4))
    # What is added is a difference of sums up to 480, each rounded by 6e-14.
    tiled = np.tile(values, (8, 8)) / 8.0
    np.testing.assert_allclose(four - three, tiled, rtol=0, atol=3e-13)


@given(
    arrays(np.float64, 8, elements=st.floats(-600.0, 600.0)),
    covers,
    covers,
    st.floats(0.0, 1.0),
)
def test_n33_the_filter_rises_and_stays_in_its_range(
    values, cover, more, sharpness
) -> None:
    cloud = exponential_filter(np.sort(values), cover=cover, sharpness=sharpness)
    assert (np.diff(cloud) >= 0.0).all()
    assert ((cloud >= 0.0) & (cloud <= 255.0)).all()
    assert (cloud[np.sort(values) <= 255.0 - cover] == 0.0).all()
    covered = exponential_filter(
        np.sort(values), cover=cover + more, sharpness=sharpness
    )
    assert (covered >= cloud).all()


def test_e09_the_next_seed_is_the_same_pattern_moved() -> None:
    one, next_one = sheet_map(seed=41), sheet_map(seed=42)
    # Away from the wrapped border, where the nine taps meet the same numbers.
    np.testing.assert_array_equal(next_one[1:29, 1:14], one[3:31, 18:31])
    hashed, next_hashed = (sheet_map(seed=s, numbers="hashed") for s in (41, 42))
    assert np.abs(next_hashed[1:29, 1:14] - hashed[3:31, 18:31]).max() > 1.0


def test_the_same_seed_gives_the_same_sheet_and_another_does_not() -> None:
    np.testing.assert_array_equal(cloud_sheet(64, seed=9), cloud_sheet(64, seed=9))
    assert (cloud_sheet(64, seed=9) != cloud_sheet(64, seed=10)).any()


def test_bad_arguments_are_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"^values: expected at least one sample"):
        wrap_halo(np.zeros((0, 3)))
    with pytest.raises(ValueError, match=r"^size: expected a whole number in \[1"):
        sheet_map(0)
    with pytest.raises(ValueError, match=r"^sharpness: expected a finite number in"):
        exponential_filter([1.0], sharpness=1.5)


@settings(max_examples=40)
@given(st.data(), st.integers(1, 6), st.integers(1, 40) | st.just(64))
def test_the_fast_sum_is_the_literal_one(data, octaves, size) -> None:
    sheet = importlib.import_module("refcloud.noise.sheet")
    values = drawn_map(data.draw)
    found = overlap_octaves(values, size, octaves=octaves)
    literal = sheet._literal(values, size, octaves)
    if size & (size - 1) == 0 and not any(n & (n - 1) for n in values.shape):
        np.testing.assert_array_equal(found, literal)  # every place is exact
    else:
        # Places round by a last bit, slopes are up to 256 each way.
        np.testing.assert_allclose(found, literal, rtol=0, atol=1e-10)


def test_the_filter_at_both_ends_of_sharpness() -> None:
    values = [200.0, 235.0, 236.0, 400.0]
    hard = exponential_filter(values, sharpness=0.0)
    assert hard.tolist() == [0.0, 0.0, 255.0, 255.0]
    assert (exponential_filter(values, sharpness=1.0) == 0.0).all()
