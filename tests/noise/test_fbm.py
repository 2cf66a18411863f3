"""fBm and turbulence of each kind: bounds, octaves, time, period, what is skipped."""

from __future__ import annotations

import importlib
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.fbm import drawn

from refcloud.noise import (
    fbm,
    fbm_grid,
    gradient,
    octave_bound,
    octave_frame,
    simplex,
    turbulence,
    turbulence_grid,
    uniform,
    value,
)

SAME = 1e-12  # the contract
SUMS = ((fbm, fbm_grid), (turbulence, turbulence_grid))


@settings(max_examples=60)
@given(st.data(), st.sampled_from(SUMS))
def test_grid_equals_points_within_the_bound_in_both_precisions(data, sums) -> None:
    pointwise, grid = sums
    dimensions, each, how = drawn(data.draw)
    lines = [
        data.draw(st.lists(each, min_size=1, max_size=4)) for _ in range(dimensions)
    ]
    at = np.stack(np.meshgrid(*lines[::-1], indexing="ij")[::-1], axis=-1)
    exact = pointwise(at, **how)
    whole, skipped = grid(*lines, **how)
    assert skipped == ()
    np.testing.assert_allclose(whole, exact, rtol=0, atol=SAME)
    bound = octave_bound(how["octaves"], how["persistence"])
    largest = bound if how["normalize"] == "none" else 1.0
    assert np.abs(exact).max() <= largest * (1 + 1e-14)
    if pointwise is turbulence:
        assert exact.min() >= 0.0
    for single in (
        grid(*lines, dtype="float32", **how)[0],
        pointwise(at, dtype="float32", **how),
    ):
        assert single.dtype == np.float32
        # Worst seen of a single octave 1.7e-6, of three summed.
        np.testing.assert_allclose(single, exact, rtol=0, atol=2e-5)


@settings(max_examples=25)
@given(st.data(), st.sampled_from(SUMS), st.integers(1, 5))
def test_parts_and_tiles_of_a_sum_do_not_show(data, sums, tile: int) -> None:
    # Octaves that ascend after their shifts share tiles, others do not.
    _, each, how = drawn(data.draw)
    how |= {"kind": "gradient", "time": None}
    lines = [sorted(data.draw(st.lists(each, max_size=6))) for _ in range(3)]
    whole, _ = sums[1](*lines, **how)
    with pytest.MonkeyPatch.context() as patch:
        grids, bands = (
            importlib.import_module(f"refcloud.noise.{name}")
            for name in ("gradient_grid", "bands")
        )
        patch.setattr(grids, "MOST_BLENDED", 50)
        patch.setattr(bands, "TILE", tile)
        parts, _ = sums[1](*lines, **how)
    np.testing.assert_allclose(parts, whole, rtol=0, atol=SAME)


@pytest.mark.parametrize("sums", SUMS)
def test_a_sum_is_its_octaves_in_their_frames(sums) -> None:
    at = 20 * uniform(np.arange(60)[:, None], np.arange(3), seed=1) - 10
    kinds = {
        "gradient": gradient,
        "simplex": simplex,
        "value": lambda p, seed: value(p, seed=seed, interpolant="quintic"),
    }
    for kind, noise in kinds.items():
        total = 0.0
        for i in range(3):
            own, shift = octave_frame(i, seed=9)
            octave = noise(at * 2**i + shift, seed=own)
            total = total + 0.5**i * (octave if sums[0] is fbm else np.abs(octave))
        found = sums[0](at, kind=kind, seed=9, octaves=3, normalize="none")
        np.testing.assert_allclose(found, total, rtol=0, atol=1e-11)


def test_n24_time_is_one_more_coordinate() -> None:
    at = 9 * uniform(np.arange(40)[:, None], np.arange(3), seed=2)
    for kind, count in (("value", 2), ("gradient", 2), ("simplex", 2), ("simplex", 3)):
        still = np.column_stack((at[:, :count], np.full(40, 0.7)))
        there = fbm(at[:, :count], kind=kind, time=0.7)
        np.testing.assert_array_equal(there, fbm(still, kind=kind))
        # It flows: a little time changes a little, a cell's time changes all.
        soon, later = (fbm(at[:, :count], kind=kind, time=t) for t in (0.7001, 1.9))
        assert np.abs(soon - there).max() < 0.01 < np.abs(later - there).max()


@settings(max_examples=40)
@given(st.sampled_from(["value", "gradient"]), st.integers(1, 9), st.data())
def test_sums_repeat_after_their_period_exactly(kind, period: int, data) -> None:
    eighths = data.draw(st.tuples(*[st.integers(-(2**10), 2**10)] * 3))
    at = np.array(eighths) / 8.0
    moved = at + period * np.array([3, -1, 0])
    how = {"kind": kind, "period": period, "seed": 5}
    # The shift of each octave rounds at another size of the place: 2^-40 of a cell.
    assert fbm(moved, **how) == pytest.approx(fbm(at, **how), abs=1e-10)
    x, y, z = moved[:, None]
    assert turbulence_grid(x, y, z, **how)[0] == pytest.approx(
        turbulence(at, **how), abs=1e-10
    )


@settings(max_examples=40)
@given(st.data(), st.sampled_from(SUMS), st.floats(0.05, 1.0))
def test_n16_skipped_octaves_change_no_more_than_their_bound(
    data, sums, finest
) -> None:
    dimensions, each, how = drawn(data.draw)
    lines = [
        data.draw(st.lists(each, min_size=1, max_size=3)) for _ in range(dimensions)
    ]
    full, _ = sums[1](*lines, **how)
    fewer, rows = sums[1](*lines, finest=finest, **how)
    fine = [i for i in range(how["octaves"]) if 2.0**-i < finest]
    assert sum(row.skipped for row in rows) == len(fine)
    lost = math.fsum(how["persistence"] ** i for i in fine)
    if how["normalize"] == "bound":
        lost /= octave_bound(how["octaves"], how["persistence"])
    assert sum(row.bound for row in rows) == pytest.approx(lost, rel=1e-13)
    assert np.abs(full - fewer).max() <= lost + 1e-14


def test_octaves_do_not_meet_at_lattice_points() -> None:
    # With one origin every octave of gradient noise would be 0 at whole places.
    cells = np.stack(np.meshgrid(*[np.arange(6.0)] * 3), axis=-1)
    assert np.abs(fbm(cells)).min() > 0.0
    assert np.std(fbm(cells)) > 0.5 * np.std(fbm(cells + 0.4))


def test_turbulence_has_the_absolute_value_inside() -> None:
    at = 30 * uniform(np.arange(500)[:, None], np.arange(3), seed=3)
    inside, outside = turbulence(at), np.abs(fbm(at))
    assert np.all(inside >= outside - SAME)
    assert np.any(inside > outside + 0.05)


def test_not_finite_points_give_nan() -> None:
    at = np.array([[0.1, math.nan, 0.3], [0.1, 0.2, 0.3], [math.inf, 0.0, 0.0]])
    for kind in ("value", "gradient", "simplex"):
        assert np.isnan(fbm(at, kind=kind)).tolist() == [True, False, True]


def test_what_a_kind_lacks_is_refused_by_name() -> None:
    with pytest.raises(
        ValueError, match=r"^points: expected 3 coordinates for 'value'"
    ):
        fbm(np.zeros((4, 2)), kind="value")
    with pytest.raises(ValueError, match=r"^z: expected 3 coordinates for 'value'"):
        fbm_grid([0.0], [0.0], [0.0], kind="value", time=0.5)
    with pytest.raises(ValueError, match=r"^period: expected None for 'simplex'"):
        fbm(np.zeros(3), kind="simplex", period=4)
    with pytest.raises(
        ValueError, match=r"^period: expected at most 2\d+ for 4 octaves"
    ):
        fbm(np.zeros(3), period=2**30)
