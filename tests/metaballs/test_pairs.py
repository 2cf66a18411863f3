"""The sparse form of the fit: equal to the dense one; its steps follow the slope."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.metaballs import kernels, scattered, seeds

from refcloud.cloudmap.voxels import VoxelGrid
from refcloud.metaballs import approximate, errors_of_fit, profile
from refcloud.metaballs.pairs import Pairs, Work, list_pairs, prepare
from refcloud.metaballs.refine import Fit, _jacobian, _solve, listed, refine
from refcloud.noise.hashing import uniform

edges_drawn = st.sampled_from([(1.0, 1.0, 1.0), (0.5, 2.0, 1.0), (2.0, 2.0, 0.25)])


def make_work(seed: int, edges=(1.0, 1.0, 1.0)) -> Work:
    density = uniform(np.arange(60), seed=seed).reshape(3, 4, 5)
    density[density < 0.3] = 0.0
    density[0, 0, 0] = density[-1, -1, -1] = 1.0
    grid = VoxelGrid(density, [0, 0, 0], np.array([5, 4, 3]) * edges)
    work = prepare(grid)
    assert work is not None
    return work


def make_fit(seed: int, count: int) -> Fit:
    radii = 0.3 + 2.5 * uniform(2, np.arange(count), seed=seed)
    heights = 0.1 + uniform(3, np.arange(count), seed=seed)
    return Fit(scattered(seed, count), radii, heights)


def dense(work: Work, pairs: Pairs, fit: Fit, kernel: str) -> np.ndarray:
    """Give the kernel of every ball at every voxel of the box, (voxels, N)."""
    low = np.floor((fit.centers - fit.radii[:, None]) / work.edges).min(axis=0)
    high = np.ceil((fit.centers + fit.radii[:, None]) / work.edges).max(axis=0)
    low = np.minimum(low, 0)
    high = np.maximum(high, np.array(work.density.shape[::-1]) - 1)
    z, y, x = np.meshgrid(
        *(np.arange(low[i], high[i] + 1) for i in (2, 1, 0)), indexing="ij"
    )
    voxels = np.stack([x, y, z], axis=-1).reshape(-1, 3) * work.edges
    assert len(voxels) == len(pairs.target)
    squares = ((voxels[:, None] - fit.centers) ** 2).sum(axis=2)
    return profile(squares / fit.radii**2, kernel)


@settings(max_examples=50)
@given(seed=seeds, count=st.integers(1, 6), edges=edges_drawn, kernel=kernels)
def test_pairs_are_the_entries_of_the_dense_design(seed, count, edges, kernel):
    work, fit = make_work(seed, edges), make_fit(seed, count)
    pairs = list_pairs(work, fit.centers, fit.radii, kernel)
    design = dense(work, pairs, fit, kernel)
    v = fit.heights
    residual = uniform(4, np.arange(len(pairs.target)), seed=seed)
    # Sums of a few hundred numbers below 2: 1e-12 is 100 times their rounding.
    np.testing.assert_allclose(pairs.forward(v), design @ v, atol=1e-12)
    np.testing.assert_allclose(
        pairs.backward(residual), design.T @ residual, atol=1e-12
    )
    assert pairs.target.sum() == pytest.approx(work.density.sum(), rel=1e-13)


@given(seed=seeds)
def test_forward_and_backward_are_transposes(seed):
    work, fit = make_work(seed), make_fit(seed, 5)
    pairs = list_pairs(work, fit.centers, fit.radii, "wyvill")
    r = uniform(5, np.arange(len(pairs.target)), seed=seed)
    left = float(pairs.forward(fit.heights) @ r)
    assert left == pytest.approx(float(fit.heights @ pairs.backward(r)), rel=1e-12)


def test_a_ball_between_voxels_has_no_pairs():
    work = make_work(0)
    centers = np.array([[0.5, 0.5, 0.5], [1.0, 1.0, 1.0]])
    pairs = list_pairs(work, centers, np.array([0.1, 0.1]), "wyvill")
    assert pairs.owners.tolist() == [1]
    assert pairs.by_ball(pairs.value).tolist() == [0.0, 1.0]
    nothing = list_pairs(work, centers[:1], np.array([0.1]), "wyvill")
    assert not nothing.forward(np.ones(1)).any()
    assert nothing.backward(nothing.target).tolist() == [0.0]


@pytest.mark.parametrize("edges", [(1.0, 1.0, 1.0), (0.5, 2.0, 1.0), (4.0, 0.5, 0.5)])
def test_voxels_on_the_rim_are_no_pairs(edges):
    # Sums of halves are exact: q is 1 on the rim, and not a rounding below.
    work = replace(make_work(0), edges=np.array(edges))
    centers, radii = np.array([[2.0, 2.0, 1.0], [0.5, 1.0, 2.0]]), np.array([2.0, 1.5])
    pairs = list_pairs(work, centers, radii, "gaussian")
    away = np.stack(
        np.meshgrid(*(edge * np.arange(-9.0, 10) for edge in edges), indexing="ij"), -1
    )
    inside = [
        np.square(away - center).sum(axis=-1) < radius**2
        for center, radius in zip(centers, radii, strict=True)
    ]
    rim = [
        np.square(away - center).sum(axis=-1) == radius**2
        for center, radius in zip(centers, radii, strict=True)
    ]
    assert np.any(rim)
    every = np.bincount(pairs.ball, minlength=2)
    assert every.tolist() == [int(each.sum()) for each in inside]
    assert pairs.q.max() < 1.0
    first = pairs.away[:, pairs.ball == 0].T + centers[0]
    assert sorted(first.tolist()) == sorted(away[inside[0]].tolist())


@pytest.mark.parametrize("longest", [0, 1, 2])
def test_needles_and_sheets_list_hardly_more_rows_than_voxels(longest, monkeypatch):
    # Cells 1e4 times longer than wide: a ball of radius 2 reaches 1e5 of them.
    edges = np.full(3, 1e4 ** (-1 / 3))
    edges[longest] = 1e4 ** (2 / 3)
    work = replace(make_work(0), edges=edges)
    listed_at: list[int] = []
    repeat = np.repeat

    def counted(values, counts, axis=None):
        listed_at.append(np.shape(values)[-1])
        return repeat(values, counts, axis)

    monkeypatch.setattr("refcloud.metaballs.pairs.np.repeat", counted)
    pairs = list_pairs(work, np.zeros((1, 3)), np.array([2.0]), "wyvill")
    # One slice, and across it a disc of pi R^2 over the area of a small side.
    assert len(pairs.q) == pytest.approx(4.0 * np.pi * 1e4 ** (2 / 3), rel=0.02)
    assert max(listed_at) < 100


def test_cells_are_scaled_by_their_geometric_mean():
    work = make_work(3, (0.5, 2.0, 1.0))
    assert work.edge == pytest.approx(1.0, rel=1e-15)
    assert work.edges == pytest.approx([0.5, 2.0, 1.0], rel=1e-15)
    assert prepare(VoxelGrid(np.zeros((2, 2, 2)), [0, 0, 0], [1, 1, 1])) is None


def test_edges_equal_but_for_rounding_count_as_equal():
    lower = np.array([1e6, -1e6, 3e5])
    upper = lower + np.array([5e-3, 4e-3, 3e-3])
    work = prepare(VoxelGrid(np.ones((3, 4, 5)), lower, upper))
    assert work is not None
    assert work.edges.tolist() == [1.0, 1.0, 1.0]


@settings(max_examples=30)
@given(seed=seeds, kernel=kernels)
def test_the_jacobian_is_the_derivative_of_the_field(seed, kernel):
    work, fit = make_work(seed), make_fit(seed, 3)
    pairs = list_pairs(work, fit.centers, fit.radii, kernel)
    jacobian = _jacobian(pairs, fit, kernel)
    gradient = pairs.by_ball(jacobian)  # of the sum over all pairs, (5, N)
    step = 1e-6

    def total(ball: int, column: int, sign: float) -> float:
        """Sum the field over the listed pairs, so that none enters or leaves."""
        own = pairs.ball == ball
        away, R, v = pairs.away[:, own].copy(), fit.radii[ball], fit.heights[ball]
        if column < 3:
            away[column] -= sign * step
        elif column == 3:
            R = R * np.exp(sign * step)
        else:
            v = v + sign * step
        return float(v * profile((away**2).sum(axis=0) / R**2, kernel).sum())

    inside = pairs.q < 1.0 - 1e-3  # farther from the rim than a step reaches
    for ball in range(3):
        if not np.all(inside[pairs.ball == ball]):
            continue
        for column in range(5):
            ends = [total(ball, column, sign) for sign in (1.0, -1.0)]
            slope = (ends[0] - ends[1]) / (2 * step)
            # f''' h^2 / 6 is 1e-10; rounding of sums below 200 over 2e-6 is 1e-8.
            assert gradient[column, ball] == pytest.approx(slope, rel=1e-6, abs=1e-6)


@settings(max_examples=20)
@given(seed=seeds, kernel=kernels)
def test_a_step_goes_downhill(seed, kernel):
    work, fit = make_work(seed), make_fit(seed, 4)
    pairs = list_pairs(work, fit.centers, fit.radii, kernel)
    residual = pairs.target - pairs.forward(fit.heights)
    jacobian = _jacobian(pairs, fit, kernel)
    uphill = pairs.by_ball(jacobian * residual[pairs.voxel])  # -gradient of H / 2
    step = _solve(pairs, jacobian, residual, 0.1)
    assert float((uphill * step).sum()) >= 0.0


@settings(max_examples=20)
@given(seed=seeds, kernel=kernels)
def test_steps_never_raise_the_error_and_keep_the_bounds(seed, kernel):
    work, fit = make_work(seed), make_fit(seed, 4)
    costs: list[float] = []

    def watch(number: int, now: Fit) -> None:
        pairs = list_pairs(work, now.centers, now.radii, kernel)
        left = pairs.target - pairs.forward(now.heights)
        costs.append(float(left @ left))
        assert now.heights.min() >= 0.0
        if number and len(set(costs)) > 1:
            assert now.radii.min() >= 0.7

    watch(0, fit)
    state = listed(work, fit, kernel)
    end = refine(work, state, kernel, steps=6, least_radius=0.7, observe=watch)
    assert end.cost == pytest.approx(costs[-1], rel=1e-12)
    assert all(b <= a for a, b in pairwise(costs))


@settings(max_examples=20)
@given(seed=seeds, kernel=kernels, damping=st.sampled_from([1e-6, 0.1, 1e3, 1e9, 1e17]))
def test_damping_bounds_what_a_step_gains(seed, kernel, damping):
    """The bound that ends the steps: a fall of at most 10 N |r|^2 / mu."""
    work, fit = make_work(seed), make_fit(seed, 4)
    state = listed(work, fit, kernel)
    pairs, residual = state.pairs, state.residual
    jacobian = _jacobian(pairs, fit, kernel)
    step = _solve(pairs, jacobian, residual, damping)
    image = pairs.by_voxel(np.einsum("ip,ip->p", jacobian, pairs.spread(step)))
    fall = 2.0 * float(residual @ image) - float(image @ image)
    assert fall <= 10.0 * 4 * state.cost / damping


@pytest.mark.parametrize("count", [1, 3])
def test_the_most_steps_end_where_none_lowers_the_cost(cloud, count: int) -> None:
    """Damping that grew on would overflow: numpy's warnings are errors here."""
    taken: list[str] = []
    grid = cloud()
    most = approximate(
        grid,
        count=count,
        refine_steps=10_000,
        observe=lambda name, _: taken.append(name),
    )
    assert len(taken) < 2_000
    few = approximate(grid, count=count, refine_steps=5)
    assert errors_of_fit(grid, most).density < errors_of_fit(grid, few).density
