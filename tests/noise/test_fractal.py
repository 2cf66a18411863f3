"""The sum of octaves: its bound (E11), its octaves, and what is skipped (N16)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.noise import INTERPOLANTS, coordinates, points, seeds, seeds_or_none, unit

from refcloud.noise import (
    octave_bound,
    octave_frame,
    octave_sum,
    octave_sum_grid,
    uniform,
    value,
)
from refcloud.noise.lattice import PERIOD
from refcloud.noise.weights import PEAKS

ROUNDING = 1e-14  # sums of up to 32 values below 3.4; worst seen 1.3e-15

axes = st.lists(coordinates, min_size=1, max_size=4)
ways = st.fixed_dictionaries(
    {
        "seed": seeds_or_none,
        "octaves": st.integers(1, 6),
        "persistence": unit,
        "interpolant": st.sampled_from(INTERPOLANTS),
        "normalize": st.sampled_from(["clip", "bound", "none"]),
        "absolute": st.booleans(),
        "period": st.none() | st.integers(1, 9),
    }
)


@given(st.integers(1, 32), st.floats(0.0, 0.99))
def test_e11_bound_is_the_geometric_sum(octaves: int, s: float) -> None:
    closed = (1.0 - s**octaves) / (1.0 - s)
    assert octave_bound(octaves, s) == pytest.approx(closed, rel=1e-13)  # 1 - s: 1e-14
    assert octave_bound(octaves, 1.0) == octaves
    assert octave_bound(4, 0.5) == 1.875


@settings(max_examples=50)
@given(st.lists(points, min_size=1, max_size=8), ways)
def test_e11_every_normalisation_keeps_its_range(places, how) -> None:
    noise = octave_sum(np.array(places), **how)
    peak = PEAKS[how["interpolant"]] ** 3
    bound = octave_bound(how["octaves"], how["persistence"]) * peak
    largest = bound if how["normalize"] == "none" else 1.0
    assert np.abs(noise).max() <= largest * (1.0 + ROUNDING)
    if how["absolute"]:
        assert noise.min() >= 0.0


def test_e11_the_sum_leaves_0_to_1_and_the_clip_brings_it_back() -> None:
    x = np.linspace(0.0, 64.0, 129)
    how = {"octaves": 4, "persistence": 0.9, "seed": None}
    raw, _ = octave_sum_grid(x, x, [0.0, 0.5], normalize="none", **how)
    assert raw.max() > 1.0
    clipped, _ = octave_sum_grid(x, x, [0.0, 0.5], **how)
    np.testing.assert_array_equal(clipped, np.minimum(raw, 1.0))
    bounded, _ = octave_sum_grid(x, x, [0.0, 0.5], normalize="bound", **how)
    np.testing.assert_array_equal(bounded, raw / octave_bound(4, 0.9))


@given(st.lists(points, min_size=1, max_size=4), seeds_or_none, st.integers(1, 5), unit)
def test_a_sum_is_its_octaves_in_their_frames(places, seed, octaves, s) -> None:
    total = 0.0
    for i in range(octaves):
        own, shift = octave_frame(i, seed=seed)
        # What eq 1 calls h(2^i x), reduced so that it stays exact at any place.
        place = np.fmod(np.fmod(np.array(places), PERIOD) * 2.0**i, PERIOD) + shift
        total = total + s**i * value(place, seed=own)
    how = {"seed": seed, "octaves": octaves, "persistence": s, "normalize": "none"}
    np.testing.assert_allclose(
        octave_sum(np.array(places), absolute=False, **how),
        total,
        rtol=0,
        atol=ROUNDING,
    )
    # The absolute value is taken of the sum; turbulence would sum absolute values.
    np.testing.assert_allclose(
        octave_sum(np.array(places), **how), np.abs(total), rtol=0, atol=ROUNDING
    )


@settings(max_examples=50)
@given(axes, axes, axes, ways)
def test_grid_equals_points(x, y, z, how) -> None:
    grid, skipped = octave_sum_grid(x, y, z, **how)
    assert skipped == ()
    mesh = np.meshgrid(z, y, x, indexing="ij")
    place = np.stack(mesh[::-1], axis=-1)
    exact = octave_sum(place, **how)
    np.testing.assert_allclose(grid, exact, rtol=0, atol=1e-12)
    for single in (
        octave_sum_grid(x, y, z, dtype="float32", **how)[0],
        octave_sum(place, dtype="float32", **how),
    ):
        assert single.dtype == np.float32
        # Worst seen of a single octave 1.5e-6, of six, cubic ones up to 3.4 times that.
        np.testing.assert_allclose(single, exact, rtol=0, atol=6 * 3.4 * 1.5e-6)


@settings(max_examples=40)
@given(st.tuples(*[st.integers(-(2**10), 2**10)] * 3), st.integers(1, 9), ways)
def test_the_sum_repeats_after_its_period(eighths, period: int, how) -> None:
    how |= {"period": period}
    at = np.array(eighths) / 8.0
    moved = at + period * np.array([3, -1, 0])
    # The shift of each octave rounds at another size of the place: 2^-40 of a cell.
    expected = pytest.approx(octave_sum(at, **how), abs=1e-10)
    assert octave_sum(moved, **how) == expected
    assert octave_sum_grid(*moved[:, None], **how)[0] == expected


def test_a_period_too_long_for_the_finest_octave_is_refused() -> None:
    for call in (
        lambda: octave_sum(np.zeros(3), period=2**29),
        lambda: octave_sum_grid([0.0], [0.0], [0.0], period=2**29),
    ):
        with pytest.raises(ValueError, match=r"^period: expected at most 268435456"):
            call()


def test_octaves_share_their_origin_without_a_seed_alone() -> None:
    how = {"normalize": "none", "absolute": False}
    alone = value(np.zeros(3), seed=None)
    together = octave_sum(np.zeros(3), seed=None, **how)
    assert together == pytest.approx(octave_bound(4, 0.5) * alone, abs=ROUNDING)
    shared = octave_bound(4, 0.5) * value(np.zeros(3), seed=1)
    assert abs(octave_sum(np.zeros(3), seed=1, **how) - shared) > 1e-3


@given(seeds)
def test_octave_frames_differ(seed: int) -> None:
    frames = [octave_frame(i, seed=seed) for i in range(32)]
    assert len({own for own, _ in frames}) == 32
    shifts = np.array([shift for _, shift in frames])
    assert np.all((shifts >= 0.0) & (shifts < 1.0))
    assert np.unique(shifts).size == shifts.size


@settings(max_examples=50)
@given(ways, st.floats(0.01, 1.0), seeds)
def test_n16_skipped_octaves_change_no_more_than_their_bound(how, finest, seed) -> None:
    x, y, z = (uniform(np.arange(3), axis, seed=seed) * 20 for axis in range(3))
    full, _ = octave_sum_grid(x, y, z, **how)
    fewer, rows = octave_sum_grid(x, y, z, finest=finest, **how)
    too_fine = [i for i in range(how["octaves"]) if 2.0**-i < finest]
    if not too_fine:
        assert rows == ()
        np.testing.assert_array_equal(full, fewer)
        return
    (row,) = rows
    assert (row.skipped, row.of) == (len(too_fine), how["octaves"])
    lost = math.fsum(how["persistence"] ** i for i in too_fine)
    if how["normalize"] == "bound":
        lost /= octave_bound(how["octaves"], how["persistence"])
    else:
        lost *= PEAKS[how["interpolant"]] ** 3
    assert row.bound == pytest.approx(lost, rel=1e-13)
    assert np.abs(full - fewer).max() <= row.bound + ROUNDING


def test_n16_two_samples_per_cell_are_kept_and_fewer_are_not() -> None:
    for finest, skipped in ((0.125, 0), (0.126, 1), (1.0, 3), (1.01, 4)):
        noise, rows = octave_sum_grid([0.3], [0.3], [0.3], finest=finest)
        assert sum(row.skipped for row in rows) == skipped
        assert (noise == 0.0).all() == (skipped == 4)


def test_not_finite_points_give_nan() -> None:
    places = np.array([[0.1, math.nan, 0.3], [0.1, 0.2, 0.3], [math.inf, 0.0, 0.0]])
    for normalize in ("clip", "bound", "none"):
        noise = octave_sum(places, normalize=normalize)
        assert np.isnan(noise).tolist() == [True, False, True]


@pytest.mark.parametrize(
    ("name", "bad"),
    [
        ("octaves", 0),
        ("octaves", 33),
        ("persistence", 1.5),
        ("persistence", math.nan),
        ("finest", 0.0),
        ("finest", math.inf),
        ("normalize", "max"),
    ],
)
def test_bad_arguments_are_refused_by_name(name: str, bad: object) -> None:
    with pytest.raises(ValueError, match=rf"^{name}: expected"):
        octave_sum_grid([0.0], [0.0], [0.0], **{name: bad})
