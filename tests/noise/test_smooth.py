"""Smooth noise, remap, and Worley noise filled with it: range, tiling, every way."""

from __future__ import annotations

import importlib
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.noise import coordinates, seeds
from twins.smooth import details, numbers, smooth_ways, texture_ways
from twins.worley import dimensions, drawn_places

from refcloud.cloudmap import worley_smooth_texture
from refcloud.noise import (
    remap,
    smooth,
    smooth_grid,
    uniform,
    worley,
    worley_smooth,
    worley_smooth_grid,
)

TILED = 1e-12  # a shift of up to 1 is added to up to 2^7 cells, twice
SINGLE = 1e-6  # worst seen 2e-7 in float32; times 5

axes = st.lists(coordinates, max_size=4)


def pointwise(noise, lines, **how) -> np.ndarray:
    """Evaluate a grid one point at a time."""
    lines = [np.array(line, dtype=np.float64) for line in lines]
    grid = np.meshgrid(*lines[::-1], indexing="ij")
    return noise(np.stack(grid[::-1], axis=-1), **how)


@settings(max_examples=60)
@given(st.data(), dimensions, smooth_ways)
def test_grid_has_the_bits_of_the_points(data, n, how) -> None:
    lines = [data.draw(axes) for _ in range(n)]
    grid = smooth_grid(*lines, **how)
    assert grid.shape == tuple(len(line) for line in lines[::-1])
    np.testing.assert_array_equal(grid, pointwise(smooth, lines, **how))


@settings(max_examples=40)
@given(st.data(), dimensions, smooth_ways)
def test_n30_range(data, n, how) -> None:
    noise = smooth(np.array(drawn_places(data.draw, n, most=8)), **how)
    # The source's 128 times a sum below 2.
    bound = {"bound": 1.0, "none": 2.0, "source": 256.0}[how["normalize"]]
    assert ((noise >= 0.0) & (noise <= bound)).all()


@given(st.data(), dimensions, seeds)
def test_n30_lattice_points_show_the_lattice(data, n, seed) -> None:
    cell = data.draw(st.tuples(*[st.integers(-1000, 1000)] * n))
    noise = smooth(np.array(cell, dtype=np.float64), seed=seed, origins="shared")
    assert noise == uniform(*(c % 2**32 for c in cell), seed=seed)


@given(st.data(), dimensions, seeds)
def test_e33_bilinear_is_straight_along_each_axis(data, n, seed) -> None:
    # Within a cell the middle of two places along an axis has their mean.
    cell = np.array(data.draw(st.tuples(*[st.integers(-9, 9)] * n)), dtype=np.float64)
    t = np.array(data.draw(st.tuples(*[st.floats(0.0, 1.0, exclude_max=True)] * n)))
    for axis in range(n):
        ends = np.stack([cell + t] * 3)
        ends[:, axis] = cell[axis] + np.array([0.125, 0.375, 0.625])
        a, middle, b = smooth(ends, seed=seed, origins="shared")
        assert middle == pytest.approx(0.5 * (a + b), abs=1e-14)


@settings(max_examples=50)
@given(st.data(), dimensions, smooth_ways, st.integers(1, 9))
def test_n29_smooth_noise_repeats_after_its_period(data, n, how, period) -> None:
    how |= {"period": period, "octaves": min(how["octaves"], 4)}
    place = np.array(data.draw(st.tuples(*[st.integers(-80, 80)] * n))) / 8.0
    move = period * np.array(data.draw(st.tuples(*[st.integers(-3, 3)] * n)))
    scale = 256.0 if how["normalize"] == "source" else 2.0
    assert smooth(place + move, **how) == pytest.approx(
        smooth(place, **how), abs=TILED * scale
    )


@settings(max_examples=50)
@given(st.data(), dimensions, texture_ways, st.integers(1, 9))
def test_n31_the_combination_repeats_after_its_period(data, n, how, period) -> None:
    place = np.array(data.draw(st.tuples(*[st.integers(-80, 80)] * n))) / 8.0
    move = period * np.array(data.draw(st.tuples(*[st.integers(-3, 3)] * n)))
    here, there = (
        worley_smooth(p, period=period, **how) for p in (place, place + move)
    )
    assert there == pytest.approx(here, abs=TILED)


@settings(max_examples=50)
@given(st.data(), dimensions, texture_ways, st.none() | st.integers(1, 9))
def test_n31_grid_equals_points_and_range(data, n, how, period) -> None:
    lines = [data.draw(axes) for _ in range(n)]
    how["period"] = period
    grid = worley_smooth_grid(*lines, **how)
    assert ((grid >= 0.0) & (grid <= 1.0)).all()
    expected = pointwise(worley_smooth, lines, **how)
    np.testing.assert_allclose(grid, expected, rtol=0, atol=1e-12)
    single = worley_smooth_grid(*lines, **how, dtype="float32")
    assert single.dtype == np.float32
    np.testing.assert_allclose(single, expected, rtol=0, atol=SINGLE)


@settings(max_examples=30)
@given(st.data(), dimensions, details, seeds)
def test_n31_no_place_falls_below_its_scaffold(data, n, detail, seed) -> None:
    places = np.array(drawn_places(data.draw, n, most=8))
    scaffold = 1.0 - worley(places, seed=seed, normalize="clip")
    filled = worley_smooth(places, seed=seed, detail=detail)
    # (w - s + 1) / (2 - s) >= w for s in [0, 1]; roundings of three steps.
    assert (filled >= scaffold - 1e-15).all()


@given(numbers, numbers, numbers, numbers, numbers)
def test_n31_remap_carries_ends_to_ends_and_back(v, l0, h0, ln, hn) -> None:
    if abs(h0 - l0) < 1e-3 or abs(hn - ln) < 1e-3:
        return
    assert remap(l0, l0, h0, ln, hn) == ln
    assert remap(h0, l0, h0, ln, hn) == pytest.approx(hn, abs=1e-13)
    back = remap(remap(v, l0, h0, ln, hn), ln, hn, l0, h0)
    # Each way may stretch roundings of 100 by 2e5: 100 * 2^-52 * 2e5 * 2e5 at worst.
    assert back == pytest.approx(v, abs=1e-3)


def test_e33_an_empty_range_is_refused_or_a_step_by_name() -> None:
    with pytest.raises(ValueError, match=r"^h0: expected other than l0, got 1 equal"):
        remap([0.0, 1.0], [0.0, 1.0], [1.0, 1.0], 0.0, 1.0)
    stepped = remap([0.0, 1.0, 2.0], 1.0, 1.0, 5.0, 7.0, empty="step")
    np.testing.assert_array_equal(stepped, [5.0, 7.0, 7.0])
    # The clamped line tends to the step as its range shrinks.
    for width in (1e-3, 1e-6, 1e-9):
        near = np.clip(remap([0.9, 1.1], 1.0, 1.0 + width, 5.0, 7.0), 5.0, 7.0)
        np.testing.assert_array_equal(near, [5.0, 7.0])


@settings(max_examples=30)
@given(st.lists(st.tuples(*[coordinates | st.sampled_from([math.nan, math.inf])] * 3)))
def test_not_finite_points_give_nan_and_spoil_no_other(places) -> None:
    array = np.array(places, dtype=np.float64).reshape(-1, 3)
    finite = np.isfinite(array).all(axis=1)
    for noise in (smooth, worley_smooth):
        found = noise(array)
        assert np.array_equal(np.isnan(found), ~finite)
        np.testing.assert_array_equal(found[finite], noise(array[finite]))


@settings(max_examples=25)
@given(st.data(), dimensions, smooth_ways, st.integers(1, 40))
def test_chunks_and_parts_do_not_show(data, n, how, few) -> None:
    places = np.array(drawn_places(data.draw, n, most=8))
    lines = [data.draw(axes) for _ in range(n)]
    whole, grid = smooth(places, **how), smooth_grid(*lines, **how)
    module = importlib.import_module("refcloud.noise.smooth")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "CHUNK", few)
        patch.setattr(module, "MOST_LATTICE", few)
        np.testing.assert_array_equal(smooth(places, **how), whole)
        np.testing.assert_array_equal(smooth_grid(*lines, **how), grid)


@pytest.mark.parametrize("cells", [2, 4])
def test_v09_the_texture_tiles_and_fills_about_half_of_its_box(cells: int) -> None:
    grid = worley_smooth_texture(24, cells=cells, seed=5, side=2.0)
    density = grid.density
    assert 0.3 < (density > 0.0).mean() < 0.7
    assert density.max() <= 1.0
    np.testing.assert_array_equal(grid.lower, [-1.0, -1.0, -1.0])
    for axis in range(3):
        inside = np.abs(np.diff(density, axis=axis)).max()
        across = np.abs(density.take(0, axis=axis) - density.take(-1, axis=axis)).max()
        assert across <= 1.25 * inside, "steps across the seam are like steps inside"


def test_n28_a_finer_texture_is_of_the_same_cloud() -> None:
    # Three voxels in the place of one: the middle one has its centre.
    coarse = worley_smooth_texture(8, cells=3, seed=2).density
    fine = worley_smooth_texture(24, cells=3, seed=2).density
    np.testing.assert_allclose(fine[1::3, 1::3, 1::3], coarse, rtol=0, atol=1e-13)


def test_bad_arguments_are_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"^points: expected two or three coordin"):
        smooth(np.zeros((4, 1)))
    with pytest.raises(ValueError, match=r"^threshold: expected a finite number in"):
        worley_smooth_texture(4, threshold=1.0)
    with pytest.raises(ValueError, match=r"^size: expected a whole number in"):
        worley_smooth_texture(646)
