"""Worley noise: exact where it says so, in its range, tileable, the same every way."""

from __future__ import annotations

import importlib
import itertools
import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.noise import coordinates, points, seeds
from twins.worley import dimensions, drawn_places, features, periods, ways

from refcloud.noise import (
    worley,
    worley_bound,
    worley_drawn,
    worley_grid,
    worley_points,
)

SAME = 1e-12  # the contract for grids and points; here their bits agree
SINGLE = 5e-7  # worst seen 2.5e-7 in float32: the last bits of three squares; times 2

axes = st.lists(coordinates, max_size=5)


def module(name: str):
    """Give a module of the room: `refcloud.noise.worley` itself names the function."""
    return importlib.import_module(f"refcloud.noise.{name}")


def pointwise(lines, **how) -> np.ndarray:
    """Evaluate a grid one point at a time."""
    lines = [np.array(line, dtype=np.float64) for line in lines]
    grid = np.meshgrid(*lines[::-1], indexing="ij")
    return worley(np.stack(grid[::-1], axis=-1), **how)


def brute_force(places: np.ndarray, period: int, seed: int, rank: int) -> np.ndarray:
    """Meet every point of the pattern and its clones all around, as document D says."""
    n = places.shape[-1]
    cells = np.indices((period,) * n).reshape(n, -1)
    q = (cells.T + worley_points(*cells, seed=seed, period=period)).T
    clones = [
        q + period * np.array(step)[:, None]
        for step in itertools.product((-2, -1, 0, 1, 2), repeat=n)
    ]
    every = np.concatenate(clones, axis=1).T
    distance = np.linalg.norm(places[:, None] - every, axis=-1)
    return np.sort(distance, axis=1)[:, rank]


@settings(max_examples=40)
@given(st.data(), dimensions, st.integers(1, 4), seeds, features)
def test_exact_search_equals_brute_force(data, n, period, seed, feature) -> None:
    place = st.tuples(*[st.floats(0.0, float(period))] * n)
    places = np.array(data.draw(st.lists(place, min_size=1, max_size=6)))
    found = worley(places, seed=seed, period=period, feature=feature)
    expected = brute_force(places, period, seed, int(feature == "F2"))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14)


@pytest.mark.slow
@pytest.mark.parametrize("period", [4, 9])
def test_exact_search_equals_a_tree(period: int) -> None:
    spatial = pytest.importorskip("scipy.spatial", reason="scipy is not installed")
    line = (np.arange(40) + 0.5) / 40 * period
    cells = np.indices((period,) * 3).reshape(3, -1)
    q = cells.T + worley_points(*cells, seed=3, period=period)
    grid = np.stack(np.meshgrid(line, line, line, indexing="ij")[::-1], axis=-1)
    expected, _ = spatial.cKDTree(q, boxsize=period).query(grid, 2)
    for rank, feature in enumerate(("F1", "F2")):
        found = worley_grid(line, line, line, seed=3, period=period, feature=feature)
        np.testing.assert_allclose(found, expected[..., rank], rtol=0, atol=1e-13)


@settings(max_examples=60)
@given(st.data(), dimensions, ways, st.sampled_from(["float64", "float32"]))
def test_grid_has_the_bits_of_the_points(data, n, how, dtype) -> None:
    lines = [data.draw(axes) for _ in range(n)]
    grid = worley_grid(*lines, **how, dtype=dtype)
    assert grid.shape == tuple(len(line) for line in lines[::-1])
    assert grid.dtype == dtype
    np.testing.assert_array_equal(grid, pointwise(lines, **how, dtype=dtype))


@settings(max_examples=40)
@given(st.data(), dimensions, ways)
def test_single_precision_is_close(data, n, how) -> None:
    places = np.array(drawn_places(data.draw, n, most=8))
    single = worley(places, **how, dtype="float32")
    assert single.dtype == np.float32
    np.testing.assert_allclose(single, worley(places, **how), rtol=0, atol=SINGLE)


@settings(max_examples=30)
@given(st.data(), dimensions, seeds, periods)
def test_range_and_order_at_any_finite_place(data, n, seed, period) -> None:
    places = np.array(drawn_places(data.draw, n, most=8))
    how = {"seed": seed, "period": period}
    f1, f2 = (worley(places, feature=f, **how) for f in ("F1", "F2"))
    assert (f1 >= 0.0).all()
    assert (f1 <= f2).all()
    for feature, found in (("F1", f1), ("F2", f2)):
        assert (found < worley_bound(n, feature)).all()
        for scale in ("bound", "inverted", "clip"):
            share = worley(places, feature=feature, normalize=scale, **how)
            assert ((share >= 0.0) & (share <= 1.0)).all()
        near = worley(places, feature=feature, search="neighbours", **how)
        assert (near >= found).all()
        assert (near < worley_bound(n, feature)).all()


@settings(max_examples=60)
@given(st.data(), dimensions, seeds, periods, features)
def test_no_step_changes_the_distance_by_more_than_itself(
    data, n, seed, period, feature
) -> None:
    near = st.floats(-6.0, 6.0)
    a, b = (np.array(data.draw(st.tuples(*[near] * n))) for _ in range(2))
    how = {"seed": seed, "period": period, "feature": feature}
    change = abs(worley(a, **how) - worley(b, **how))
    assert change <= np.linalg.norm(a - b) + 1e-14


@settings(max_examples=60)
@given(st.data(), dimensions, ways, st.integers(1, 9))
def test_n29_the_pattern_repeats_after_its_period(data, n, how, period) -> None:
    how["period"] = period
    eighths = st.integers(-800, 800)  # whole steps of 1/8 move without rounding
    place = np.array(data.draw(st.tuples(*[eighths] * n))) / 8.0
    move = period * np.array(data.draw(st.tuples(*[st.integers(-9, 9)] * n)))
    assert worley(place + move, **how) == worley(place, **how)


@settings(max_examples=30)
@given(st.data(), dimensions, seeds, periods)
def test_the_points_themselves_are_at_distance_zero(data, n, seed, period) -> None:
    cell = data.draw(st.tuples(*[st.integers(-50, 50)] * n))
    inside = worley_points(*cell, seed=seed, period=period)
    assert ((inside >= 0.0) & (inside < 1.0)).all()
    # The sum of cell and place rounds, at 50 cells by up to 3.6e-15 an axis.
    assert worley(cell + inside, seed=seed, period=period) <= 1e-14


@settings(max_examples=25)
@given(st.data(), dimensions, ways, st.integers(1, 5), st.integers(1, 5))
def test_chunks_and_tables_do_not_show(data, n, how, chunk, few) -> None:
    places = np.array(drawn_places(data.draw, n, most=12))
    whole = worley(places, **how)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module("worley_search"), "CHUNK", chunk)
        patch.setattr(module("worley_search"), "HASHED_CHUNK", few)
        np.testing.assert_array_equal(worley(places, **how), whole)
        patch.setattr(module("worley_lists"), "PAYS", 1e9)
        patch.setattr(module("worley_lists"), "PARTS", few)
        patch.setattr(module("worley_lists"), "BLOCK", chunk)
        np.testing.assert_array_equal(worley(places, **how), whole)
        patch.setattr(module("worley_search"), "MOST_TABLE", 0)
        np.testing.assert_array_equal(worley(places, **how), whole)


@settings(max_examples=25)
@given(st.data(), dimensions, ways, st.integers(1, 40), st.integers(1, 3))
def test_blocks_runs_and_tiles_do_not_show(data, n, how, table, run) -> None:
    lines = [data.draw(axes) for _ in range(n)]
    whole = worley_grid(*lines, **how)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module("worley_grid"), "TABLE", table)
        patch.setattr(module("worley_grid"), "TILE", table)
        patch.setattr(module("worley_runs"), "LONGEST_RUN", run)
        np.testing.assert_array_equal(worley_grid(*lines, **how), whole)


@given(st.lists(st.tuples(*[coordinates | st.sampled_from([math.nan, -math.inf])] * 2)))
def test_not_finite_points_give_nan_and_spoil_no_other(places) -> None:
    array = np.array(places, dtype=np.float64).reshape(-1, 2)
    finite = np.isfinite(array).all(axis=1)
    noise = worley(array, period=7)
    assert np.array_equal(np.isnan(noise), ~finite)
    np.testing.assert_array_equal(noise[finite], worley(array[finite], period=7))


@settings(max_examples=25)
@given(st.lists(points, min_size=1, max_size=3), st.permutations([0, 1, 2]))
def test_seeds_are_hashed_and_do_not_move_the_pattern(places, order) -> None:
    # One place may agree by chance; a hundred around it do not.
    cloud = np.array(places)[:1] % 8.0 + np.indices((10, 10, 1)).reshape(3, -1).T * 0.37
    assert (worley(cloud, seed=1) != worley(cloud, seed=2)).any()
    assert (worley(cloud) != worley(cloud[:, order])).any() or order == [0, 1, 2]


def test_resolution_and_cells_have_nothing_to_do_with_each_other() -> None:
    # N28: a coarse picture is every third sample of a fine one, of any cell size.
    for cells in (0.7, 5.0, 11.3):
        fine = np.linspace(0.0, cells, 46)
        whole = worley_grid(fine, fine, seed=9)
        np.testing.assert_array_equal(
            worley_grid(fine[::3], fine[::3], seed=9), whole[::3, ::3]
        )


def test_memory_stays_bounded() -> None:
    line = np.arange(48) * 1000.5  # every sample alone in its cell
    far = np.stack([np.linspace(-1e9, 1e9, 40_000)] * 3, axis=-1)  # 1 MB
    for work in (lambda: worley_grid(line, line, line), lambda: worley(far)):
        tracemalloc.start()
        work()
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 100e6, "tables of one block, and the result"


def test_bad_arguments_are_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"^points: expected two or three coordin"):
        worley(np.zeros((4, 4)))
    with pytest.raises(ValueError, match=r"^period: expected a whole number in \[1"):
        worley(np.zeros(3), period=0)
    with pytest.raises(ValueError, match=r"^z: expected finite numbers"):
        worley_grid([0.0], [0.0], [math.inf])
    with pytest.raises(TypeError, match=r"^cells: expected whole numbers"):
        worley_points(0.5, 1)
    with pytest.raises(TypeError, match=r"^cells: expected two or three"):
        worley_points(1)
    with pytest.raises(ValueError, match=r"^dtype: expected one of"):
        worley(np.zeros(3), dtype="float16")


def test_shapes_are_those_of_the_points() -> None:
    for shape in ((3,), (2,), (0, 3), (2, 3), (4, 1, 2, 2)):
        assert np.shape(worley(np.zeros(shape))) == shape[:-1]
    assert worley_grid([], [0.0], [0.0, 1.0]).shape == (2, 1, 0)


def test_e32_dividing_by_the_largest_found_makes_the_picture_depend_on_the_draw():
    one, two = (worley_drawn(40, 30, count=count, seed=4) for count in (11, 12))
    # A twelfth point is near to some pixels only, but changes the others too.
    assert one.max() == two.max() == 255.0
    assert (one != two).mean() > 0.9
    np.testing.assert_allclose(
        worley_drawn(40, 30, count=11, seed=4, inverted=True), 255.0 - one, atol=1e-13
    )
