"""Pictures of a fit: what they show, and what their error says."""

from __future__ import annotations

import numpy as np

from refcloud.cloudmap import generate
from refcloud.cloudmap.voxels import VoxelGrid
from refcloud.fit_pictures import GAP, fit_pictures
from refcloud.metaballs import Metaballs, approximate, voxel_balls

GRID = generate(diameters=[20, 11, 11], cell=3, relief=2, voxel=1)
SIZE = {"width": 32, "height": 24}


def test_the_picture_errs_less_with_more_balls():
    errors = [
        fit_pictures(GRID, approximate(GRID, count=n), **SIZE).error
        for n in (5, 50, 500)
    ]
    assert errors[0] > errors[1] > errors[2] > 0.0
    assert fit_pictures(GRID, voxel_balls(GRID), **SIZE).error == 0.0


def test_the_error_is_relative_to_the_voxels_picture():
    nothing = Metaballs(np.zeros((0, 3)), np.zeros(0), np.zeros(0))
    assert fit_pictures(GRID, nothing, **SIZE).error == 1.0
    empty = VoxelGrid(np.zeros((2, 2, 2)), [0, 0, 0], [1, 1, 1])
    assert fit_pictures(empty, nothing, **SIZE).error == 0.0
    some = Metaballs([[0.5, 0.5, 0.5]], [1.0], [1.0])
    assert fit_pictures(empty, some, **SIZE).error == np.inf


def test_panels_are_voxels_balls_and_difference():
    balls = approximate(GRID, count=20)
    found = fit_pictures(GRID, balls, **SIZE)
    again = fit_pictures(GRID, balls, voxels=found.voxels, **SIZE)
    assert again.error == found.error
    row = found.side_by_side().linear
    assert row.shape == (24, 3 * 32 + 2 * GAP, 3)
    first, second, third = (row[:, i * (32 + GAP) :][:, :32] for i in range(3))
    assert (first == found.voxels.linear).all()
    assert (second == found.balls.linear).all()
    assert (third == np.abs(first - second)).all()
    assert (row[:, 32 : 32 + GAP] == 1.0).all()
