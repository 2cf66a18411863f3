"""The march chooses slices by itself where they hold the tolerance, and only there."""

from __future__ import annotations

import numpy as np
import pytest
from smooth_clouds import cloud

from refcloud import render
from refcloud.camera import Camera
from refcloud.march.sampling import edge_rays
from refcloud.optics import Medium, Sun

CAMERA = Camera([1.5, 1.0, 3.2], [0, 0, 0], fov_y=0.53, width=32, height=24)
WHITE = Sun([-0.5, 0.7, 0.4])
HOW = {"camera": CAMERA, "suns": WHITE, "background": [0.1, 0.2, 0.4]}


@pytest.mark.parametrize("sigma_t", [6.0, np.array([4.0, 5.0, 6.0])])
def test_slices_hold_the_tolerance(sigma_t) -> None:
    medium, seen = Medium(sigma_t), {}
    tolerance = 0.03
    picture = render(
        cloud(40), medium=medium, tolerance=tolerance, observe=seen.__setitem__, **HOW
    )
    assert any("slices" in note for note in picture.notes)
    assert min(seen["errors of slices"].values()) * 2.0 <= tolerance
    exact = render(cloud(40), medium=medium, **HOW)
    assert np.abs(picture.linear - exact.linear).max() < tolerance
    (row,) = picture.skipped
    assert row.skipped == row.of == 32 * 24
    assert row.bound <= tolerance


def test_what_slices_do_not_hold_is_marched_by_rays() -> None:
    full = cloud(24, filled=True)  # the box's edges would blur
    picture = render(full, medium=Medium(6.0), tolerance=0.03, **HOW)
    assert not any("slices" in note for note in picture.notes)
    exact = render(full, medium=Medium(6.0), **HOW)
    assert np.abs(picture.linear - exact.linear).max() < 0.03


def test_the_steepest_rays_are_those_beside_a_step() -> None:
    opacity = np.zeros((5, 9))
    opacity[2, 4:] = 1.0
    found = {divmod(int(k), 9) for k in edge_rays(opacity)}
    beside = {(2, c) for c in range(3, 9)} | {
        (r, c) for r in (1, 3) for c in range(4, 9)
    }
    assert found == beside
    assert not len(edge_rays(np.zeros((5, 9)))), "no step, no edge"


def test_of_many_steep_rays_the_steepest_are_taken() -> None:
    opacity = np.cumsum(np.arange(200.0)[::-1]).reshape(1, 200)
    found = edge_rays(opacity)
    assert found.tolist() == list(range(48)), "the steps fall along the row"
    rows = np.cumsum(np.arange(200.0)[::-1]).reshape(200, 1)
    assert edge_rays(rows).tolist() == found.tolist()


def test_a_bright_spot_of_few_rays_is_checked() -> None:
    """A narrow lobe behind a thick part: opacity changes little where light does."""
    medium = Medium(6.0, 1.0, 0.9, "hg")
    how = {**HOW, "suns": Sun([-1.5, -1.0, -3.2]), "medium": medium}
    exact = render(cloud(24, filled=True), **how)
    found = render(cloud(24, filled=True), **how, tolerance=0.1)
    assert np.abs(found.linear - exact.linear).max() <= 0.1
