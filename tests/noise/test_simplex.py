"""Simplex noise: range by theorem, E30, derivative, symmetry, chunks, any place."""

from __future__ import annotations

import importlib
import itertools
import math

import numpy as np
import pytest
from enclosing import boxes, exceeds
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.noise import coordinates
from twins.simplex import places, ways

from refcloud.noise import simplex, simplex_derivative, simplex_grid, uniform
from refcloud.noise.directions import SETS, USUAL

SAME = 1e-12  # the contract
SINGLE = 5e-6  # float32: worst seen 5e-7, times 10

dimensions = st.integers(2, 4)
RADII = ("continuous", "usual")


def module(name: str):
    """Give a module of the room, whose name may be that of a function too."""
    return importlib.import_module(f"refcloud.noise.{name}")


def hashed_places(count: int, width: int, seed: int = 0, size: float = 40.0):
    """Give places scattered over a cube around 0."""
    return size * (
        uniform(np.arange(count)[:, None], np.arange(width), seed=seed) - 0.5
    )


def corner_places(n: int) -> np.ndarray:
    """Give the corners of the simplex that steps along the axes in their order."""
    _, G = module("simplex")._skews(n)
    steps = np.tri(n + 1, n, -1)
    return steps - G * steps.sum(axis=1, keepdims=True)


@pytest.mark.parametrize("n", [2, 3, 4])
@pytest.mark.parametrize("radius", RADII)
def test_the_readable_form_is_the_same_noise(n: int, radius) -> None:
    at = hashed_places(1000, n)
    plain = module("simplex")._literal(at, 5, radius)
    noise = simplex(at, seed=5, radius=radius)
    assert np.abs(noise - plain).max() < SAME
    single = simplex(at, seed=5, radius=radius, dtype="float32")
    assert single.dtype == np.float32
    assert np.abs(single - plain).max() < SINGLE


@settings(max_examples=50)
@given(dimensions, ways, st.data())
def test_grid_equals_points(n: int, how, data) -> None:
    lines = data.draw(places(n, 3)).T
    mesh = np.stack(np.meshgrid(*lines[::-1], indexing="ij")[::-1], axis=-1)
    exact = simplex(mesh, **how)
    np.testing.assert_allclose(simplex_grid(*lines, **how), exact, rtol=0, atol=SAME)
    how |= {"dtype": "float32"}
    single = simplex_grid(*lines, **how)
    assert single.dtype == np.float32
    np.testing.assert_allclose(single, exact, rtol=0, atol=SINGLE)


@given(dimensions, ways, st.data())
def test_range_at_any_finite_place(n: int, how, data) -> None:
    row = st.tuples(*[coordinates] * n)
    at = np.array(data.draw(st.lists(row, min_size=1, max_size=5)))
    assert np.abs(simplex(at, **how)).max() <= 1.0
    assert np.abs(simplex_grid(*at[:1].T, **how)).max() <= 1.0


@pytest.mark.slow
@pytest.mark.parametrize("radius", RADII)
@pytest.mark.parametrize("n", [2, 3, 4])
def test_the_bound_is_a_theorem_and_close(n: int, radius) -> None:
    # All simplices are mirror images of one; each corner has its best gradient there.
    rows, ends = SETS[USUAL[n]], corner_places(n)
    squared = module("simplex").SQUARED[radius]
    peak = module("simplex").PEAKS[n, radius]
    inverse = np.linalg.inv((ends[1:] - ends[0]).T)
    steepness = np.linalg.norm(inverse, axis=1), np.linalg.norm(inverse.sum(axis=0))

    def upper(middles: np.ndarray, side: float) -> np.ndarray:
        # A kernel is largest where the box is nearest, a dot grows by |g| times the
        # half diagonal; boxes outside the simplex do not count.
        half = side / 2 * math.sqrt(n)
        share = middles @ inverse.T
        inside = (share >= -steepness[0] * half).all(axis=1)
        inside &= share.sum(axis=1) <= 1.0 + steepness[1] * half
        total = np.zeros(len(middles))
        for end in ends:
            d = middles - end
            near = np.maximum(np.abs(d) - side / 2, 0.0)
            kernel = np.maximum(squared - (near**2).sum(axis=1), 0.0) ** 4
            dot = (d @ rows.T).max(axis=1) + np.linalg.norm(rows[0]) * half
            total += kernel * dot
        return np.where(inside, total, 0.0)

    lows = boxes(ends.min(axis=0), ends.max(axis=0), 1 / 16)
    assert not exceeds(peak, upper, lows, 1 / 16)
    # Seen from inside: a search over the same places comes close to the bound.
    share = np.sort(uniform(np.arange(40_000)[:, None], np.arange(n), seed=1), axis=1)
    share = np.diff(share, axis=1, prepend=0.0)
    found = upper(ends[0] + share @ (ends[1:] - ends[0]), 0.0).max()
    assert 0.93 * peak < found < peak


@pytest.mark.parametrize("n", [2, 3, 4])
def test_search_comes_close_to_the_bound_and_never_passes_it(n: int) -> None:
    noise = simplex(hashed_places(60_000, n, size=500.0), seed=2)
    assert {2: 0.98, 3: 0.85, 4: 0.7}[n] < np.abs(noise).max() <= 1.0


def jump(n: int, radius) -> float:
    """Measure the largest step across faces between simplices, over 2e-9 of a unit."""
    ends = corner_places(n)
    worst = 0.0
    for left_out, one in itertools.product(range(n + 1), range(20)):
        kept = np.delete(ends, left_out, axis=0)
        share = uniform(one, np.arange(200)[:, None], np.arange(n), seed=left_out)
        share = share / share.sum(axis=1, keepdims=True)
        face = share @ kept
        span = kept[1:] - kept[0]
        normal = np.linalg.svd(span)[2][-1]
        above, below = (
            simplex(face + s * normal, seed=one, radius=radius) for s in (1e-9, -1e-9)
        )
        worst = max(worst, float(np.abs(above - below).max()))
    return worst


@pytest.mark.parametrize("n", [2, 3, 4])
def test_e30_the_usual_radius_jumps_and_the_continuous_one_does_not(n: int) -> None:
    # No slope exceeds 8 per unit: what is continuous changes by 2e-8 at most.
    assert jump(n, "continuous") < 2e-8
    assert 1e-3 < jump(n, "usual") < 0.03


def test_e30_a_face_lies_at_half_a_unit_squared() -> None:
    for n in (2, 3, 4):
        ends = corner_places(n)
        heights = []
        for k in range(n + 1):
            others = np.delete(ends, k, axis=0)
            span = (others[1:] - others[0]).T
            to = ends[k] - others[0]
            part = span @ np.linalg.lstsq(span, to, rcond=None)[0]
            heights.append(np.sum((to - part) ** 2))
        assert min(heights) == pytest.approx(0.5, rel=1e-12)
        edges = [np.linalg.norm(a - b) for a, b in itertools.combinations(ends, 2)]
        # A regular simplex in the plane alone.
        assert (max(edges) / min(edges) == pytest.approx(1.0)) == (n == 2)


@pytest.mark.parametrize("n", [2, 3, 4])
def test_derivative_against_differences(n: int) -> None:
    at, step = hashed_places(300, n), 2.0**-17
    noise, slope = simplex_derivative(at, seed=3)
    assert np.abs(noise - simplex(at, seed=3)).max() < SAME
    for k, unit in enumerate(np.eye(n)):
        ahead, behind = (simplex(at + s * unit, seed=3) for s in (step, -step))
        # Third derivatives stay below 2000: step^2 * 2000 / 6, and rounding.
        error = np.abs((ahead - behind) / (2 * step) - slope[:, k])
        assert error.max() < 400 * step**2 + 1e-9


@pytest.mark.parametrize("n", [2, 3, 4])
def test_slopes_are_continuous_across_all_faces(n: int) -> None:
    start, way = hashed_places(60, n), hashed_places(60, n, seed=3, size=1.0)
    t = np.arange(400)[:, None, None] * 2.0**-9
    _, slope = simplex_derivative(start + t * way, seed=6)
    # Curvature stays below 100 per unit squared.
    assert np.abs(np.diff(slope, axis=0)).max() < 100 * 2.0**-9 * math.sqrt(n) / 2


@pytest.mark.parametrize("n", [2, 3, 4])
def test_no_axis_is_preferred(n: int) -> None:
    _, slope = simplex_derivative(hashed_places(40_000, n, size=4000.0), seed=4)
    products = slope[:, :, None] * slope[:, None, :]
    # The mean of squares along each axis agrees within 6 standard errors.
    squares = np.diagonal(products, axis1=1, axis2=2)
    apart = squares - squares.mean(axis=1, keepdims=True)
    error = apart.std(axis=0) / math.sqrt(len(slope))
    assert np.all(np.abs(apart.mean(axis=0)) < 6 * error)


@given(st.permutations(range(3)), st.booleans())
def test_the_lattice_is_symmetric_under_the_order_of_axes(order, usual) -> None:
    # Same corners and kernels: the sum without gradients does not tell axes apart.
    at = hashed_places(50, 3)
    distances = []
    for columns in (at.T.copy(), at.T[order].copy()):
        radius = RADII[usual]
        corners = module("simplex")._corners(columns, 0, radius, "mixed", "float64")
        kernels = [kernel.copy() for _, _, kernel in corners]
        assert len(kernels) == 4
        distances.append(np.sort(kernels, axis=0))
    np.testing.assert_allclose(distances[0], distances[1], rtol=0, atol=SAME)


def test_space_repeats_after_three_times_2_to_32() -> None:
    at = np.floor(hashed_places(40, 3) * 64) / 64 + 1 / 256
    wrap = module("simplex").WRAP
    # float64 has steps of 2e-6 out there, and the noise slopes up to 8.
    near, far = (
        simplex(at + np.array([wrap / 2 + 1, 0, 0])),
        simplex(at - np.array([wrap / 2 - 1, 0, 0])),
    )
    assert np.abs(near - far).max() < 1e-4


@settings(max_examples=25)
@given(dimensions, ways, st.data(), st.integers(1, 5))
def test_chunks_do_not_show(n: int, how, data, chunk: int) -> None:
    at = data.draw(places(n, 9))
    whole = simplex(at, **how)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module("scattered"), "CHUNK", chunk)
        np.testing.assert_array_equal(simplex(at, **how), whole)
        lines = at[:2].T
        parts = simplex_grid(*lines, **how)
    np.testing.assert_array_equal(parts, simplex_grid(*lines, **how))


@given(st.lists(st.tuples(*[coordinates | st.just(math.nan) | st.just(-math.inf)] * 4)))
def test_not_finite_points_give_nan_and_spoil_no_other(rows) -> None:
    at = np.array(rows, dtype=np.float64).reshape(-1, 4)
    finite = np.isfinite(at).all(axis=1)
    noise, slope = simplex_derivative(at)
    assert np.array_equal(np.isnan(noise), ~finite)
    assert np.array_equal(np.isnan(slope).all(axis=1), ~finite)
    np.testing.assert_array_equal(simplex(at)[finite], simplex(at[finite]))


def test_zero_at_lattice_points_far_from_others_kernels() -> None:
    # Every other corner lies outside the continuous radius.
    for n in (2, 3, 4):
        noise = simplex(np.zeros(n))
        assert noise == 0.0
        assert np.abs(simplex(corner_places(n))).max() < SAME


def test_bad_arguments_are_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"^points: expected an array of shape"):
        simplex(np.zeros((4, 5)))
    with pytest.raises(ValueError, match=r"^radius: expected one of"):
        simplex(np.zeros(3), radius="0.6")
    with pytest.raises(ValueError, match=r"^z: expected a third axis"):
        simplex_grid([0.0], [0.0], w=[0.0])
    with pytest.raises(ValueError, match=r"^w: expected finite numbers"):
        simplex_grid([0.0], [0.0], [0.0], [math.nan])
