"""The 27 taps of eq 3: the printed sums, their symmetry (E10), exact in any order."""

from __future__ import annotations

import itertools
from collections import Counter
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.noise import seeds_or_none, wholes

from refcloud.noise import lattice_random, smoothed
from refcloud.noise.lattice import DENOMINATOR, WEIGHTS, _block, _smoothed_inside

ALPHA, BETA = Fraction(9, 18), Fraction(2, 8 * 18)
GAMMA, DELTA = Fraction(4, 6 * 18), Fraction(3, 12 * 18)

# Eq 3 as scan 002 prints it: x, y and z of each neighbour, 0 for none.
CORNERS = "--- +-- -+- ++- --+ +-+ -++ +++".split()
SIDES = "-00 +00 0-0 0+0 00- 00+".split()
EDGES = "-0- +0- 0+- 0-- -0+ +0+ 0++ 0-+ --0 -+0 +-0 ++0".split()
# Scan 000 prints g(x, y+, z+) twice and lacks g(x, y-, z+).
MISPRINT = "-0- +0- 0+- 0-- -0+ +0+ 0++ 0++ --0 -+0 +-0 ++0".split()

STEP = {"-": -1, "0": 0, "+": 1}


def printed(x: int, y: int, z: int, seed: int | None, edges: list[str]) -> Fraction:
    """Evaluate eq 3 in exact fractions."""

    def total(taps: list[str]) -> Fraction:
        moved = [
            [c + STEP[s] for c, s in zip((x, y, z), tap, strict=True)] for tap in taps
        ]
        return sum(
            (Fraction(float(lattice_random(*m, seed=seed))) for m in moved), Fraction()
        )

    return (
        ALPHA * total(["000"])
        + BETA * total(CORNERS)
        + GAMMA * total(SIDES)
        + DELTA * total(edges)
    )


@given(wholes, wholes, wholes, seeds_or_none)
def test_smoothed_is_the_printed_sum(x: int, y: int, z: int, seed: int | None) -> None:
    # The sum is exact; the one division rounds.
    assert float(smoothed(x, y, z, seed=seed)) == float(printed(x, y, z, seed, EDGES))


def test_e10_weights_sum_to_1_and_have_the_denominator_216() -> None:
    assert ALPHA + 8 * BETA + 6 * GAMMA + 12 * DELTA == 1
    assert [Fraction(w, DENOMINATOR) for w in WEIGHTS] == [ALPHA, GAMMA, DELTA, BETA]


def test_e10_scan_002_is_symmetric_under_axis_permutation_and_000_is_not() -> None:
    for edges, symmetric in ((EDGES, True), (MISPRINT, False)):
        permuted = [
            Counter("".join(tap[axis] for axis in axes) for tap in edges)
            for axes in itertools.permutations(range(3))
        ]
        assert all(taps == permuted[0] for taps in permuted) == symmetric
    assert smoothed(1, 2, 3) != float(printed(1, 2, 3, 0, MISPRINT))


@given(
    st.permutations(range(3)),
    st.tuples(*[st.sampled_from([-1, 1])] * 3),
    st.integers(0, 2**31),
)
def test_e10_smoothing_commutes_with_permuted_and_mirrored_axes(axes, flips, corner):
    x, y, z = (np.arange(n) + corner for n in (3, 4, 5))
    g = lattice_random(x, y[:, None], z[:, None, None])
    turn = tuple(slice(None, None, flip) for flip in flips)
    np.testing.assert_array_equal(
        _smoothed_inside(g.transpose(axes)[turn]),
        _smoothed_inside(g).transpose(axes)[turn],
    )


@given(
    st.tuples(*[st.integers(-(2**33), 2**33)] * 3),
    st.tuples(*[st.integers(1, 4)] * 3),
    seeds_or_none,
)
def test_a_block_has_the_bits_of_its_points(corner, counts, seed) -> None:
    lines = [np.arange(c - 1, c + n + 1) for c, n in zip(corner, counts, strict=True)]
    x, y, z = (line[1:-1] for line in lines)
    rows, layers = y[:, None], z[:, None, None]
    np.testing.assert_array_equal(
        _block(*lines, seed=seed, smooth=True), smoothed(x, rows, layers, seed=seed)
    )
    np.testing.assert_array_equal(
        _block(x, y, z, seed=seed, smooth=False),
        lattice_random(x, rows, layers, seed=seed),
    )


@given(st.lists(wholes, min_size=1), seeds_or_none)
def test_smoothed_stays_in_range(cells: list[int], seed: int | None) -> None:
    f = smoothed(np.array(cells, dtype=np.int64), 1, -1, seed=seed)
    assert np.abs(f).max() <= 1.0


def test_what_is_not_whole_is_refused() -> None:
    with pytest.raises(TypeError, match=r"^z: expected"):
        smoothed(0, 1, np.array([0.5]))
