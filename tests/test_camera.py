"""Cameras: rays and projection are each other's inverse, at any place and angle."""

from __future__ import annotations

import dataclasses
import math
import tracemalloc

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from twins.camera import coordinates, drawn_camera, places

from refcloud.camera import (
    FOV_Y,
    NARROWEST,
    Camera,
    OrthographicCamera,
    axes,
    frame,
    project,
    rays,
)
from refcloud.conventions import MOST_PIXELS

cameras = st.composite(drawn_camera)()
pinholes = st.composite(drawn_camera)(kinds="pinhole")
# A pixel's place is known to this share of the picture: directions have 15 digits.
PLACED = 1e-9
SMALL = 1e7  # bytes: reading annotations takes 1e6, the refused pictures 1e9


def centres(camera) -> np.ndarray:
    j, i = np.mgrid[: camera.height, : camera.width] + 0.5
    return np.stack([i, j], axis=-1).reshape(-1, 2)


@given(cameras, st.floats(0.1, 100.0))
def test_points_along_a_ray_show_at_its_pixel(camera, far: float) -> None:
    origins, directions = rays(camera)
    points = (origins + far * directions).reshape(-1, 3)
    x, y, depth, scale = project(camera, points)
    size = max(camera.width, camera.height)
    np.testing.assert_allclose(
        np.stack([x, y], axis=1), centres(camera), rtol=0.0, atol=PLACED * size
    )
    assert (scale > 0.0).all()
    forward = -(directions.reshape(-1, 3) @ axes(camera)[2])
    np.testing.assert_allclose(depth, far * forward, rtol=1e-9, atol=1e-12)


@given(cameras)
def test_rays_have_length_1(camera) -> None:
    _, directions = rays(camera)
    assert directions.shape == (camera.height, camera.width, 3)
    lengths = np.sqrt(np.square(directions).sum(axis=-1))
    np.testing.assert_allclose(lengths, 1.0, rtol=0.0, atol=5e-16)


@given(cameras)
def test_the_frame_is_right_handed_and_upright(camera) -> None:
    right, up, back = frame_of = axes(camera)
    np.testing.assert_allclose(frame_of @ frame_of.T, np.eye(3), rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(np.cross(right, up), back, rtol=0.0, atol=1e-12)
    assert up @ camera.up >= -1e-12 * math.hypot(*camera.up)
    assert back @ (camera.eye - camera.target) > 0.0


@given(cameras)
def test_the_target_shows_in_the_middle(camera) -> None:
    x, y, depth, _ = project(camera, camera.target[None])
    middle = [0.5 * camera.width, 0.5 * camera.height]
    np.testing.assert_allclose([x[0], y[0]], middle, rtol=0.0, atol=1e-10)
    far = math.dist(camera.eye, camera.target)
    assert depth[0] == pytest.approx(far, rel=1e-12)


@given(cameras, st.floats(0.01, 1.0))
def test_what_is_upward_shows_nearer_to_row_0(camera, step: float) -> None:
    right, up, _ = axes(camera)
    points = camera.target + step * np.array([np.zeros(3), up, right])
    x, y, _, scale = project(camera, points)
    assert y[1] < y[0]
    assert x[2] > x[0]
    # In the target's plane one scene unit is `scale` pixels.
    assert y[0] - y[1] == pytest.approx(step * scale[0], rel=1e-9)


@given(pinholes, st.floats(0.0, 50.0), coordinates, coordinates)
def test_points_behind_a_pinhole_have_no_scale(camera, far, aside, above) -> None:
    right, up, back = axes(camera)
    assume(far > 1e-9)
    point = camera.eye + far * back + aside * right + above * up
    x, y, depth, scale = project(camera, point[None])
    assert depth[0] < 0.0
    assert scale[0] == 0.0
    assert (x[0], y[0]) == (0.5 * camera.width, 0.5 * camera.height)


@given(st.sampled_from([0.0, 1e-320, 1e-300, 1e-200, 1e-100]), st.floats(-1e9, 1e9))
def test_points_beside_the_eye_overflow_nothing(depth: float, aside: float) -> None:
    camera = Camera([0, 0, 0], [0, 0, -1])
    found = project(camera, [[aside, -aside, -depth]])
    assert all(np.isfinite(part).all() for part in found)


@given(cameras, places)
def test_nothing_changes_far_from_home(camera, point) -> None:
    _, _, depth, _ = project(camera, [point])
    across = np.cross(camera.up / math.hypot(*camera.up), axes(camera)[2])
    # Where `up` is nearly along the view, rounding may choose another axis for it.
    assume(abs(depth[0]) > 0.1 and math.hypot(*across) > 0.01)
    away = np.array([1e6, -1e6, 1e6])
    moved = dataclasses.replace(
        camera, eye=camera.eye + away, target=camera.target + away
    )
    near, far = project(camera, [point]), project(moved, np.add(point, away)[None])
    # Places there are known to 1e-10, directions over 0.1 to 1e-9, and frames whose
    # `up` is a hundredth off the view to 1e-7; 2400 pixels show per unit at depth 0.1.
    for a, b in zip(near, far, strict=True):
        np.testing.assert_allclose(b, a, rtol=1e-5, atol=3e-3)


@given(cameras, st.lists(places, min_size=2, max_size=9), st.randoms())
def test_a_points_bits_do_not_depend_on_its_row(camera, points, chance) -> None:
    order = list(range(len(points)))
    chance.shuffle(order)
    table = np.array(points)
    straight = np.stack(project(camera, table))
    np.testing.assert_array_equal(
        np.stack(project(camera, table[order])), straight[:, order]
    )


def test_looking_along_up_another_axis_serves() -> None:
    for way in np.vstack([np.eye(3), -np.eye(3)]):
        frame_of = axes(Camera([0, 0, 0], way, up=way))
        np.testing.assert_allclose(frame_of @ frame_of.T, np.eye(3), atol=1e-15)


def test_an_orthographic_camera_sees_parallel_rays_at_one_scale() -> None:
    camera = OrthographicCamera(
        [1, 2, 3], [1, 2, -3], height_of_view=4.0, width=6, height=8
    )
    origins, directions = rays(camera)
    assert (directions == [0.0, 0.0, -1.0]).all()
    assert np.ptp(origins[..., 0]) == pytest.approx(5 * 0.5)
    x, _, depth, scale = project(camera, [[1, 2, 5], [1.5, 2, -50]])
    assert scale.tolist() == [2.0, 2.0]
    assert depth.tolist() == [-2.0, 53.0]
    assert x.tolist() == [3.0, 4.0]


@pytest.mark.parametrize("angle", [NARROWEST, 1e-3, 3.1, math.nextafter(math.pi, 0.0)])
def test_both_ends_of_the_field_of_view(angle: float) -> None:
    camera = Camera([0, 0, 1], [0, 0, 0], fov_y=angle, width=3, height=3)
    origins, directions = rays(camera)
    points = (origins + directions).reshape(-1, 3)
    found = project(camera, points)
    assert all(np.isfinite(part).all() for part in found)
    if angle < 3.0:
        places_ = np.stack(found[:2], axis=1)
        # One last bit of a direction against the angle of one pixel.
        atol = 1e-15 * 3 / angle + 1e-12
        np.testing.assert_allclose(places_, centres(camera), rtol=0.0, atol=atol)
        assert len(np.unique(directions.reshape(-1, 3), axis=0)) == 9


@given(places, places, st.integers(1, 50), st.integers(1, 50), st.floats(1.0, 3.0))
def test_frame_shows_every_corner_of_the_box(a, b, width, height, margin) -> None:
    lower, upper = np.minimum(a, b), np.maximum(a, b)
    camera = frame(lower, upper, width=width, height=height, margin=margin)
    assert (camera.width, camera.height, camera.fov_y) == (width, height, FOV_Y)
    corners = np.stack(np.meshgrid(*np.stack([lower, upper], axis=1)), -1).reshape(
        -1, 3
    )
    x, y, depth, _ = project(camera, corners)
    assert (depth > 0.0).all()
    across = np.abs(x / width - 0.5) * 2.0 * margin
    down = np.abs(y / height - 0.5) * 2.0 * margin
    farthest = max(across.max(), down.max())
    assert farthest <= 1.0 + 1e-9
    if np.linalg.norm(upper - lower) > 0.1:
        assert farthest == pytest.approx(1.0), "and no farther off than needed"


@pytest.mark.parametrize("place", [0.0, 1.0, 1e6])
def test_frame_of_a_box_without_size(place: float) -> None:
    camera = frame(np.full(3, place), np.full(3, place))
    assert math.dist(camera.eye, camera.target) > 0.0


EYE = {"eye": [0, 0, 1], "target": [0, 0, 0]}


@pytest.mark.parametrize("kind", [Camera, OrthographicCamera])
@pytest.mark.parametrize(
    ("given_", "message"),
    [
        (EYE | {"target": [0, 0, 1]}, "target: expected another place than the eye"),
        ({"eye": [1e308, 0, 0], "target": [-1e308, 0, 0]}, "target: expected another"),
        (EYE | {"eye": [0, math.nan, 0]}, "eye: expected"),
        (EYE | {"up": [0, 0, 0]}, "up: expected a vector that is not zero"),
        (EYE | {"width": 0}, "width: expected a whole number"),
        (
            EYE | {"width": 3843, "height": 2160},
            "width: expected at most 8.3 megapixels",
        ),
        (EYE | {"width": 10**6, "height": 10**6}, "width: expected at most 8.3"),
    ],
)
def test_refusals_come_in_one_line_before_memory_is_taken(
    kind, given_, message
) -> None:
    tracemalloc.start()
    with pytest.raises(ValueError, match=rf"^{message}[^\n]*$"):
        kind(**given_)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < SMALL


@pytest.mark.parametrize("angle", [0.0, 5e-324, 1e-10, math.pi, 4.0, -1.0])
def test_angles_beyond_the_ends_are_refused(angle: float) -> None:
    with pytest.raises(ValueError, match="fov_y: expected a finite number in"):
        Camera(**EYE, fov_y=angle)


def test_the_largest_picture_is_accepted() -> None:
    assert Camera(**EYE, width=MOST_PIXELS, height=1).width == MOST_PIXELS


def test_a_picture_of_3840_x_2160_is_accepted() -> None:
    assert 3840 * 2160 <= MOST_PIXELS  # 300 bytes a pixel, measured, are then 2.5 GB
