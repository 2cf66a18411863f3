"""Hashes: the paper's to the bit, its faults by name, the quality of the seeded one.

A mean of n independent numbers lies within 6 standard deviations of its expectation but
for 2e-9 of all draws: that is where the bounds on statistics come from.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.noise import seeds, seeds_or_none, wholes

from refcloud.noise import elias2d, lattice_random, man2003, uniform

SIGMAS = 6.0
SIDE = 64  # lattice blocks of the statistics: 262144 numbers


def c_expression(x: int, y: int, z: int) -> float:
    """Evaluate eq 2 as C does in 32-bit int, with wrap-around written out."""

    def int32(word: int) -> int:
        return (word + 2**31) % 2**32 - 2**31

    m = int32(x + int32(57 * y) + int32(57 * 57 * z))
    n = int32(int32(m << 13) ^ m)
    square = int32(int32(int32(n * n) * 15731) + 789221)
    return 1.0 - (int32(int32(n * square) + 1376312589) & 0x7FFFFFFF) / 2**30


def block(seed: int | None, corner: tuple[int, int, int] = (0, 0, 0)) -> np.ndarray:
    """Give the lattice numbers of a block as [z, y, x]."""
    x, y, z = (np.arange(low, low + SIDE) for low in corner)
    return lattice_random(x, y[:, None], z[:, None, None], seed=seed)


def test_e08_man2003_equals_c_on_a_million_points() -> None:
    # Half a cube about the origin, half anywhere in 32 bits (a Weyl sequence).
    near = np.arange(-40, 40)
    x, y, z = (axis.ravel() for axis in np.meshgrid(near, near, near))
    far = np.arange(500_000, dtype=np.int64)
    steps = (2654435761, 2246822519, 3266489917)  # odd: every value comes once
    xs, ys, zs = (
        np.concatenate((axis[:500_000], far * step % 2**32 - 2**31))
        for axis, step in zip((x, y, z), steps, strict=True)
    )
    assert xs.size == 1_000_000
    rows = zip(xs.tolist(), ys.tolist(), zs.tolist(), strict=True)
    expected = np.array([c_expression(*row) for row in rows])
    np.testing.assert_array_equal(man2003(xs, ys, zs), expected)


def test_e08_float_evaluation_is_almost_always_wrong() -> None:
    m = np.arange(1000, 101_000, dtype=np.int64)
    n = ((m << 13) ^ m).astype(np.float64)
    bits = np.fmod(n * (n * n * 15731.0 + 789221.0) + 1376312589.0, 2.0**31)
    right = 1.0 - bits / 2.0**30 == man2003(m, 0, 0)
    assert right.mean() < 0.01


def test_e05_the_printed_mask_of_43_bits_leaves_the_range() -> None:
    printed = [
        1.0 - (bits & 0x7FFFFFFFFFF) / 2**30
        for bits in (n * (n * n * 15731 + 789221) + 1376312589 for n in range(999))
    ]
    assert min(printed) < -8000.0
    assert float(man2003(np.arange(999), 0, 0).min()) > -1.0


# The one m below 2^31 (found by trying each) whose 31 bits are all ones.
LOWEST_M = 230_204_178


def test_e06_divisor_of_2_to_the_30_keeps_the_range_and_the_printed_does_not() -> None:
    assert float(man2003(LOWEST_M, 0, 0)) == -1.0 + 2.0**-30
    printed = float(man2003(LOWEST_M, 0, 0, divisor=2**30 - 1))
    assert printed == pytest.approx(-1.0 - 2.0**-30, abs=1e-17)
    assert printed < -1.0


def test_e07_rotation_agrees_with_the_shift_below_2_to_the_19_alone() -> None:
    small = np.arange(2**19)
    for m, agree in ((small, True), (-1 - small[:5000], False), (small + 2**19, False)):
        same = man2003(m, 0, 0) == man2003(m, 0, 0, shift="rotate")
        assert same.all() if agree else not same.any()


@given(wholes, wholes, wholes)
def test_e09_the_paper_repeats_after_57_cells(x: int, y: int, z: int) -> None:
    assert man2003(x + 57, y, z) == man2003(x, y + 1, z)
    assert man2003(x, y + 57, z) == man2003(x, y, z + 1)
    assert lattice_random(x + 57, y - 1, z, seed=None) == man2003(x, y, z)


@given(wholes, wholes, st.integers(-(2**62), 2**62))
def test_e09_elias_seeds_are_one_pattern_moved(x: int, y: int, seed: int) -> None:
    assert elias2d(x, y, seed=seed + 1) == elias2d(x + 17, y + 2, seed=seed)


def correlation(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.corrcoef(a.ravel(), b.ravel())[0, 1])


@settings(max_examples=10)
@given(seeds)
def test_e09_seeded_hash_has_no_lattice_period(seed: int) -> None:
    here = block(seed)
    bound = SIGMAS / math.sqrt(here.size)
    for step in ((57, -1, 0), (0, 57, -1), (57, 0, 0), (3249, 0, -1)):
        assert abs(correlation(here, block(seed, step))) < bound, step
    assert correlation(block(None), block(None, (57, -1, 0))) == pytest.approx(1.0)


@settings(max_examples=10)
@given(seeds)
def test_e09_neighbouring_seeds_share_no_pattern(seed: int) -> None:
    here, other = block(seed), block(seed + 1 if seed < 0 else seed - 1)
    for shift in ((0, 0, 0), (0, 2, 17), (1, 0, 0), (0, 1, 0), (0, 0, 1)):
        moved = np.roll(other, shift, axis=(0, 1, 2))
        assert abs(correlation(here, moved)) < SIGMAS / SIDE**1.5


@settings(max_examples=10)
@given(seeds, st.tuples(wholes, wholes, wholes))
def test_seeded_hash_is_uniform_and_uncorrelated(seed: int, corner: tuple) -> None:
    g = block(seed, tuple(c % 2**31 for c in corner))
    n = g.size
    # Uniform in (-1, 1]: variance of g 1/3, of g^2 1/5 - 1/9 = 4/45.
    assert abs(g.mean()) < SIGMAS * math.sqrt(1 / 3 / n)
    assert abs((g**2).mean() - 1 / 3) < SIGMAS * math.sqrt(4 / 45 / n)
    for axis in range(3):
        for lag in (1, 2, 8, 32):
            ahead = np.roll(g, lag, axis=axis)
            assert abs(correlation(g, ahead)) < SIGMAS / math.sqrt(n), (axis, lag)
    counts = np.histogram(g, bins=64, range=(-1, 1))[0]
    deviation = SIGMAS * math.sqrt(n / 64)
    assert np.abs(counts - n / 64).max() < deviation


@settings(max_examples=5)
@given(seeds)
def test_each_input_bit_flips_each_output_bit_half_the_time(seed: int) -> None:
    samples = 4096
    cells = [
        (uniform(np.arange(samples), axis, seed=seed) * 2**32).astype(np.int64)
        for axis in range(3)
    ]

    def bits(cells: list[np.ndarray], seed: int) -> np.ndarray:
        return ((1.0 - lattice_random(*cells, seed=seed)) * 2**30).astype(np.int64)

    before = bits(cells, seed)
    flipped = [
        bits([c ^ ((k == axis) << bit) for k, c in enumerate(cells)], seed)
        for axis in range(3)
        for bit in range(32)
    ] + [bits(cells, seed ^ (1 << bit)) for bit in range(63)]
    changed = np.stack([before ^ after for after in flipped])
    shares = np.stack([(changed >> bit & 1).mean(axis=1) for bit in range(31)])
    # 31 x 159 shares each run: one more sigma keeps the risk of the run at 1e-8.
    assert np.abs(shares - 0.5).max() < (SIGMAS + 1.0) * 0.5 / math.sqrt(samples)


@given(st.lists(st.tuples(wholes, wholes, wholes), min_size=1), seeds_or_none)
def test_lattice_numbers_are_31_bits_in_range(rows: list, seed: int | None) -> None:
    x, y, z = np.array(rows, dtype=np.int64).T
    g = lattice_random(x, y, z, seed=seed)
    assert np.all((g > -1.0) & (g <= 1.0))
    np.testing.assert_array_equal(np.round(g * 2**30), g * 2**30)
    # The same bits in any order, and one at a time.
    np.testing.assert_array_equal(
        lattice_random(x[::-1], y[::-1], z[::-1], seed=seed), g[::-1]
    )
    assert [lattice_random(*row, seed=seed) for row in rows] == g.tolist()


@given(st.lists(wholes, min_size=1, max_size=4), seeds)
def test_uniform_lies_below_1_and_minds_the_order(words: list, seed: int) -> None:
    number = float(uniform(*words, seed=seed))
    assert 0.0 <= number < 1.0
    assert number * 2**53 == math.floor(number * 2**53)
    assert number != uniform(*words, 0, seed=seed)
    if words != words[::-1]:
        assert number != uniform(*words[::-1], seed=seed)


@settings(max_examples=10)
@given(seeds)
def test_uniform_has_the_moments_of_a_uniform_number(seed: int) -> None:
    n = 100_000
    u = uniform(np.arange(n), 3, seed=seed)
    assert abs(u.mean() - 0.5) < SIGMAS * math.sqrt(1 / 12 / n)
    assert abs(((u - 0.5) ** 2).mean() - 1 / 12) < SIGMAS * math.sqrt(1 / 180 / n)
    assert abs(correlation(u[1:], u[:-1])) < SIGMAS / math.sqrt(n - 1)


def test_words_broadcast_and_wrap() -> None:
    assert uniform(np.arange(3), np.zeros((2, 1), int), 5, seed=1).shape == (2, 3)
    assert uniform(seed=4).shape == ()
    assert uniform(2**64 + 3, seed=0) == uniform(3, seed=0)
    assert uniform(np.array(-1), seed=0) == uniform(2**64 - 1, seed=0)
    assert lattice_random(2**32 + 3, -1, 0) == lattice_random(3, 2**32 - 1, 0)
    assert lattice_random(np.zeros((0, 4), int), 1, 2).shape == (0, 4)


@pytest.mark.parametrize(
    "dtype", [np.int8, np.int16, np.int32, np.uint8, np.uint16, np.uint32, np.uint64]
)
def test_every_kind_of_whole_number_gives_the_same(dtype: type) -> None:
    words = np.array([0, 1, 100], dtype=dtype)
    np.testing.assert_array_equal(
        lattice_random(words, words, words),
        lattice_random(*[np.array([0, 1, 100])] * 3),
    )


@pytest.mark.parametrize("bad", [0.5, np.array([0.5]), True, np.array([True]), "3"])
def test_what_is_not_whole_is_refused_by_name(bad: object) -> None:
    with pytest.raises(TypeError, match=r"^y: expected"):
        lattice_random(0, bad, 0)
    with pytest.raises(TypeError, match=r"^words: expected"):
        uniform(0, bad, seed=0)


def test_seeds_out_of_64_bits_are_refused() -> None:
    with pytest.raises(ValueError, match=r"^seed: expected"):
        uniform(1, seed=2**63)
