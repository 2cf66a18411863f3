"""What has its pixels for itself is drawn in another order, and nothing shows of it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.camera import drawn_camera
from twins.triangles import drawn_mesh

from refcloud.camera import Camera, rays
from refcloud.raster import (
    Blending,
    Mesh,
    State,
    draw_triangles,
    framebuffer,
    plane_mesh,
    sphere_mesh,
)
from refcloud.raster.spans import Spans

SIZE = {"width": 16, "height": 12}
OVER = Blending("SRC_ALPHA", "ONE_MINUS_SRC_ALPHA")
STATES = [
    State(),
    State(blending=OVER),
    State(depth_func="LESS"),
    State(depth_func="LEQUAL", depth_mask=False),
    State(depth_func="GEQUAL", blending=OVER),
    State(depth_func="NOTEQUAL"),
]
stretches = st.tuples(st.integers(0, 5), st.integers(0, 20), st.integers(1, 6))


def spans_of(listed) -> Spans:
    row, first, count = np.array(listed, np.int64).reshape(-1, 3).T
    return Spans(np.arange(len(row)), row, first, count)


@given(st.lists(stretches, max_size=12), st.sampled_from([0, 70_000]))
def test_spans_are_parted_by_whether_they_share_pixels(listed, beyond) -> None:
    spans = spans_of([(row + beyond, first, count) for row, first, count in listed])
    alone, others = spans.parted()
    pixels = [
        {(row, column) for column in range(first, first + count)}
        for row, first, count in listed
    ]
    shared = [
        any(own & other for j, other in enumerate(pixels) if j != i)
        for i, own in enumerate(pixels)
    ]
    assert others.triangle.tolist() == np.flatnonzero(shared).tolist()
    expected = sorted(np.flatnonzero(~np.array(shared, bool)), key=lambda i: listed[i])
    assert alone.triangle.tolist() == expected


@pytest.mark.parametrize("state", STATES)
@settings(max_examples=10)
@given(data=st.data())
def test_the_picture_is_the_one_in_drawing_order(state, data) -> None:
    camera = drawn_camera(data.draw)
    camera = type(camera)(**{**vars(camera), **SIZE})
    ball = sphere_mesh(5, 4)
    mesh = drawn_mesh(data.draw, 1)
    mesh = Mesh(
        np.concatenate([mesh.points, ball.points]),
        np.concatenate([mesh.faces, ball.faces + len(mesh.points)]),
        np.concatenate([mesh.attributes, ball.attributes[:, :1]]),
    )

    def shade(f) -> np.ndarray:
        ones = np.ones(len(f.column))
        return np.stack([f.values[0], f.triangle * ones, f.depth, 0.4 * ones], axis=1)

    def drawn() -> tuple[np.ndarray, np.ndarray]:
        buffer = framebuffer(16, 12, depth=0.9)
        draw_triangles(buffer, camera, mesh, shade, state=state, near=0.1, far=50.0)
        return buffer.pixels, buffer.depth

    found = drawn()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Spans, "parted", lambda s: (s.some(slice(0, 0)), s))
        expected = drawn()
    np.testing.assert_array_equal(found[0], expected[0])
    np.testing.assert_array_equal(found[1], expected[1])


def test_a_picture_in_one_layer_is_written_as_it_lies_in_memory() -> None:
    ball = sphere_mesh(24, 18)
    inside = Camera([0, 0, 0], [0.2, 0.1, 1], **SIZE)
    seen: list = []
    draw_triangles(
        framebuffer(16, 12),
        inside,
        ball,
        lambda f: seen.append(f.pixel(16)) or np.ones((len(f.column), 4)),
    )
    assert seen == [slice(0, 16 * 12)]


@settings(max_examples=10)
@given(st.floats(0.05, 0.8), st.floats(-0.3, 0.3), st.integers(1, 30))
def test_nothing_pops_as_the_near_plane_sweeps(height, turn, cells) -> None:
    # A floor below the eye shows at a pixel if it meets the pixel's ray beyond near.
    camera = Camera([turn, height, 0], [0, 0.5 * height, -1], fov_y=1.5, **SIZE)
    floor = plane_mesh(cells, cells, width=1e4, depth=1e4)
    origins, directions = rays(camera)
    ahead = np.subtract(camera.target, camera.eye) / np.linalg.norm(
        np.subtract(camera.target, camera.eye)
    )
    down = np.maximum(-directions[..., 1], 1e-9)
    depth = origins[..., 1] / down * (directions @ ahead)
    before = None
    for near in np.geomspace(1e-3, 4.0, 12):
        buffer = framebuffer(16, 12)
        draw_triangles(buffer, camera, floor, [1.0] * 4, near=near)
        shown = buffer.pixels[..., 0] == 1.0
        sure = (directions[..., 1] < -0.02) & (np.abs(depth / near - 1.0) > 0.02)
        np.testing.assert_array_equal(shown[sure], (depth > near)[sure])
        assert before is None or not (shown & ~before).any()
        before = shown


def test_depths_beyond_those_of_first_corners_are_kept() -> None:
    camera = Camera([0, 0, 1], [0, 1, 0], [0, 1, 0], 1.0, **SIZE)
    mesh = Mesh(np.array([[0.0, 0, 0], [0, 1, 0], [1, 0, 0]]), [[0, 1, 2]], [[1.0]] * 3)
    for turn in range(3):
        turned = dataclasses.replace(mesh, faces=np.roll(mesh.faces, turn, axis=1))
        found = framebuffer(16, 12)
        draw_triangles(found, camera, turned, lambda f: f.values.T * np.ones(4))
        shown = found.pixels[found.pixels[..., 3] != 0.0]
        assert len(shown) > 20
        np.testing.assert_allclose(shown, 1.0, rtol=0, atol=1e-12)
