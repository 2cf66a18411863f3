"""A tolerance in place of a count: what is reached, and what was tried and missed."""

from __future__ import annotations

import contextlib
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.metaballs import seeds

from refcloud.cloudmap.voxels import VoxelGrid
from refcloud.metaballs import approximate, errors_of_fit
from refcloud.metaballs.fewest import fewest
from refcloud.noise.hashing import uniform


@pytest.mark.parametrize("method", ["quick", "standard", "full"])
def test_the_tolerance_is_reached_and_one_ball_fewer_missed_it(cloud, method):
    grid, tried = cloud(), {}

    def watch(name, balls):
        if found := re.fullmatch(r"tried (\d+) balls, relative RMSE (\S+)", name):
            tried[int(found[1])] = errors_of_fit(grid, balls).density
            assert float(found[2]) == pytest.approx(tried[int(found[1])], abs=1e-4)

    balls = approximate(grid, tolerance=0.4, method=method, observe=watch)
    error = errors_of_fit(grid, balls).density
    assert error <= 0.4
    count = next(n for n, e in tried.items() if e == error)
    assert tried[count - 1] > 0.4
    same = approximate(grid, count=count, method=method)
    assert same.densities.tobytes() == balls.densities.tobytes()


def test_smaller_tolerances_take_more_balls(cloud):
    counts = [len(approximate(cloud(), tolerance=t)) for t in (0.9, 0.6, 0.4)]
    assert counts == sorted(counts)
    assert counts[0] < counts[-1]


@settings(max_examples=100)
@given(
    seed=seeds,
    most=st.integers(1, 5000),
    power=st.floats(0.1, 2.0),
    tolerance=st.floats(0.01, 0.99),
    noise=st.floats(0.0, 0.2),
)
def test_the_search_ends_at_a_count_whose_smaller_neighbour_fails(
    seed, most, power, tolerance, noise
):
    def error(n: int) -> float:
        chance = float(uniform(n, seed=seed))
        return n**-power * (1.0 + noise * (chance - 0.5))

    tried: list[int] = []

    def attempt(n: int) -> tuple[float, int]:
        tried.append(n)
        return error(n), n

    if error(most) > tolerance:
        # It ends at the largest count, or at one that chance lets pass before.
        with contextlib.suppress(ValueError):
            count = fewest(attempt, tolerance, most)
        if tried[-1] == most:
            return
    else:
        count = fewest(attempt, tolerance, most)
    assert error(count) <= tolerance
    assert count == 1 or (count - 1 in tried and error(count - 1) > tolerance)
    assert len(tried) == len(set(tried)) <= 40, "no count is tried twice, and few are"


def test_what_balls_cannot_reach_is_refused_with_the_figure():
    sheet = VoxelGrid(np.pad(np.ones((1, 5, 5)), 2), [0, 0, 0], [9, 9, 5])
    with pytest.raises(ValueError, match=r"tolerance: .* can reach, here 0\.\d+ with"):
        approximate(sheet, tolerance=0.01)
    empty = VoxelGrid(np.zeros((2, 2, 2)), [0, 0, 0], [1, 1, 1])
    assert len(approximate(empty, tolerance=0.1)) == 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"count": 5, "tolerance": 0.5}, "tolerance: expected none beside a count"),
        ({"tolerance": 0.0}, r"tolerance: expected a finite number in \(0, 1\)"),
        ({"tolerance": 1.0}, r"tolerance: expected a finite number in \(0, 1\)"),
    ],
)
def test_a_count_or_a_tolerance_and_no_other(cloud, arguments, message):
    with pytest.raises(ValueError, match=message):
        approximate(cloud(), **arguments)
