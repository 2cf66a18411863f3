"""Leaning lattices: columns as the definition gives them, and sharp clouds by them."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_marches import BLOB, MEDIUM, SUN, blob
from twins.march import directions

from refcloud.camera import Camera, rays
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import unit_vector
from refcloud.march import integrate, shafts, sharp
from refcloud.march.cubics import catmull_rom
from refcloud.march.shafted import SHAFTINGS
from refcloud.optics import Sun
from refcloud.transport import column_density

INNER = VoxelGrid(np.pad(BLOB.density, 1), [-1.2, -1.1, -1.3], [1.2, 1.1, 1.3])
SHARP = VoxelGrid(1.0 * (INNER.density > 0.2), INNER.lower, INNER.upper)
EYE = Camera([2.2, 1.2, 3.0], [0, 0, 0], width=30, height=22)


def places(count: int) -> np.ndarray:
    return np.random.default_rng().uniform(INNER.lower, INNER.upper, (count, 3))


@settings(max_examples=15)
@given(directions())
def test_columns_are_near_the_exact_ones_from_any_sun(sun) -> None:
    sun = unit_vector(np.asarray(sun))
    points = places(300)
    exact = column_density(SHARP, points, sun)
    errors = []
    for finer in (2, 4):
        table = shafts.shafts(SHARP, sun, finer)
        assert table is not None
        errors.append(float(np.sqrt(np.square(table.columns(points) - exact).mean())))
    # A density of 1 in cells of .16: columns up to 2. Worst of 60 suns .0059, .0023.
    assert errors[0] < 0.012
    assert errors[1] < 0.0045


def test_on_its_own_samples_a_column_is_exact_but_for_the_stretches() -> None:
    sun = np.array([0.0, 0.0, 1.0])
    table = shafts.shafts(SHARP, sun, 2)
    assert table is not None
    z, y, x = np.meshgrid(*(np.arange(1, n - 1) for n in SHARP.density.shape))
    size = (SHARP.upper - SHARP.lower) / np.array(SHARP.density.shape[::-1])
    points = SHARP.lower + (np.stack([x, y, z], -1).reshape(-1, 3) + 0.5) * size
    # Along an axis there is no kink between levels: two points are exact.
    exact = column_density(SHARP, points, sun)
    np.testing.assert_allclose(table.columns(points), exact, atol=2e-6)


@given(st.floats(0.0, 1.0))
def test_cubic_weights_reproduce_second_degree(f) -> None:
    weights = [float(w) for w in catmull_rom(np.float32(f))]
    x = np.arange(-1.0, 3.0)
    for degree in range(3):
        assert np.dot(weights, x**degree) == pytest.approx(f**degree, abs=2e-6)


def test_a_sharp_cloud_is_marched_by_leaning_light_within_the_tolerance() -> None:
    seen: dict = {}
    suns = (SUN, Sun([0.6, 0.5, 0.2], [0.3, 0.2, 0.1]))
    medium = dataclasses.replace(MEDIUM, sigma_t=[5.0, 6.0, 4.0])
    how = {"suns": suns, "medium": medium, "ambient": [0.1, 0.1, 0.2]}
    tolerance = 0.01
    exact, T = integrate(SHARP, *rays(EYE), **how)
    found, through = integrate(
        SHARP, *rays(EYE), **how, tolerance=tolerance, observe=seen.__setitem__
    )
    assert np.abs(found - exact).max() <= tolerance
    assert np.abs(through - T).max() <= tolerance
    errors = list(seen["errors of shafts"].values())
    assert 2.0 * errors[-1] <= tolerance
    assert all(2.0 * error > tolerance for error in errors[:-1])
    (row,) = seen["skipped"]
    assert row.what == "exact columns to the suns"
    assert row.skipped == row.of
    # Of the checked rays, or of the steepest.
    assert 2.0 * errors[-1] <= row.bound <= tolerance


def test_what_leaning_lattices_cannot_hold_is_exact(monkeypatch) -> None:
    how = {"suns": SUN, "medium": MEDIUM}
    exact, _ = integrate(SHARP, *rays(EYE), **how)
    for module, name, value in (
        (shafts, "MOST", 10),
        (sharp, "SHAFTINGS", SHAFTINGS[:0]),
    ):
        with monkeypatch.context() as context:
            context.setattr(module, name, value)
            seen: dict = {}
            found, _ = integrate(
                SHARP, *rays(EYE), **how, tolerance=2e-3, observe=seen.__setitem__
            )
        # All light is exact, at fewer points of a piece.
        (row,) = seen["skipped"]
        assert (row.what, row.how) == ("Gauss points of a piece", "certified")
        assert (row.skipped, row.of) in {(2, 4), (1, 4)}
        assert row.bound <= 2e-3
        assert seen["errors of shafts"] == {}
        assert np.abs(found - exact).max() <= 2e-3


def test_cloud_at_a_side_of_its_box_has_no_leaning_lattice() -> None:
    full = blob((6, 6, 6))
    full = VoxelGrid(0.3 + full.density, full.lower, full.upper)
    how = {"suns": SUN, "medium": dataclasses.replace(MEDIUM, sigma_t=20.0)}
    seen: dict = {}
    exact, _ = integrate(full, *rays(EYE), **how)
    found, _ = integrate(
        full, *rays(EYE), **how, tolerance=1e-3, observe=seen.__setitem__
    )
    assert seen["errors of shafts"] == {}
    assert np.abs(found - exact).max() <= 1e-3
