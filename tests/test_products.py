"""Products in parts are the products, and no part is large enough for a thread."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refcloud import products
from refcloud.noise import uniform
from refcloud.products import ONE_THREAD, ONE_THREAD_DOT, dot, product


def numbers(*shape: int, seed: int = 0) -> np.ndarray:
    return uniform(np.arange(math.prod(shape)), seed=seed).reshape(shape) - 0.5


sizes = st.integers(0, 5)


@given(sizes, sizes, sizes, st.integers(0, 3), st.integers(1, 40), st.integers(0, 99))
def test_parts_make_the_whole(m, K, n, more, most, seed) -> None:
    left, right = numbers(m, K, seed=seed), numbers(more, K, n, seed=seed + 1)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(products, "ONE_THREAD", most)
        patch.setattr(products, "ONE_THREAD_DOT", most)
        found = product(left, right)
        out = np.empty_like(found)
        assert product(left, right, out) is out
        row = dot(left, left)
    np.testing.assert_allclose(found, left @ right, rtol=0, atol=1e-15 * 5)
    np.testing.assert_array_equal(out, found)
    assert row == pytest.approx(float(np.square(left).sum()), abs=1e-14)


@pytest.mark.parametrize("m", [1, 2, 9, 26, 300])
@pytest.mark.parametrize("K", [1, 9, 26])
def test_no_part_is_large_enough_for_a_second_thread(monkeypatch, m, K) -> None:
    asked: list[tuple[int, int]] = []

    def matmul(left, right, out):
        asked.append((left.size * right.shape[-1], right.shape[-1]))
        return np.multiply(0.0, out, out=out)

    monkeypatch.setattr(products.np, "matmul", matmul)
    product(np.zeros((m, K)), np.zeros((K, 70_001)))
    # OpenBLAS: a product of more than 2^18, of a row with a matrix 9216 and more.
    most = ONE_THREAD if m > 1 else min(ONE_THREAD_DOT, 9215)
    assert max(work for work, _ in asked) <= most
    assert sum(columns for _, columns in asked) == 70_001


def test_kinds_of_numbers_meet_in_the_wider_one() -> None:
    single, double = np.ones((2, 3), np.float32), np.ones((3, 4))
    assert product(single, double).dtype == np.float64
    assert product(single, double.astype(np.float32)).dtype == np.float32
