"""Phases 1 and 2: clusters that cover their points, in any order, unit or place."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.metaballs import scattered, seeds

from refcloud.metaballs import adaptive_kmeans, depth, lloyd, rms_radii
from refcloud.metaballs.choices import spread_start, start_patterns, visits
from refcloud.metaballs.weights import voxel_weights

LATTICE = np.argwhere(np.ones((9, 9, 9))).astype(float)


def cost(points, clusters, weights=1.0) -> float:
    away = points - clusters.centers[clusters.assignment]
    return float((weights * (away**2).sum(axis=1)).sum())


def nearest(points, centers) -> np.ndarray:
    return ((points[:, None] - centers) ** 2).sum(axis=2)


@settings(max_examples=40)
@given(seed=seeds, total=st.integers(1, 30), count=st.integers(1, 40))
@pytest.mark.parametrize("method", ["shuffled", "raster", "lloyd"])
def test_e18_no_cluster_is_empty_and_each_point_has_the_nearest(
    method, seed, total, count
):
    points = scattered(seed, total)
    if method == "lloyd":
        found = lloyd(points, np.ones(total), count, seed=seed)
    else:
        found = adaptive_kmeans(points, count, seed=seed, order=method, most_epochs=2)
    assert 1 <= len(found.centers) <= min(total, count)
    used = np.bincount(found.assignment, minlength=len(found.centers))
    assert used.min() >= 1
    squares = nearest(points, found.centers)
    own = np.take_along_axis(squares, found.assignment[:, None], axis=1)[:, 0]
    # Distances are compared in float32 of a cloud of size 4.
    assert np.all(own <= squares.min(axis=1) + 1e-5)


def test_e18_visits_count_from_one():
    # The first visit moves a centre all the way (1/sqrt(1)), the second 1/sqrt(2).
    points = np.array([[0.0, 0, 0], [1.0, 0, 0], [5.0, 0, 0]])
    order = visits(3, 0, 0, "raster")
    assert order.tolist() == [0, 1, 2]
    found = adaptive_kmeans(points, 1, order="raster", most_epochs=1)
    after_two = 0.0 + 1.0 / np.sqrt(2)
    expected = after_two + (5.0 - after_two) / np.sqrt(3)
    assert found.centers[0, 0] == pytest.approx(expected, abs=1e-14)


def test_e18_patterns_are_never_drawn_twice():
    assert len(set(start_patterns(50, 50, 3).tolist())) == 50
    assert len(start_patterns(5, 9, 3)) == 5


def test_e18_a_cluster_of_one_voxel_has_a_radius():
    sigma = rms_radii([[3.0, 1, 2]], np.array([0]), centers=[[3.0, 1, 2]], spacing=0.5)
    assert sigma.tolist() == [0.25]


def test_e18_the_own_spread_is_that_of_a_cube():
    # Voxels of edge 1 as 8^3 points each: the same spread as points with h = 1/8.
    inner = (np.argwhere(np.ones((8, 8, 8))) - 3.5) / 8.0
    voxels = np.array([[0.0, 0, 0], [1.0, 0, 0], [0.0, 2, 0]])
    fine = (voxels[:, None] + inner).reshape(-1, 3)
    center = voxels.mean(axis=0, keepdims=True)
    coarse = rms_radii(voxels, np.zeros(3, int), centers=center, spacing=1.0)
    exact = rms_radii(fine, np.zeros(len(fine), int), centers=center, spacing=1 / 8)
    assert coarse[0] == pytest.approx(exact[0], rel=1e-12)


def test_e18_raster_order_chases_the_sweep():
    even = lloyd(LATTICE, np.ones(len(LATTICE)), 12)
    shuffled = adaptive_kmeans(LATTICE, 12, order="shuffled")
    raster = adaptive_kmeans(LATTICE, 12, order="raster")
    # Of 20 seeds the worst shuffled is 1.009, the best raster 1.74.
    assert cost(LATTICE, shuffled) < 1.05 * cost(LATTICE, even)
    assert cost(LATTICE, raster) > 1.5 * cost(LATTICE, even)


def test_learning_ends_at_the_minimal_rate():
    # 729 points and 1 centre: 27 and 38 times 1/sqrt(n), below 0.05 after one epoch.
    assert adaptive_kmeans(LATTICE, 1).epochs == 1
    assert adaptive_kmeans(LATTICE, 300, most_epochs=3).epochs == 3


@pytest.mark.parametrize("offset", [0.0, 1e6])
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_neither_place_nor_unit_shows(offset, scale):
    # Rounding breaks ties of the lattice: worst of 20 seeds 0.977 and 1.036.
    weights = np.ones(len(LATTICE))
    here = lloyd(LATTICE, weights, 20)
    there = lloyd(LATTICE * scale + offset, weights, 20)
    ratio = cost(LATTICE * scale + offset, there) / (cost(LATTICE, here) * scale**2)
    assert ratio == pytest.approx(1.0, abs=0.1)


@given(seed=seeds)
@settings(max_examples=20)
def test_more_rounds_never_cost_more(seed):
    points = scattered(seed, 60)
    weights = 0.1 + scattered(seed, 60, word=1)[:, 0]
    costs = [
        cost(points, lloyd(points, weights, 5, seed=seed, rounds=n), weights)
        for n in range(6)
    ]
    # Assignments compare in float32: 1e-6 of the cost.
    assert all(b <= a * (1.0 + 1e-6) for a, b in pairwise(costs))


@given(seed=seeds)
@settings(max_examples=10)
def test_rounds_end_where_no_point_changes_its_centre(seed):
    points = scattered(seed, 60)
    weights = 0.1 + scattered(seed, 60, word=1)[:, 0]
    end = lloyd(points, weights, 5, seed=seed, rounds=10_000)
    assert end.epochs < 40  # worst of 1000 seeds: 13
    again = lloyd(points, weights, 5, seed=seed, rounds=end.epochs)
    assert again.centers.tobytes() == end.centers.tobytes()
    assert again.assignment.tobytes() == end.assignment.tobytes()


def test_heavy_points_draw_the_centres():
    weights = np.where(LATTICE[:, 0] < 4, 100.0, 1.0)
    found = lloyd(LATTICE, weights, 20)
    assert (found.centers[:, 0] < 4).sum() > 12


def test_points_without_weight_get_no_centre_of_their_own():
    points = np.array([[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0]])
    found = lloyd(points, np.array([1.0, 0.0, 1.0]), 3)
    assert sorted(found.centers[:, 0].tolist()) == pytest.approx([0.0, 2.0], abs=1e-15)
    assert len(lloyd(points, np.zeros(3), 2).centers) == 0


def test_equal_points_are_one_centre():
    points = np.repeat([[0.1, 0.2, 0.3], [5.0, 0.0, 0.0]], 7, axis=0)
    assert len(spread_start(points, np.ones(14), 10, 0)) == 2
    assert len(lloyd(points, np.ones(14), 10).centers) == 2
    assert len(lloyd(np.zeros((0, 3)), np.zeros(0), 4).centers) == 0
    assert len(adaptive_kmeans(np.zeros((0, 3)), 4).centers) == 0


@pytest.mark.parametrize("count", [1, 7, 100])
def test_same_seed_same_bits(count):
    weights = np.ones(len(LATTICE))
    for seed in (0, 5):
        bits = [
            lloyd(LATTICE, weights, count, seed=seed).centers.tobytes() for _ in "ab"
        ]
        assert bits[0] == bits[1]
    other = lloyd(LATTICE, weights, count, seed=1).centers.tobytes()
    assert count == 1 or other != bits[0]


def test_depth_ends_at_the_most():
    full = np.ones((9, 9, 9))
    assert depth(full, [1.0, 1.0, 1.0])[4, 4, 4] == 5.0
    assert depth(full, [1.0, 1.0, 1.0], most=3.0).max() == 3.0
    assert not depth(np.zeros((2, 2, 2)), [1.0, 1.0, 1.0]).any()


def test_voxels_at_the_rim_weigh_more():
    density = np.pad(np.ones((7, 7, 7)), 1)
    weights = voxel_weights(density, np.ones(3), 6.0, 1.5).reshape(7, 7, 7)
    assert weights[0, 3, 3] == pytest.approx(1.2 * (1 + 6 * np.exp(-1 / 1.5)))
    assert weights[3, 3, 3] < weights[1, 3, 3] < weights[0, 3, 3]
    assert np.all(voxel_weights(density, np.ones(3), 0.0, 1.5) == 1.0)
    density[4, 4, 4] = 0.25
    plain = voxel_weights(density, np.ones(3), 0.0, 1.5).reshape(7, 7, 7)
    assert plain[3, 3, 3] == 0.25**1.5
