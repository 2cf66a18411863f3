"""Value noise: grid equals points, continuity, range, any finite place."""

from __future__ import annotations

import importlib
import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.noise import INTERPOLANTS, TWO_POINT, coordinates, points, seeds_or_none

from refcloud.noise import cosine, smoothed, uniform, value, value_grid
from refcloud.noise.lattice import PERIOD
from refcloud.noise.weights import PEAKS

SAME = 1e-12  # the contract; without matrix products the bits agree, see below

axes = st.lists(coordinates, max_size=5)
ways = st.fixed_dictionaries(
    {
        "seed": seeds_or_none,
        "interpolant": st.sampled_from(INTERPOLANTS),
        "smooth": st.booleans(),
        "period": st.none() | st.integers(1, 9),
    }
)


def module(name: str):
    """Give a module of the room: `refcloud.noise.value` itself names the function."""
    return importlib.import_module(f"refcloud.noise.{name}")


def pointwise(x, y, z, **how) -> np.ndarray:
    """Evaluate a grid one point at a time."""
    grid = np.meshgrid(np.array(z), np.array(y), np.array(x), indexing="ij")
    return value(np.stack(grid[::-1], axis=-1).astype(np.float64), **how)


@given(axes, axes, axes, ways)
def test_grid_equals_points(x, y, z, how) -> None:
    grid = value_grid(x, y, z, **how)
    assert grid.shape == (len(z), len(y), len(x))
    np.testing.assert_allclose(grid, pointwise(x, y, z, **how), rtol=0, atol=SAME)


@given(axes, axes, axes, ways)
def test_grid_has_the_bits_of_the_points(x, y, z, how) -> None:
    # All but cosine, whose library function may round by the array's layout.
    if how["interpolant"] != "cosine":
        np.testing.assert_array_equal(
            value_grid(x, y, z, **how), pointwise(x, y, z, **how)
        )


@given(st.lists(points, min_size=1, max_size=8), ways)
def test_range_at_any_finite_place(places, how) -> None:
    noise = value(np.array(places), **how)
    peak = PEAKS[how["interpolant"]] ** 3
    # Two-point forms keep [-1, 1] to the last bit; the others round in 64 terms.
    assert np.abs(noise).max() <= peak + (0.0 if peak == 1.0 else 1e-14)


@given(axes, axes, axes, ways)
def test_single_precision_is_close_and_grid_equals_points(x, y, z, how) -> None:
    exact = pointwise(x, y, z, **how)
    for single in (
        value_grid(x, y, z, dtype="float32", **how),
        pointwise(x, y, z, dtype="float32", **how),
    ):
        assert single.dtype == np.float32
        # Worst seen 1.5e-6, times 4: quintic terms reach 15 before they cancel.
        np.testing.assert_allclose(single, exact, rtol=0, atol=6e-6)


@given(
    st.tuples(*[st.integers(-(2**12), 2**12)] * 3),
    st.permutations([3, -1, 0]),
    st.integers(1, 9),
    ways,
)
def test_the_pattern_repeats_after_its_period_exactly(eighths, axis, period, how):
    how["period"] = period
    place = np.array(eighths) / 8.0
    moved = place + period * np.array(axis)
    assert value(moved, **how) == value(place, **how)
    lines = (place[:, None], moved[:, None])
    here, there = (value_grid(*line, **how) for line in lines)
    assert here == there


@given(st.tuples(*[st.integers(-(2**40), 2**40)] * 3), ways)
def test_lattice_points_show_the_lattice(cell, how) -> None:
    how |= {"smooth": True, "period": None}
    expected = smoothed(*cell, seed=how["seed"])
    # cos(pi) is exact, and so are the weights 0 and 1 of every form.
    assert value(np.array(cell, dtype=np.float64), **how) == expected


@given(st.tuples(*[st.integers(-(2**18), 2**18)] * 3), st.permutations([0, 0, 1]), ways)
def test_places_one_period_apart_are_one_place(eighths, axis, how) -> None:
    how["period"] = None
    place = np.array(eighths) / 8.0
    moved = place + PERIOD * np.array(axis)
    assert value(moved, **how) == value(place, **how)


def test_e14_eq_7_with_its_names_put_right() -> None:
    place = (-2.25, 0.5, 7.75)
    x, y, z = (math.floor(c) for c in place)
    tx, ty, tz = (c - math.floor(c) for c in place)
    xyz, Xyz = smoothed(x, y, z), smoothed(x + 1, y, z)
    xYz, XYz = smoothed(x, y + 1, z), smoothed(x + 1, y + 1, z)
    xyZ, XyZ = smoothed(x, y, z + 1), smoothed(x + 1, y, z + 1)
    xYZ, XYZ = smoothed(x, y + 1, z + 1), smoothed(x + 1, y + 1, z + 1)
    iyz, iYz = cosine(xyz, Xyz, tx), cosine(xYz, XYz, tx)
    iyZ, iYZ = cosine(xyZ, XyZ, tx), cosine(xYZ, XYZ, tx)
    iz, iZ = cosine(iyz, iYz, ty), cosine(iyZ, iYZ, ty)
    assert value(place) == pytest.approx(cosine(iz, iZ, tz), abs=1e-15)


def crossing(name: str, smooth: bool, step: float) -> np.ndarray:
    """Sample across many cell faces, negative ones too: (faces, 5 places)."""
    faces = np.arange(-40, 41)[:, None] + step * np.arange(-2, 3)
    line = np.full((*faces.shape, 3), 0.3)
    line[..., 0] = faces
    return value(line, interpolant=name, smooth=smooth)


@pytest.mark.parametrize("name", INTERPOLANTS)
@pytest.mark.parametrize("smooth", [True, False])
def test_e14_noise_is_continuous_at_cell_faces(name: str, smooth: bool) -> None:
    step = 2.0**-30
    # No weight changes faster than 7 per cell, along one of three axes with peak 1.5.
    steepest = 2 * 7 * 1.5**2
    jumps = np.abs(np.diff(crossing(name, smooth, step), axis=1))
    assert jumps.max() <= steepest * step


@pytest.mark.parametrize("name", INTERPOLANTS)
def test_slopes_agree_at_cell_faces_but_for_linear(name: str) -> None:
    step = 2.0**-17
    before, _, after = np.split(np.diff(crossing(name, False, step)) / step, [1, 3], 1)
    gap = np.abs(after - before).max()
    # Curvature is at most 40 per cell squared, over four steps.
    if name == "linear":
        assert gap > 0.1
    else:
        assert gap < 40 * 2 * 1.5**2 * 4 * step


def test_e14_negative_places_do_not_mirror_positive_ones() -> None:
    place = np.stack([np.linspace(0.1, 9.9, 50)] * 3, axis=-1)
    assert np.abs(value(place) - value(-place)).min() > 0.0
    tiny = np.full((1, 3), -1e-300)  # floor says cell -1, place 1: the lattice point 0
    assert value(tiny) == value(np.zeros((1, 3)))


@given(st.lists(st.tuples(*[coordinates | st.just(math.nan) | st.just(-math.inf)] * 3)))
def test_not_finite_points_give_nan_and_spoil_no_other(places) -> None:
    array = np.array(places, dtype=np.float64).reshape(-1, 3)
    finite = np.isfinite(array).all(axis=1)
    noise = value(array, interpolant="quintic")
    assert np.array_equal(np.isnan(noise), ~finite)
    np.testing.assert_array_equal(
        noise[finite], value(array[finite], interpolant="quintic")
    )


def test_shapes_are_those_of_the_points() -> None:
    for shape in ((3,), (0, 3), (2, 3), (4, 1, 2, 3)):
        assert np.shape(value(np.zeros(shape))) == shape[:-1]


@settings(max_examples=25)
@given(
    st.lists(points, min_size=1, max_size=12),
    ways,
    st.integers(1, 5),
    st.integers(1, 5),
)
def test_chunks_do_not_show(places, how, chunk, hashed_chunk) -> None:
    # The box of close points and the far points' own neighbours are one noise too.
    array = np.array(places)
    if how["interpolant"] == "cosine":
        how["interpolant"] = "quintic"
    whole = value(array, **how)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module("scattered"), "CHUNK", chunk)
        patch.setattr(module("value"), "HASHED_CHUNK", hashed_chunk)
        np.testing.assert_array_equal(value(array, **how), whole)
        patch.setattr(module("value_table"), "MOST_LATTICE", 0)
        np.testing.assert_array_equal(value(array, **how), whole)


@settings(max_examples=50)
@given(
    seeds_or_none,
    st.sampled_from(INTERPOLANTS),
    st.booleans(),
    st.sampled_from([0.0, -1.5, 1e6, -1e9]),
)
def test_the_readable_form_is_the_same_noise(seed, name, smooth, corner) -> None:
    at = corner + 3.0 * uniform(np.arange(200)[:, None], np.arange(3), seed=2)
    literal = module("value")._literal(at, seed, name, smooth)
    noise = value(at, seed=seed, interpolant=name, smooth=smooth)
    np.testing.assert_allclose(noise, literal, rtol=0, atol=SAME)


@settings(max_examples=25)
@given(axes, axes, axes, ways)
def test_parts_of_a_grid_do_not_show(x, y, z, how) -> None:
    if how["interpolant"] == "cosine":
        how["interpolant"] = "quintic"
    whole = value_grid(x, y, z, **how)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module("value_grid"), "MOST_LATTICE", 100)
        patch.setattr(module("value_grid"), "SLAB", 1)
        patch.setattr(module("lattice"), "SLAB", 1)
        np.testing.assert_array_equal(value_grid(x, y, z, **how), whole)


def test_a_grid_hashes_each_lattice_point_once(monkeypatch) -> None:
    counted = []
    original = module("lattice")._lattice_random

    def counting(x, y, z, seed):
        g = original(x, y, z, seed)
        counted.append(g.size)
        return g

    monkeypatch.setattr(module("lattice"), "_lattice_random", counting)
    fine = np.linspace(0.1, 7.9, 100)  # cells 0 to 7: lines 0 to 8, halo -1 and 9
    value_grid(fine, fine, fine)
    assert sum(counted) == 11**3
    counted.clear()
    value_grid([0.5, 1e9 + 0.5], [0.5, 0.5], [0.5], smooth=False)
    assert sum(counted) == 4 * 2 * 2


def test_memory_stays_bounded() -> None:
    far = np.arange(48) * 1000.5  # 288 lines along each axis: 24 million lattice points
    line = np.stack([np.linspace(-1e9, 1e9, 200_000)] * 3, axis=-1)  # 4.8 MB
    for work in (lambda: value_grid(far, far, far), lambda: value(line)):
        tracemalloc.start()
        work()
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 100e6, "three blocks of 2^21 values, and the result"


@pytest.mark.parametrize("name", TWO_POINT)
def test_seed_none_repeats_as_the_paper_does_and_a_seed_does_not(name: str) -> None:
    # E09: 57 cells along x are one cell along y.
    x, y = np.linspace(-3.0, 3.0, 25), np.linspace(-2.0, 2.0, 17)
    for seed, repeats in ((None, True), (0, False)):
        here = value_grid(x + 57.0, y, [0.5], seed=seed, interpolant=name)
        there = value_grid(x, y + 1.0, [0.5], seed=seed, interpolant=name)
        same = np.abs(here - there).max() < SAME * 100  # t rounds at 57
        assert same == repeats


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_grid_axes_must_be_finite(bad: float) -> None:
    with pytest.raises(ValueError, match=r"^y: expected finite numbers"):
        value_grid([0.0], [1.0, bad], [0.0])


def test_bad_arguments_are_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"^points: expected an array of shape"):
        value(np.zeros((4, 2)))
    with pytest.raises(ValueError, match=r"^x: expected an array of shape"):
        value_grid([[0.0]], [0.0], [0.0])
    with pytest.raises(ValueError, match=r"^interpolant: expected one of"):
        value(np.zeros(3), interpolant="nearest")
    with pytest.raises(TypeError, match=r"^seed: expected a whole number"):
        value(np.zeros(3), seed=0.5)
