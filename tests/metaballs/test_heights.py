"""Phase 3: the gradient and its stable limit (E19), and least squares from 0."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from twins.metaballs import overlapping, seeds

from refcloud.metaballs import (
    gradient_descent,
    largest_eigenvalue,
    non_negative_least_squares,
)
from refcloud.noise.hashing import uniform


def problem(seed: int, columns: int = 6, rows: int = 9):
    design = overlapping(seed, rows, columns)
    return design, uniform(5, np.arange(rows), seed=seed)


def error(design, y, v) -> float:
    return float(((y - design @ v) ** 2).sum())


@given(seed=seeds)
def test_e19_the_gradient_reaches_least_squares(seed):
    design, y = problem(seed, columns=3)
    best = np.linalg.lstsq(design, y)[0]
    found = gradient_descent(design, y, most_steps=1500)
    np.testing.assert_allclose(found, best, atol=1e-9)


@given(seed=seeds, share=st.floats(0.01, 0.99))
def test_e19_below_the_limit_the_error_falls(seed, share):
    design, y = problem(seed)
    limit = 1.0 / np.linalg.norm(design, 2) ** 2
    errors = [
        error(design, y, gradient_descent(design, y, rate=share * limit, most_steps=n))
        for n in range(5)
    ]
    # Near the best fit the fall is lost in rounding.
    assert all(b <= a * (1 + 1e-12) for a, b in pairwise(errors))


@given(seed=seeds, share=st.floats(1.001, 1e6))
def test_e19_at_the_limit_the_rate_is_refused_by_name(seed, share):
    design, y = problem(seed)
    rate = share / np.linalg.norm(design, 2) ** 2
    with pytest.raises(ValueError, match=r"rate: expected below the stable limit"):
        gradient_descent(design, y, rate=rate)


def test_e19_above_the_limit_the_error_would_grow():
    design = np.array([[1.0], [1.0]])
    y, rate = np.array([1.0, 1.0]), 1.01 / 2.0
    v, errors = 0.0, []
    for _ in range(50):
        v += 2.0 * rate * float(design[:, 0] @ (y - design[:, 0] * v))
        errors.append(error(design, y, np.array([v])))
    assert errors[-1] > errors[0]
    assert largest_eigenvalue(design.T @ design) == pytest.approx(2.0)


@given(seed=seeds)
def test_e19_the_gradient_of_the_error_is_minus_two_residuals(seed):
    design, y = problem(seed)
    v = uniform(6, np.arange(6), seed=seed)
    slope = -2.0 * design.T @ (y - design @ v)
    for k, step in enumerate(1e-5 * np.eye(6)):
        ends = [error(design, y, v + sign * step) for sign in (1, -1)]
        # Quadratic: only rounding of H, below 100, over 2e-5 is left.
        assert slope[k] == pytest.approx((ends[0] - ends[1]) / 2e-5, abs=1e-7)


@given(seed=seeds)
def test_learning_ends_at_the_limit_of_the_error(seed):
    design, y = problem(seed)
    first = gradient_descent(design, y, most_steps=1)
    limit = error(design, y, first) * (1 + 1e-9)
    np.testing.assert_array_equal(gradient_descent(design, y, limit=limit), first)
    assert not gradient_descent(design, y, limit=float(y @ y) * (1 + 1e-9)).any()


def test_a_design_of_zeros_learns_nothing():
    assert gradient_descent(np.zeros((3, 2)), np.ones(3)).tolist() == [0.0, 0.0]
    assert gradient_descent(np.zeros((3, 0)), np.ones(3)).shape == (0,)


@given(seed=seeds, columns=st.integers(1, 12))
def test_heights_meet_the_conditions_of_karush_kuhn_and_tucker(seed, columns):
    design = overlapping(seed, 14, columns)
    gram = design.T @ design
    right = (uniform(8, np.arange(columns), seed=seed) - 0.4) * 10.0
    v = non_negative_least_squares(gram, right)
    slack = gram @ v - right
    tolerance = 1e-10 * np.abs(right).max()  # 1e-12 of the norm, times the scaling
    assert v.min() >= 0.0
    assert slack.min() >= -tolerance
    assert np.abs(slack[v > 0.0]).max(initial=0.0) <= tolerance


@given(seed=seeds)
def test_where_all_heights_are_free_it_is_least_squares(seed):
    design, _ = problem(seed)
    wanted = 0.5 + uniform(4, np.arange(6), seed=seed)
    gram = design.T @ design
    assume(np.linalg.cond(gram) < 1e4)
    found = non_negative_least_squares(gram, gram @ wanted)
    np.testing.assert_allclose(found, wanted, atol=1e-7)


def test_nothing_to_fit_is_nothing():
    assert non_negative_least_squares(np.zeros((0, 0)), np.zeros(0)).shape == (0,)
    assert non_negative_least_squares(np.eye(2), [-1.0, 0.0]).tolist() == [0.0, 0.0]
    # A ball that covers no voxel has a row of zeros.
    assert non_negative_least_squares([[0, 0], [0, 2]], [0, 4]).tolist() == [0.0, 2.0]


def test_balls_that_repeat_one_another_share_their_height():
    gram = np.ones((3, 3))
    assert non_negative_least_squares(gram, 2.0 * np.ones(3)).sum() == pytest.approx(2)


@pytest.mark.parametrize("exponent", [-100, -6, 6, 100])
def test_neither_unit_of_density_nor_of_the_kernel_shows(exponent):
    design, y = problem(1)
    gram, right = design.T @ design, design.T @ y
    plain = non_negative_least_squares(gram, right)
    scaled = non_negative_least_squares(gram * 10.0**exponent, right * 10.0**exponent)
    np.testing.assert_allclose(scaled, plain, atol=1e-9)


@pytest.mark.parametrize("of_gram", [-1030, -600, 0, 600, 1000])
@pytest.mark.parametrize("of_right", [-1020, -600, 0, 600, 1000])
def test_heights_keep_their_digits_at_any_scale(of_gram: int, of_right: int) -> None:
    """Squares of 1e300 are no numbers, and those of 1e-300 are 0."""
    gram, right = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([3.0, 2.0])
    plain = non_negative_least_squares(gram, right)
    scaled = np.ldexp(gram, of_gram), np.ldexp(right, of_right)
    if of_right - of_gram >= 1024:
        with pytest.raises(ValueError, match=r"^right: expected numbers so small"):
            non_negative_least_squares(*scaled)
        return
    found = non_negative_least_squares(*scaled)
    with np.errstate(under="ignore"):
        np.testing.assert_array_equal(found, np.ldexp(plain, of_right - of_gram))


@pytest.mark.parametrize(
    ("gram", "message"),
    [
        (
            [[1e-310, 0.0], [0.0, 1.0]],
            "gram: expected a diagonal of 0 or at least 1e-1",
        ),
        ([[1.0, -1.0], [-1.0, 1.0]], "gram: expected a matrix that is not almost sing"),
        ([[1.0, 2.0], [0.0, 1.0]], "gram: expected a symmetric matrix"),
        ([[-1.0, 0.0], [0.0, 1.0]], "gram: expected a diagonal from 0"),
        ([[1.0, 0.0]], r"gram: expected an array of shape \(N, N\)"),
    ],
)
def test_matrices_that_are_no_gram_matrix_are_refused(gram, message):
    with pytest.raises(ValueError, match=message):
        non_negative_least_squares(gram, [1.0, 1.0])
