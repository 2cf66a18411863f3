"""Lines with a depth test: hidden, hiding, in turn, and cut by the far plane."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refcloud.camera import Camera, OrthographicCamera
from refcloud.raster import (
    State,
    draw_lines,
    draw_triangles,
    framebuffer,
    lines,
    plane_mesh,
)

EYE = Camera([0.0, 1.0, 3.0], [0.0, 0.0, 0.0], fov_y=1.0, width=32, height=24)
RED, BLUE = [1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]
NEAREST = {"depth_func": "LESS", "near": 0.1, "far": 20.0}
ends = st.tuples(*[st.floats(-1.5, 1.5)] * 3)


def drawn(listed, color=RED, *, behind=None, **how) -> np.ndarray:
    buffer = framebuffer(32, 24, depth=1.0)
    if behind is not None:
        state = State(depth_func="LESS")
        places = {"near": 0.1, "far": 20.0}
        draw_triangles(buffer, EYE, behind, BLUE, state=state, **places)
    draw_lines(buffer, EYE, listed, color=color, **how)
    return buffer.pixels


def test_a_floor_hides_what_is_below_it() -> None:
    floor = plane_mesh(1, 1, width=9.0, depth=9.0)
    upright = [[[0.3, -1.0, 0.0], [0.3, 1.0, 0.0]]]
    whole = drawn(upright)[..., 0] == 1.0
    shown = drawn(upright, behind=floor, **NEAREST)[..., 0] == 1.0
    above = drawn([[[0.3, 0.0, 0.0], [0.3, 1.0, 0.0]]])[..., 0] == 1.0
    assert 0 < shown.sum() < whole.sum()
    # Where it meets the floor a pixel may go either way.
    assert np.count_nonzero(shown != above) <= 1


@settings(max_examples=30)
@given(st.lists(st.tuples(ends, ends), min_size=1, max_size=5), st.booleans())
def test_lines_together_are_lines_one_by_one(listed, tests) -> None:
    how = NEAREST if tests else {}
    half = [0.2, 0.6, 1.0, 0.5]
    together, alone = framebuffer(32, 24, depth=1.0), framebuffer(32, 24, depth=1.0)
    draw_lines(together, EYE, listed, color=half, **how)
    for one in listed:
        draw_lines(alone, EYE, [one], color=half, **how)
    np.testing.assert_array_equal(together.pixels, alone.pixels)
    np.testing.assert_array_equal(together.depth, alone.depth)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(lines, "AT_ONCE", 40)
        parts = framebuffer(32, 24, depth=1.0)
        draw_lines(parts, EYE, listed, color=half, **how)
    np.testing.assert_array_equal(together.pixels, parts.pixels)


def test_the_far_plane_cuts_lines() -> None:
    away = [[[0.0, 0.5, 2.0], [0.5, 0.5, -30.0]]]
    whole, cut = drawn(away), drawn(away, far=6.0)
    shown, left = whole[..., 0] > 0.0, cut[..., 0] > 0.0
    assert 0 < left.sum() < shown.sum()
    assert not (left & ~shown).any()
    assert not drawn([[[0, 0, -9.0], [1, 0, -9.0]]], far=6.0).any()


def test_the_depths_are_those_of_the_line() -> None:
    # One unit to the pixel: from depth 1 at the left edge to 3 at the right one.
    view = OrthographicCamera(
        [0, 0, 2], [0, 0, 0], height_of_view=2.0, width=8, height=2
    )
    buffer = framebuffer(8, 2, depth=1.0)
    line = [[[-4.0, 0.5, 1.0], [4.5, 0.5, -1.125]]]
    draw_lines(buffer, view, line, color=RED, depth_func="LESS", near=0.5, far=4.5)
    assert buffer.depth is not None
    expected = (1.0 + (np.arange(8) + 0.5) / 4.0 - 0.5) / 4.0
    np.testing.assert_allclose(buffer.depth[0], expected, rtol=0, atol=1e-12)
    assert (buffer.depth[1] == 1.0).all()


def test_refusals_name_the_argument_in_one_line() -> None:
    view = OrthographicCamera([0, 0, 2], [0, 0, 0], width=8, height=2)
    none = np.zeros((0, 2, 3))
    for how, message in (
        ({"far": 1e-4}, "far: expected a depth beyond near"),
        ({"depth_func": "LESS"}, "far: expected a depth for the depth test"),
        ({"depth_func": "MORE"}, "depth_func: expected"),
    ):
        with pytest.raises(ValueError, match=rf"^{message}[^\n]*$"):
            draw_lines(framebuffer(8, 2), view, none, color=RED, **how)
