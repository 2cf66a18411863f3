"""The box from two opposite corners: its corners, lines and walls; what fills it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.box import drawn_box
from twins.cloudmap import axes, grids

from refcloud.cloudmap import (
    VoxelGrid,
    box_cloud,
    box_corners,
    box_coverage,
    box_lines,
    box_triangles,
    cell_centres,
    placed_texture,
    resized_box,
    trilinear,
    worley_smooth_texture,
)
from refcloud.noise import remap, worley_smooth

BOX = [0, 0, 0], [3, 2, 1]


@given(st.data())
def test_f09_any_two_opposite_corners_give_the_same_box(data) -> None:
    first, second = drawn_box(data.draw)
    corners = box_corners(first, second)
    ends = np.sort(np.stack([first, second]), axis=0)
    np.testing.assert_array_equal(corners, box_corners(*ends))
    assert len({tuple(corner) for corner in corners.tolist()}) == 8
    for corner in (first, second):
        assert (corners == corner).all(axis=1).sum() == 1


@given(st.data())
def test_f07_twelve_lines_are_four_along_each_axis(data) -> None:
    first, second = drawn_box(data.draw)
    step = np.diff(box_lines(first, second), axis=1)[:, 0]
    lengths = np.abs(second - first)
    for axis in range(3):
        mine = step[4 * axis : 4 * axis + 4]
        expected = np.tile(np.eye(3)[axis] * lengths, (4, 1))
        np.testing.assert_array_equal(mine, expected)


@given(st.data())
def test_f08_the_walls_close_the_box_and_look_outward(data) -> None:
    first, second = drawn_box(data.draw)
    a, b, c = box_triangles(first, second).transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    size = np.abs(second - first)
    surface = 2.0 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0])
    area = 0.5 * np.linalg.norm(normals, axis=1).sum()
    assert area == pytest.approx(surface, rel=1e-12)
    # Gauss: a closed surface that looks outward holds its volume.
    volume = (a * normals).sum() / 6.0
    scale = np.abs([first, second]).max() * surface
    assert volume == pytest.approx(math.prod(size), abs=1e-12 * scale)
    middle = 0.5 * (first + second)
    assert (((a - middle) * normals).sum(axis=1) > 0.0).all()


@given(st.data(), axes)
def test_f09_a_box_is_resized_about_its_middle(data, lengths) -> None:
    first, second = drawn_box(data.draw)
    lower, upper = resized_box(first, second, lengths)
    np.testing.assert_allclose(upper - lower, lengths, rtol=0.0, atol=1e-14)
    middle = np.add(first, second)
    np.testing.assert_allclose(lower + upper, middle, rtol=0.0, atol=1e-14)


@settings(max_examples=30)
@given(st.data(), grids())
def test_a_placed_texture_is_stretched_with_its_box(data, texture) -> None:
    first, second = drawn_box(data.draw)
    placed = placed_texture(texture, first, second)
    share = np.array([[0.1, 0.5, 0.9], [0.7, 0.3, 0.45]])
    size = placed.upper - placed.lower
    there = trilinear(placed, placed.lower + share * size)
    here = trilinear(texture, texture.lower + share * (texture.upper - texture.lower))
    np.testing.assert_allclose(there, here, rtol=0.0, atol=1e-12)


def test_v09_textures_side_by_side_show_no_seam() -> None:
    texture = worley_smooth_texture(16, cells=2, seed=3)
    twice = placed_texture(texture, [0, 0, 0], [2, 1, 1], repeats=(2, 1, 1))
    across = np.abs(np.diff(twice.density, axis=2))
    assert across[..., 15].max() <= 1.25 * across[..., :15].max()


def test_a_box_of_noise_shows_more_of_the_world_when_it_grows() -> None:
    how = {"voxel": 0.25, "cell": 0.8, "seed": 4}
    small = box_cloud([0, 0, 0], [1, 1, 1], **how).density
    large = box_cloud([-1, 0, 0], [2, 1, 2], **how).density
    np.testing.assert_allclose(large[:4, :, 4:8], small, rtol=0.0, atol=1e-12)


def test_without_an_edge_it_is_the_noise_above_the_threshold() -> None:
    box = box_cloud([0, 0, 0], [1, 2, 3], voxel=0.5, cell=2, seed=1, threshold=0.5)
    x, y, z = cell_centres(box)
    points = np.stack(np.broadcast_arrays(*np.ix_(z, y, x))[::-1], axis=-1)
    noise = worley_smooth(points / 2.0, seed=1)
    expected = np.maximum(remap(noise, 0.5, 1.0, 0.0, 1.0), 0.0)
    np.testing.assert_allclose(box.density, expected, rtol=0.0, atol=1e-14)


@settings(max_examples=30)
@given(st.data(), st.floats(0.05, 0.5))
def test_cloud_ends_before_the_walls(data, share) -> None:
    first, second = drawn_box(data.draw)
    edge = share * float(np.abs(second - first).min())
    lower, upper = np.minimum(first, second), np.maximum(first, second)
    line = [
        np.array([low - 0.1, low, low + edge, 0.5 * (low + high), high, high + 0.1])
        for low, high in zip(lower, upper, strict=True)
    ]
    cover = box_coverage(*line, first=first, second=second, edge=edge)
    assert not cover[[0, 1, 4, 5]].any()
    assert not cover[:, :, [0, 1, 4, 5]].any()
    np.testing.assert_allclose(cover[3, 3, 2:4], 1.0, rtol=0.0, atol=1e-9)
    assert cover.min() >= 0.0
    assert cover.max() <= 1.0


def test_densities_stay_within_one_and_shrink_with_the_edge() -> None:
    how = {"voxel": 0.25, "cell": 1.0, "seed": 2, "threshold": 0.4}
    whole = box_cloud(*BOX, **how).density
    thinned = box_cloud(*BOX, edge=0.5, **how).density
    assert whole.max() <= 1.0
    assert (thinned <= whole + 1e-15).all()
    assert 0.0 < thinned.sum() < whole.sum()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: box_corners([0, 0, 0], [1, 0, 1]), "second: expected the opposite"),
        (lambda: box_lines([0, 0], [1, 1]), "first: expected an array of shape"),
        (lambda: resized_box(*BOX, [1, 0, 1]), "lengths: expected numbers in"),
        (lambda: resized_box([1e20] * 3, [2e20] * 3, [1, 1, 1]), "second: expected"),
        (lambda: box_cloud(*BOX, voxel=1e-5, cell=1), "voxel: expected at most"),
        (lambda: box_cloud([-1e308] * 3, [1e308] * 3, voxel=1, cell=1), "voxel: exp"),
        (lambda: box_cloud(*BOX, voxel=0, cell=1), "voxel: expected a finite number"),
        (lambda: box_cloud(*BOX, voxel=1, cell=1, edge=-1), "edge: expected a finite"),
        (
            lambda: placed_texture(
                VoxelGrid(np.ones((8, 8, 8)), *BOX), *BOX, repeats=(1 << 20, 1, 1)
            ),
            "repeats: expected at most",
        ),
        (
            lambda: placed_texture(
                VoxelGrid(np.ones((1, 1, 1)), *BOX), *BOX, repeats=(0, 1, 1)
            ),
            r"repeats\[0\]: expected a whole number",
        ),
    ],
)
def test_refusals_name_the_argument_in_one_line(call, message: str) -> None:
    with pytest.raises(ValueError, match=rf"^{message}[^\n]*$"):
        call()
