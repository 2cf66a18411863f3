"""Lines: what the diamond-exit rule promises, and what is cut off."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.walls import listed, place, spots

from refcloud.camera import Camera, OrthographicCamera, project
from refcloud.raster import draw_lines, framebuffer, line_pixels

SIZE = {"width": 16, "height": 12}
ORANGE = [1.0, 0.5, 0.0, 1.0]
FRONT = OrthographicCamera([8, 6, 1], [8, 6, 0], height_of_view=12.0, **SIZE)


def pixels(start, end, **how) -> list:
    return listed(*line_pixels(start, end, **(SIZE | how)))


@given(
    spots,
    st.tuples(st.integers(-900, 900), st.integers(-900, 900)),
    st.integers(0, 4),
    st.integers(0, 4),
)
def test_lines_that_go_on_draw_no_pixel_twice_and_leave_none_out(a, step, m, n) -> None:
    start = np.floor(np.array(a) * 256.0 + 0.5) / 256.0
    middle, end = (start + k * np.array(step) / 256.0 for k in (m, m + n))
    first, second = pixels(start, middle), pixels(middle, end)
    assert not set(first) & set(second)
    assert sorted(first + second) == pixels(start, end)


@given(spots, spots)
def test_the_way_back_differs_at_the_ends_alone(a, b) -> None:
    there, back = set(pixels(a, b)), set(pixels(b, a))
    ends = {(int(y // 1), int(x // 1)) for x, y in (a, b)}
    # An end on a pixel's border belongs to a diamond beside it.
    near = {(r + i, c + j) for r, c in ends for i in (-1, 0, 1) for j in (-1, 0, 1)}
    assert there ^ back <= near
    assert len(there ^ back) <= 2


@given(spots, spots, st.integers(1, 4))
def test_a_window_shows_its_part_of_a_line(a, b, thickness) -> None:
    how = {"thickness": thickness}
    large = line_pixels(a, b, width=40, height=40, **how)
    small = pixels(a, b, **how)
    inside = (large[0] < 12) & (large[1] < 16)
    assert small == listed(large[0][inside], large[1][inside])


@given(place, place, st.integers(1, 5), st.booleans())
def test_a_thick_line_has_its_pixels_across(a, b, thickness, upright) -> None:
    start, end = [20.0 + a, 30.0], [20.0 + b, 30.0]
    if upright:
        start, end = start[::-1], end[::-1]
    size = {"width": 64, "height": 64}
    thin = line_pixels(start, end, **size)
    thick = line_pixels(start, end, thickness=thickness, **size)
    columns, left = divmod(len(thick[0]), thickness)
    assert left == 0
    # Moved by half a pixel, a line may end in another diamond.
    assert abs(columns - len(thin[0])) <= (0 if thickness % 2 else 2)
    across = thick[1] if upright else thick[0]
    if across.size:
        middle = 0.5 * (across.min() + across.max() + 1)
        assert abs(middle - 30.0) <= 0.5


@given(spots)
def test_a_line_of_no_length_draws_nothing(a) -> None:
    assert pixels(a, a) == []


def test_a_level_line_through_centres_draws_whole_pixels() -> None:
    assert pixels([2.5, 3.5], [6.5, 3.5]) == [(3, 2), (3, 3), (3, 4), (3, 5)]
    assert pixels([6.5, 3.5], [2.5, 3.5]) == [(3, 3), (3, 4), (3, 5), (3, 6)]
    assert pixels([2.5, 3.5], [2.5, 6.5]) == [(3, 2), (4, 2), (5, 2)]


eyes = st.tuples(*[st.floats(-3.0, 3.0)] * 3)


@settings(max_examples=40)
@given(st.tuples(eyes, eyes), st.sampled_from([1e-3, 0.5]))
def test_f07_what_shows_is_the_line_in_front_of_the_eye(ends, near) -> None:
    camera = Camera([0, 0, 2], [0, 0, 0], fov_y=1.2, width=32, height=24)
    buffer = framebuffer(32, 24)
    draw_lines(buffer, camera, [ends], color=[1, 1, 1, 1], near=near)
    rows, columns = np.nonzero(buffer.pixels[..., 0])
    t = np.linspace(0.0, 1.0, 4_001)[:, None]
    points = np.array(ends[0]) + t * np.subtract(ends[1], ends[0])
    x, y, depth, _ = project(camera, points)
    shown = depth >= near
    centres = np.stack([columns + 0.5, rows + 0.5], axis=1)
    seen = np.stack([x[shown], y[shown]], axis=1)
    if not len(seen):
        assert not len(centres)
        return
    # Every pixel lies on the line: within half a pixel of it, and a step's width.
    step = np.abs(np.diff(seen, axis=0)).max(initial=0.0)
    for centre in centres:
        assert np.abs(seen - centre).max(axis=1).min() <= 0.5 + step + 1 / 128
    # Every place of the line in the picture has a pixel near it, but for the ends.
    inner = seen[((seen > 1.0) & (seen < [31.0, 23.0])).all(axis=1)]
    length = np.hypot(*(seen[-1] - seen[0]))
    if len(inner) and length > 2.0:
        gaps = np.abs(inner[:, None] - centres).max(axis=2).min(axis=1)
        assert gaps.max() <= 1.5


@pytest.mark.parametrize("far", [1e2, 1e6, 1e12])
def test_lines_that_end_far_away_stay_straight(far: float) -> None:
    buffer = framebuffer(16, 12)
    draw_lines(buffer, FRONT, [[[-far, 6.25, 0], [far, 6.25, 0]]], color=ORANGE)
    np.testing.assert_array_equal(
        buffer.pixels[..., 0].sum(axis=1), [0] * 5 + [16] + [0] * 6
    )


def test_a_line_that_ends_beyond_all_digits_stays_in_its_row() -> None:
    buffer = framebuffer(16, 12)
    draw_lines(buffer, FRONT, [[[-1e100, 6.25, 0], [1e100, 6.25, 0]]], color=ORANGE)
    assert not np.delete(buffer.pixels, 5, axis=0).any()


def test_a_line_through_the_eye_is_cut_before_it() -> None:
    camera = Camera([0, 0, 2], [0, 0, 0], width=16, height=12)
    for end in ([0.0, 0.0, 9.0], [0.3, 0.1, 2.0], [0.0, 0.0, 2.0]):
        buffer = framebuffer(16, 12)
        draw_lines(buffer, camera, [[[0.5, 0.2, -2], end]], color=ORANGE, near=1e-100)
        assert np.isfinite(buffer.pixels).all()


def test_colours_are_blended_by_their_alpha() -> None:
    buffer = framebuffer(16, 12, color=[0, 0, 1, 1])
    half = [1.0, 0.0, 0.0, 0.5]
    draw_lines(buffer, FRONT, [[[-1, 6.25, 0], [20, 6.25, 0]]], color=half)
    np.testing.assert_array_equal(buffer.pixels[5, 8], [0.5, 0.0, 0.5, 0.75])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: pixels([0, 0], [1e9, 0]), "end: expected numbers in"),
        (lambda: pixels([0, np.nan], [1, 0]), "start: expected finite numbers"),
        (lambda: pixels([0, 0], [1, 1], thickness=0), "thickness: expected a whole"),
        (
            lambda: draw_lines(framebuffer(3, 3), FRONT, [], color=ORANGE),
            "lines: expected an array of shape",
        ),
        (
            lambda: draw_lines(
                framebuffer(3, 3), FRONT, np.zeros((0, 2, 3)), color=ORANGE
            ),
            "buffer: expected shape",
        ),
        (
            lambda: draw_lines(
                framebuffer(16, 12), FRONT, np.full((1, 2, 3), 1e200), color=ORANGE
            ),
            "lines: expected numbers in",
        ),
        (
            lambda: draw_lines(
                framebuffer(16, 12), FRONT, np.zeros((0, 2, 3)), color=ORANGE, near=0
            ),
            "near: expected a finite number",
        ),
    ],
)
def test_refusals_name_the_argument_in_one_line(call, message: str) -> None:
    with pytest.raises(ValueError, match=rf"^{message}[^\n]*$"):
        call()
