"""How far two pictures lie apart."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from refcloud.image import (
    Picture,
    compare_codes,
    difference_picture,
    largest_difference,
    root_mean_square,
)

VALUES = arrays(np.float64, (2, 3, 3), elements=st.floats(-1e150, 1e150))
CODES = arrays(np.uint8, (3, 4, 3))


@given(a=VALUES, b=VALUES)
def test_distances_are_symmetric_and_ordered(a, b) -> None:
    rms, most = root_mean_square(a, b), largest_difference(a, b)
    assert rms == root_mean_square(b, a)
    assert most == largest_difference(b, a)
    assert most / np.sqrt(a.size) <= rms * (1 + 1e-14)
    assert rms <= most * (1 + 1e-14)
    assert largest_difference(a, a) == root_mean_square(a, a) == 0.0


def test_a_root_mean_square_is_that_of_the_definition() -> None:
    a, b = np.arange(6.0), np.arange(6.0)[::-1]
    assert root_mean_square(a, b) == pytest.approx(np.sqrt(np.mean((a - b) ** 2)))


@given(a=CODES, b=CODES)
def test_comparison_is_symmetric_and_zero_only_for_the_same(a, b) -> None:
    one, other = compare_codes(a, b), compare_codes(b, a)
    assert (one.same, one.worst, one.off_share) == (
        other.same,
        other.worst,
        other.off_share,
    )
    assert (one.worst == 0) == (one.off_share == 0.0) == np.array_equal(a, b)
    assert compare_codes(a, b, codes=255, fraction=1.0).same


@given(a=CODES, b=CODES)
def test_worst_pixels_are_the_worst_and_first_ones_first(a, b) -> None:
    off = np.abs(a.astype(int) - b).max(axis=-1)
    found = compare_codes(a, b).worst_pixels
    assert [pixel[2] for pixel in found] == sorted(off[off > 0])[::-1][:5]
    assert all(off[row, column] == worst for row, column, worst in found)
    if found:
        assert found[0][:2] == divmod(int(off.argmax()), 4)


@pytest.mark.parametrize(
    ("change", "pixels", "same"),
    [(0, 0, True), (1, 10, True), (1, 11, False), (2, 1, False), (-1, 10, True)],
)
def test_one_code_on_a_thousandth_passes(change: int, pixels: int, same: bool) -> None:
    a = np.full((100, 100, 3), 128, np.uint8)
    b = a.copy()
    b[0, :pixels, 1] = 128 + change
    assert compare_codes(a, b).same is same


def test_differences_do_not_wrap_around() -> None:
    black, white = np.zeros((1, 1, 3), np.uint8), np.full((1, 1, 3), 255, np.uint8)
    assert compare_codes(black, white).worst == compare_codes(white, black).worst == 255


def test_alpha_counts_among_the_codes() -> None:
    a = np.zeros((1, 2, 4), np.uint8)
    b = a.copy()
    b[0, 1, 3] = 7
    assert compare_codes(a, b).worst_pixels == ((0, 1, 7),)


@given(a=VALUES, b=VALUES, gain=st.floats(0.0, 100.0))
def test_difference_picture_is_dark_only_where_they_agree(a, b, gain) -> None:
    shown = difference_picture(Picture(a), Picture(b), gain=gain).linear
    np.testing.assert_array_equal(shown, gain * np.abs(a - b))
    assert difference_picture(Picture(a), Picture(a)).linear.max() == 0.0


def test_other_shapes_and_types_are_refused() -> None:
    codes = np.zeros((2, 2, 3), np.uint8)
    with pytest.raises(ValueError, match=r"b: expected shape \(2, 2, 3\) as a, got"):
        compare_codes(codes, np.zeros((2, 3, 3), np.uint8))
    with pytest.raises(TypeError, match="a: expected codes of uint8"):
        compare_codes(codes.astype(float), codes)
    with pytest.raises(ValueError, match="b: expected shape"):
        difference_picture(Picture(np.zeros((2, 2, 3))), Picture(np.zeros((2, 1, 3))))
    with pytest.raises(ValueError, match=r"b: expected a shape that fits a of \(3,\)"):
        root_mean_square(np.zeros(3), np.zeros(4))
    with pytest.raises(ValueError, match="a: expected at least one value"):
        largest_difference(np.zeros(0), np.zeros(0))
