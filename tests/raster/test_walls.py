"""The box's parts lie behind and before the cloud."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from twins.camera import drawn_camera
from twins.walls import listed

from refcloud.camera import Camera, OrthographicCamera, project
from refcloud.cloudmap import box_corners, box_lines, box_triangles
from refcloud.raster import (
    Blending,
    State,
    draw_box,
    draw_lines,
    draw_triangles,
    faces_away,
    framebuffer,
    line_pixels,
)
from refcloud.raster.meshes import separate
from refcloud.raster.walls import LIGHT_BLUE, ORANGE

SIZE = {"width": 16, "height": 12}
ONCE = {"shade": np.ones(4), "state": State(blending=Blending("ONE", "ONE"))}
BOX = [-1.0, -0.8, -0.6], [1.0, 0.8, 0.6]
NONE = [0.0, 0.0, 0.0, 0.0]


@settings(max_examples=60)
@given(st.data())
def test_f08_each_pixel_of_the_box_has_one_wall_behind_and_one_before(data) -> None:
    camera = drawn_camera(data.draw)
    big = {"width": 24, "height": 18}
    camera = type(camera)(**{**vars(camera), **big})
    eye = camera.eye
    lower, upper = np.array(BOX)
    if isinstance(camera, Camera):  # outside, and the whole box before the eye
        assume(((eye < lower - 0.01) | (eye > upper + 0.01)).any())
    assume((project(camera, box_corners(*BOX))[2] > 0.05).all())
    triangles = box_triangles(*BOX)
    away = faces_away(camera, triangles)
    behind, before = framebuffer(24, 18), framebuffer(24, 18)
    draw_triangles(behind, camera, separate(triangles[away]), **ONCE)
    draw_triangles(before, camera, separate(triangles[~away]), **ONCE)
    np.testing.assert_array_equal(behind.pixels, before.pixels)
    assert behind.pixels.max() <= 1.0


@settings(max_examples=40)
@given(st.tuples(*[st.floats(-0.55, 0.55)] * 3), st.tuples(*[st.floats(-9, 9)] * 3))
def test_inside_the_box_every_wall_is_behind(eye, target) -> None:
    assume(np.abs(np.subtract(target, eye)).max() > 0.1)
    camera = Camera(eye, target, fov_y=2.0, width=12, height=9)
    buffer = framebuffer(12, 9)
    draw_box(buffer, camera, *BOX, "before")
    assert not buffer.pixels.any()
    draw_triangles(buffer, camera, separate(box_triangles(*BOX)), **ONCE)
    # In whichever direction one looks, one wall is there, with no seam.
    np.testing.assert_array_equal(buffer.pixels, np.ones((9, 12, 4)))


@settings(max_examples=40)
@given(st.data())
def test_every_line_and_wall_is_drawn_in_one_part(data) -> None:
    camera = drawn_camera(data.draw)
    camera = type(camera)(**{**vars(camera), "width": 16, "height": 12})
    both, all_of_it = framebuffer(16, 12), framebuffer(16, 12)
    opaque = {"line_color": [1.0, 0.0, 0.0, 1.0], "wall_color": NONE}
    for part in ("behind", "before"):
        draw_box(both, camera, *BOX, part, **opaque)
    draw_lines(all_of_it, camera, box_lines(*BOX), color=[1.0, 0.0, 0.0, 1.0])
    np.testing.assert_array_equal(both.pixels, all_of_it.pixels)


def test_f07_f08_the_cloud_stands_between() -> None:
    camera = Camera([3, 2.2, 5], [0, 0, 0], width=64, height=48)
    buffer = framebuffer(64, 48, color=[0.0, 0.0, 0.0, 1.0])
    middle = 24, 32
    draw_box(buffer, camera, *BOX, "behind")
    np.testing.assert_allclose(buffer.pixels[middle][:3], 0.5 * LIGHT_BLUE[:3])
    buffer.pixels[middle] = 0.0, 0.0, 0.0, 1.0  # an opaque cloud hides what is behind
    draw_box(buffer, camera, *BOX, "before")
    np.testing.assert_allclose(buffer.pixels[middle][:3], 0.5 * LIGHT_BLUE[:3])
    # The lines in front are not covered: orange to the last bit.
    orange = (buffer.pixels == ORANGE).all(axis=2)
    x, y, _, _ = project(camera, [[1.0, -0.8, 0.6], [1.0, 0.8, 0.6]])
    front = line_pixels([x[0], y[0]], [x[1], y[1]], width=64, height=48)
    assert orange[front].all()
    # Those behind are seen through a wall.
    x, y, _, _ = project(camera, [[-1.0, -0.8, -0.6], [-1.0, 0.8, -0.6]])
    rear = listed(*line_pixels([x[0], y[0]], [x[1], y[1]], width=64, height=48))
    seen = buffer.pixels[rear[len(rear) // 2]]
    np.testing.assert_allclose(seen[:3], 0.5 * (LIGHT_BLUE + ORANGE)[:3], atol=1e-12)


def test_an_orthographic_eye_is_outside_wherever_it_stands() -> None:
    camera = OrthographicCamera([0, 0, 0.2], [0, 0, 0], width=8, height=6)
    away = faces_away(camera, box_triangles(*BOX))[::2]
    # -x +x -y +y -z +z: those seen edge on count as behind; they cover nothing.
    assert away.tolist() == [True, True, True, True, True, False]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: draw_box(
                framebuffer(4, 4), Camera([0, 0, 9], [0, 0, 0]), *BOX, "behind"
            ),
            "buffer: expected shape",
        ),
        (
            lambda: draw_box(
                framebuffer(16, 12),
                Camera([0, 0, 9], [0, 0, 0], **SIZE),
                [0, 0, 0],
                [1, 0, 1],
                "behind",
            ),
            "second: expected the opposite corner",
        ),
        (
            lambda: draw_box(
                framebuffer(16, 12), Camera([0, 0, 9], [0, 0, 0], **SIZE), *BOX, "left"
            ),
            "part: expected one of",
        ),
    ],
)
def test_refusals_name_the_argument_in_one_line(call, message: str) -> None:
    with pytest.raises(ValueError, match=rf"^{message}[^\n]*$"):
        call()
