"""Gradient noise: range by theorem, zero at lattice points, C1/C2, period, symmetry."""

from __future__ import annotations

import importlib
import itertools
import math

import numpy as np
import pytest
from enclosing import boxes, exceeds
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.gradient import SETS, axes, fades, hashes, places, ways
from twins.noise import coordinates, seeds

from refcloud import products
from refcloud.noise import (
    gradient,
    gradient_derivative,
    gradient_grid,
    gradient_set,
    lattice_bits,
    uniform,
)
from refcloud.noise.directions import PEAKS
from refcloud.noise.directions import SETS as ROWS

SAME = 1e-12  # the contract
SINGLE = 5e-6  # float32: worst seen 1.7e-6 near quintic t = 1, times 3

dimensions = st.sampled_from([2, 3])
at_points = st.sampled_from([2, 3, 4])  # on grids there is no fourth axis


def module(name: str):
    """Give a module of the room, whose name may be that of a function too."""
    return importlib.import_module(f"refcloud.noise.{name}")


def mesh(*lines) -> np.ndarray:
    """List the places of a grid, [..., y, x] with x, y, ... last."""
    grid = np.meshgrid(*(np.array(c, np.float64) for c in lines[::-1]), indexing="ij")
    return np.stack(grid[::-1], axis=-1)


def hashed_places(count: int, width: int, seed: int = 0, size: float = 40.0):
    """Give places scattered over a cube around 0."""
    return size * (
        uniform(np.arange(count)[:, None], np.arange(width), seed=seed) - 0.5
    )


@pytest.mark.parametrize("n", [2, 3, 4])
@pytest.mark.parametrize("fade", ["quintic", "hermite"])
def test_the_readable_form_is_the_same_noise(n: int, fade) -> None:
    at, name = hashed_places(500, n), SETS[n][0]
    plain = module("gradient")._literal(at, 5, fade, name)
    assert np.abs(gradient(at, seed=5, fade=fade) - plain).max() < SAME
    if n == 3 and fade == "quintic":
        x, y, z = (hashed_places(9, 3, seed=9) * 0.2).T
        rows = ROWS[name].T / PEAKS[name][fade]
        dense = module("gradient_grid")._literal(x, y, z, 5, rows)
        assert np.abs(gradient_grid(x, y, z, seed=5) - dense).max() < SAME


@settings(max_examples=60)
@given(dimensions, st.data())
def test_grid_equals_points_in_both_precisions(n: int, data) -> None:
    lines, how = [data.draw(axes) for _ in range(n)], data.draw(ways(n))
    exact = gradient(mesh(*lines), **how)
    np.testing.assert_allclose(gradient_grid(*lines, **how), exact, rtol=0, atol=SAME)
    how["dtype"] = "float32"
    for single in (gradient_grid(*lines, **how), gradient(mesh(*lines), **how)):
        assert single.dtype == np.float32
        np.testing.assert_allclose(single, exact, rtol=0, atol=SINGLE)


@given(at_points, st.data())
def test_range_at_any_finite_place(n: int, data) -> None:
    noise = gradient(np.array(data.draw(places(n))), **data.draw(ways(n)))
    assert np.abs(noise).max() <= 1.0


def fade_of(name: str, t: np.ndarray) -> np.ndarray:
    return module("gradient").FADES[name](t)


@pytest.mark.slow
@pytest.mark.parametrize("fade", ["quintic", "hermite"])
@pytest.mark.parametrize("name", sorted(PEAKS))
def test_the_bound_is_a_theorem_and_tight(name, fade) -> None:
    # By symmetry the places 0 <= x <= y <= z <= 1/2 are all. Each corner has its best
    # gradient; a box is bounded by its middle and the steepest slope inside it.
    rows, n = ROWS[name], ROWS[name].shape[1]
    ends = list(itertools.product((0, 1), repeat=n))
    length = np.linalg.norm(rows[0])
    peak = PEAKS[name][fade]
    assert np.linalg.norm(rows, axis=1) == pytest.approx(length), "of one length"

    def best(at: np.ndarray) -> np.ndarray:
        weights = [
            np.where(end, fade_of(fade, at), 1 - fade_of(fade, at)) for end in ends
        ]
        dots = [((at - end) @ rows.T).max(axis=1) for end in ends]
        return sum(w.prod(axis=1) * d for w, d in zip(weights, dots, strict=True))

    def upper(middles: np.ndarray, side: float) -> np.ndarray:
        # Moving by delta along an axis changes each dot by |g| delta at most, and its
        # weights, which come and go in pairs, by the fade's change times the dots'
        # difference, at most |g| times the distance between the two corners, 1.
        low = fade_of(fade, np.clip(middles - side / 2, 0, 1))
        high = fade_of(fade, np.clip(middles + side / 2, 0, 1))
        mid = fade_of(fade, middles)
        reach = np.maximum(high - mid, mid - low).sum(axis=1)
        return best(middles) + length * (reach + side / 2 * math.sqrt(n))

    side = 1 / 32
    lows = boxes(np.zeros(n), np.full(n, 0.5), side)
    lows = lows[(np.diff(lows, axis=1) >= -side / 2).all(axis=1)]
    margin = 1.0 + 1e-3 if PEAKS[name][fade] in (1.0, 1.5) or n == 2 else 1.0
    assert not exceeds(peak * margin, upper, lows, side)
    assert best(lows + side).max() > 0.98 * peak, "no loose bound"


def test_search_comes_close_to_the_bound_and_never_passes_it() -> None:
    line = np.arange(160) / 4 + 0.5
    largest = max(
        np.abs(gradient_grid(line, line, line[:80], seed=seed, fade=fade)).max()
        for seed in range(3)
        for fade in ("quintic", "hermite")
    )
    assert 0.85 < largest <= 1.0
    plane = np.abs(gradient_grid(np.arange(600) + 0.5, np.arange(600) + 0.5))
    assert plane.max() == pytest.approx(1.0, abs=1e-15), "the diagonals reach it"


@given(dimensions, st.data())
def test_zero_at_lattice_points(n: int, data) -> None:
    cells = st.tuples(*[st.integers(-(2**40), 2**40).map(float)] * n)
    cell, how = np.array(data.draw(cells)), data.draw(ways(n))
    assert gradient(cell, **how) == 0.0
    assert np.all(gradient_grid(*cell[:, None], **how) == 0.0)
    noise, slope = gradient_derivative(cell, **how)
    assert noise == 0.0
    # The slope there is the lattice point's own gradient.
    name = how["gradients"] or SETS[n][0]
    distance = np.abs(
        slope * PEAKS[name][how["fade"]] - gradient_set(name, dimensions=n)
    )
    assert distance.max(axis=1).min() < SAME


@pytest.mark.parametrize("fade", ["quintic", "hermite"])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_derivative_against_differences(n: int, fade) -> None:
    at, step = hashed_places(300, n), 2.0**-18
    _, slope = gradient_derivative(at, seed=3, fade=fade)
    for k, unit in enumerate(np.eye(n)):
        ahead, behind = (
            gradient(at + s * unit, seed=3, fade=fade) for s in (step, -step)
        )
        # Third derivatives stay below 200: step^2 * 200 / 6, and rounding.
        error = np.abs((ahead - behind) / (2 * step) - slope[:, k])
        assert np.median(error) < 40 * step**2 + 1e-10
        assert error.max() < 40 * step, "samples on both sides of a face"


@given(at_points, st.data())
def test_derivative_brings_the_noise_along(n: int, data) -> None:
    at, how = np.array(data.draw(places(n))), data.draw(ways(n))
    noise, _ = gradient_derivative(at, **how)
    np.testing.assert_allclose(noise, gradient(at, **how), rtol=0, atol=SAME)


@pytest.mark.parametrize("n", [2, 3, 4])
def test_faces_are_c1_for_hermite_and_c2_for_quintic(n: int) -> None:
    at = np.repeat(hashed_places(200, n)[:, None], 4, axis=1)
    step = 2.0**-16
    at[..., 0] = np.floor(at[..., 0]) + step * np.array([-2, -1, 1, 2])
    for fade in ("quintic", "hermite"):
        noise, slope = gradient_derivative(at, seed=8, fade=fade)
        assert np.abs(np.diff(noise, axis=1)).max() < 8 * step
        assert np.abs(np.diff(slope, axis=1)).max() < 40 * step
        curvature = np.diff(slope, axis=1)[:, ::2] / step
        gap = np.abs(curvature[:, 1] - curvature[:, 0])[:, 0].max()
        # The quintic's third derivative stays below 200 over four steps.
        assert (gap < 200 * 4 * step) == (fade == "quintic")
        assert fade == "quintic" or gap > 1.0


@settings(max_examples=60)
@given(dimensions, st.integers(1, 9), st.data())
def test_the_pattern_repeats_after_its_period_exactly(
    n: int, period: int, data
) -> None:
    eighths = data.draw(st.tuples(*[st.integers(-(2**12), 2**12)] * n))
    how = data.draw(ways(n)) | {"period": period}
    at = np.array(eighths) / 8.0
    moved = at + period * np.array(data.draw(st.permutations([3, -1, 0][:n])))
    assert gradient(moved, **how) == gradient(at, **how)
    here, there = (gradient_grid(*c[:, None], **how) for c in (at, moved))
    assert here == there


def test_in_four_dimensions_it_repeats_too() -> None:
    at = np.floor(hashed_places(200, 4) * 8) / 8
    moved = at + 5 * np.array([3, -1, 0, 2])
    np.testing.assert_array_equal(gradient(moved, period=5), gradient(at, period=5))
    assert np.abs(gradient(moved) - gradient(at)).max() > 0.1


def test_without_a_period_it_repeats_after_2_to_32_and_the_table_after_256() -> None:
    at = np.floor(hashed_places(50, 3) * 8) / 8
    assert np.all(gradient(at + 2.0**32) == gradient(at))
    assert np.all(gradient(at + 256, hash="table") == gradient(at, hash="table"))
    assert np.abs(gradient(at + 256) - gradient(at)).max() > 0.1


@given(st.permutations(range(3)), st.sampled_from(SETS[3] + SETS[2]))
def test_gradient_sets_are_symmetric(order, name) -> None:
    rows = ROWS[name]
    same = {tuple(np.round(row, 9) + 0.0) for row in rows}
    turned = [k for k in order if k < rows.shape[1]]
    assert {tuple(np.round(row, 9) + 0.0) for row in rows[:, turned]} == same
    assert {tuple(np.round(-row, 9) + 0.0) for row in rows} == same
    # Their mean outer product is a multiple of the unit matrix: no axis is preferred.
    spread = rows.T @ rows / len(rows)
    np.testing.assert_allclose(spread, spread[0, 0] * np.eye(len(spread)), atol=1e-15)


@pytest.mark.parametrize("n", [2, 3])
def test_no_axis_is_preferred_in_the_noise(n: int) -> None:
    _, slope = gradient_derivative(hashed_places(40_000, n, size=4000.0), seed=4)
    moments = slope.T @ slope / len(slope)
    # Independent cells: a mean of squares below 4 / 1.047^2 errs by 5 standard errors,
    # whose square is the fourth moment over the count.
    errors = 5 * np.sqrt(np.einsum("pi,pj->ij", slope**2, slope**2) / len(slope) ** 2)
    assert np.all(np.abs(moments - np.eye(n) * np.trace(moments) / n) < 2 * errors)


@settings(max_examples=25)
@given(at_points, st.data(), st.integers(1, 5))
def test_chunks_do_not_show(n: int, data, chunk: int) -> None:
    at, how = np.array(data.draw(places(n, 9))), data.draw(ways(n))
    whole = gradient(at, **how)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module("scattered"), "CHUNK", chunk)
        np.testing.assert_array_equal(gradient(at, **how), whole)


@settings(max_examples=25)
@given(dimensions, st.data(), st.integers(1, 5))
def test_parts_and_tiles_of_a_grid_do_not_show(n: int, data, tile: int) -> None:
    line = st.lists(coordinates, max_size=7)
    lines, how = [data.draw(line) for _ in range(n)], data.draw(ways(n))
    whole = gradient_grid(*lines, **how)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module("gradient_grid"), "MOST_BLENDED", 50)
        patch.setattr(module("bands"), "TILE", tile)
        patch.setattr(products, "ONE_THREAD", 20)
        parts = gradient_grid(*lines, **how)
    np.testing.assert_allclose(parts, whole, rtol=0, atol=SAME)


@given(st.lists(st.tuples(*[coordinates | st.just(math.nan) | st.just(-math.inf)] * 3)))
def test_not_finite_points_give_nan_and_spoil_no_other(rows) -> None:
    at = np.array(rows, dtype=np.float64).reshape(-1, 3)
    finite = np.isfinite(at).all(axis=1)
    noise, slope = gradient_derivative(at)
    assert np.array_equal(np.isnan(noise), ~finite)
    assert np.array_equal(np.isnan(slope).all(axis=1), ~finite)
    np.testing.assert_array_equal(gradient(at)[finite], gradient(at[finite]))


@given(seeds, hashes)
def test_bits_are_even_and_free_of_steps(seed: int, hash) -> None:
    x = np.arange(64)
    bits = lattice_bits(x, x[:, None], x[:, None, None], seed=seed, hash=hash)
    pick = module("mixing")._choice(bits, 12)
    share = np.bincount(pick.ravel(), minlength=12) / pick.size
    # 2^18 draws of 1/12: 6 standard errors. The table has 21 or 22 entries for each
    # gradient, and 64 places of an axis see but a part of them.
    assert np.abs(share - 1 / 12).max() < 6 * math.sqrt(1 / 12 / pick.size) + (
        0.01 if hash == "table" else 0.0
    )
    if hash == "mixed":
        for step in itertools.product((0, 1), repeat=3):
            if any(step):
                moved = pick[tuple(slice(s, None) for s in step)]
                still = pick[tuple(slice(None, 64 - s) for s in step)]
                assert abs(np.mean(moved == still) - 1 / 12) < 0.004  # 6 errors


@given(seeds, fades)
def test_seeds_are_hashed_and_not_added(seed: int, fade) -> None:
    x = np.linspace(0.1, 31.9, 60)
    here = gradient_grid(x, x, seed=seed, fade=fade)
    other = gradient_grid(x, x, seed=seed ^ 1, fade=fade)
    # Two patterns of 32 x 32 cells: a correlation of 1/32 is one standard error.
    assert abs(np.corrcoef(here.ravel(), other.ravel())[0, 1]) < 6 / 32


def test_bad_arguments_are_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"^points: expected .*\(\.\.\., 2\) or"):
        gradient(np.zeros((4, 5)))
    with pytest.raises(ValueError, match=r"^gradients: expected a set for 3"):
        gradient(np.zeros((4, 3)), gradients="directions8")
    with pytest.raises(ValueError, match=r"^period: expected a whole number"):
        gradient_grid([0.0], [0.0], period=0)
    for bad in (math.nan, math.inf):
        with pytest.raises(ValueError, match=r"^y: expected finite numbers"):
            gradient_grid([0.0], [1.0, bad], [0.0])
