"""The carved cumulus: what its noise and its shape promise."""

from __future__ import annotations

import importlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.noise import seeds

from refcloud.cloudmap import (
    billows,
    carve,
    cell_centres,
    cumulus_ellipsoids,
    depth_inside,
    lumps_grid,
)
from refcloud.cloudmap.billows import RISE, ROOM

SMALL = {"diameters": [20, 11, 11], "voxel": 0.9, "lump": 4.0, "grain": 3.7}
share = st.floats(0.0, 1.0)


def test_lumps_fill_the_range_and_hardly_leave_it() -> None:
    line = 0.173 * np.arange(64)
    lumps, skipped = lumps_grid(line, line, line, seed=3)
    assert not skipped
    assert 0.0 <= lumps.min() < 0.05
    assert 0.9 < lumps.max() <= 1.0
    assert ((lumps == 0.0) | (lumps == 1.0)).mean() < 0.002


def test_n16_octaves_that_cannot_be_displayed_are_left_out() -> None:
    line = 0.173 * np.arange(24)
    whole, _ = lumps_grid(line, line, line, seed=3)
    for finest, count in ((0.3, 1), (0.6, 2), (3.0, 3)):
        coarse, (row,) = lumps_grid(line, line, line, seed=3, finest=finest)
        assert (row.skipped, row.of, row.unit) == (count, 3, "lumps")
        assert np.abs(coarse - whole).max() <= row.bound <= 1.0
        # They are left at their mean: what is seen stays as bright.
        assert abs(coarse.mean() - whole.mean()) < 0.02
    assert billows(**SMALL).skipped == ()
    rows = billows(**(SMALL | {"grain": 1.0})).skipped
    assert [row.skipped for row in rows] == [2]


@settings(max_examples=40)
@given(st.floats(-20.0, 20.0), st.floats(0.0, 5.0), share, share, st.floats(0.0, 9.0))
def test_deeper_is_denser_and_lumps_are_too(depth, more, lumps, detail, y) -> None:
    values = {"lumps": [[[lumps]]], "detail": [[[detail]]], "y": [y]}
    here, deeper = (carve([[[d]]], **values)[0, 0, 0] for d in (depth, depth + more))
    assert 0.0 <= here <= deeper + 1e-12
    assert deeper <= 1.0
    lower = carve([[[depth]]], [[[0.5 * lumps]]], [[[detail]]], [y])[0, 0, 0]
    assert lower <= here + 1e-12


@settings(max_examples=40)
@given(share, share, st.floats(-20.0, 20.0))
def test_below_the_base_and_far_outside_nothing_is_left(lumps, detail, depth) -> None:
    at = {"lumps": [[[lumps]]], "detail": [[[detail]]]}
    assert not carve([[[depth]]], y=[0.0], **at).any()
    assert not carve([[[depth]]], y=[-1.0], **at).any()
    outside = -0.55 * RISE - abs(depth)
    assert not carve([[[outside]]], y=[9.0], **at).any()


def test_without_lumps_it_is_the_pile_itself() -> None:
    whole = {"lumps": [[[1.0]]], "detail": [[[0.5]]], "y": [99.0]}
    inside, outside = (carve([[[d]]], erosion=0.0, **whole) for d in (0.0, -2.8))
    assert inside[0, 0, 0] == 1.0
    assert outside[0, 0, 0] == 0.0


@settings(max_examples=5)
@given(seeds)
def test_billows_stand_on_the_plane_of_their_pile(seed) -> None:
    grid = billows(seed=seed, **SMALL)
    x, y, z = cell_centres(grid)
    assert (grid.density[:, y < 0.0] == 0.0).all()
    assert grid.density[:, (y > 0.0) & (y < 2.0)].any()
    centers, radii = cumulus_ellipsoids(SMALL["diameters"], seed=seed)
    depth = depth_inside(x, y, z, centers=centers, radii=radii)
    scale = SMALL["diameters"][0] / 62.0
    assert (depth[grid.density > 0.0] > -0.55 * RISE * scale).all()
    assert 0.0 < grid.density.max() <= 1.0


def test_steps_do_not_show(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list = []
    whole = billows(seed=5, **SMALL, observe=lambda name, value: seen.append(value))
    assert len(seen) == 1
    assert whole.density.size < ROOM
    module = importlib.import_module("refcloud.cloudmap.billows")
    monkeypatch.setattr(module, "ROOM", 1)
    parts = billows(seed=5, **SMALL)
    np.testing.assert_array_equal(parts.density, whole.density)


def test_finer_voxels_are_of_the_same_cloud() -> None:
    coarse = billows(seed=2, **SMALL)
    fine = billows(seed=2, **(SMALL | {"voxel": 0.3}))
    centres = cell_centres(coarse), cell_centres(fine)
    common = []
    for c, f in zip(*centres, strict=True):
        i, j = np.nonzero(np.abs(c[:, None] - f) < 1e-9)
        common.append((i, j))
    (xi, xj), (yi, yj), (zi, zj) = common
    assert min(len(xi), len(yi), len(zi)) > 5
    np.testing.assert_allclose(
        fine.density[np.ix_(zj, yj, xj)],
        coarse.density[np.ix_(zi, yi, xi)],
        rtol=0.0,
        atol=1e-9,
    )


@pytest.mark.parametrize(
    ("how", "message"),
    [
        ({"voxel": 1e-4}, "voxel: expected a grid of at most"),
        ({"voxel": 0.0}, "voxel: expected a finite number"),
        ({"erosion": 1.0}, "erosion: expected a finite number"),
        ({"lump": -1.0}, "lump: expected a finite number"),
        ({"diameters": [1, 0, 1]}, "diameters: expected numbers in"),
    ],
)
def test_refusals_name_the_argument_in_one_line(how, message: str) -> None:
    with pytest.raises(ValueError, match=rf"^{message}[^\n]*$"):
        billows(**how)
