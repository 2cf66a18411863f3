"""Drawings: shapes cover what they should, and axes put numbers in place."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refcloud import drawing
from refcloud.drawing import BLACK, WHITE, Canvas, blank

SIZE = 64  # pixels; a unit is a tenth of one


def ink(canvas: Canvas) -> np.ndarray:
    """Give how much of each pixel is covered by black on white."""
    return 1.0 - canvas.light[..., 0]


def canvas() -> Canvas:
    return blank(SIZE, SIZE)


inner = st.floats(150.0, 490.0)


def law(drawn: Canvas, away: np.ndarray) -> None:
    """Hold every pixel to the share that its distance from the edge gives."""
    expected = np.clip(0.5 - away, 0.0, 1.0)
    np.testing.assert_allclose(ink(drawn), expected, rtol=0.0, atol=1e-12)


J, I = np.mgrid[0:SIZE, 0:SIZE] + 0.5


@given(inner, inner, st.floats(20.0, 140.0))
def test_a_disc_covers_what_lies_in_it(x: float, y: float, radius: float) -> None:
    drawn = canvas()
    drawing.disc(drawn, (x, y), radius)
    law(drawn, np.hypot(I - 0.1 * x, J - 0.1 * y) - 0.1 * radius)


@given(inner, inner, inner, inner, st.floats(15.0, 60.0))
def test_a_line_covers_what_is_near_it(a, b, c, d, width) -> None:
    drawn = canvas()
    drawing.polyline(drawn, [(a, b), (c, d)], width=width)
    start, way = 0.1 * np.array([a, b]), 0.1 * np.array([c - a, d - b])
    from_start = np.stack([I, J], axis=-1) - start
    along = np.clip(from_start @ way / max(way @ way, 1e-30), 0.0, 1.0)
    off = from_start - along[..., None] * way
    law(drawn, np.hypot(off[..., 0], off[..., 1]) - 0.05 * width)


def test_a_box_and_a_ring_are_hollow_unless_filled() -> None:
    drawn = canvas()
    drawing.box(drawn, (100, 200), (300, 400), width=10)
    assert ink(drawn)[30, 20] == 0.0
    assert ink(drawn)[30, 10] > 0.4
    drawing.box(drawn, (100, 200), (300, 400), width=0, fill=BLACK)
    assert (ink(drawn)[20:40, 10:30] == 1.0).all()
    drawn = canvas()
    drawing.ring(drawn, (320, 320), 200, width=20)
    assert ink(drawn)[32, 32] == 0.0
    assert ink(drawn)[32, 51] == 1.0


def test_half_a_share_covers_half() -> None:
    drawn = canvas()
    drawing.disc(drawn, (320, 320), 100, share=0.5)
    assert ink(drawn)[32, 32] == 0.5


def test_dashes_cover_half_of_a_line() -> None:
    whole, cut = canvas(), canvas()
    path = [(20, 320), (320, 320), (620, 320)]
    drawing.polyline(whole, path, width=20)
    drawing.polyline(cut, path, width=20, dash=100)
    assert 0.5 < float(ink(cut).sum() / ink(whole).sum()) < 0.65


def test_shapes_outside_change_nothing() -> None:
    drawn = canvas()
    for place in ((-500.0, 0.0), (0.0, 2000.0)):
        drawing.disc(drawn, place, 30)
        drawing.polyline(drawn, [place, (place[0], place[1] + 1.0)])
        drawing.image(drawn, np.zeros((2, 2, 3)), place, place)
    assert not ink(drawn).any()


def test_a_picture_is_laid_pixel_by_pixel() -> None:
    drawn, light = canvas(), np.arange(12.0).reshape(2, 2, 3) / 12.0
    drawing.image(drawn, light, (100, 200), (120, 220))
    np.testing.assert_array_equal(drawn.light[20:22, 10:12], light)
    assert ink(drawn).sum() < 4.0


def test_words_are_written_where_they_can_be_read() -> None:
    small, large = canvas(), blank(640, 100)
    drawing.words(small, (100, 100), "cloud")
    assert not ink(small).any()
    drawing.words(large, (320, 50), "cloud", anchor="mm")
    j, i = np.nonzero(ink(large))
    assert abs(i.mean() - 320) < 5
    assert abs(j.mean() - 50) < 5
    drawing.words(large, (320, 50), "I", WHITE, anchor="mm", halo=BLACK)
    assert ink(large)[40:60, 310:330].max() == 1.0


@given(st.floats(-2.0, 5.0), st.floats(-1.0, 1.0))
def test_axes_put_numbers_in_place(x: float, y: float) -> None:
    axes = drawing.axes_in(canvas(), (0, 0, 640, 640), (-2.0, 5.0), (-1.0, 1.0))
    ((across, down),) = axes.place([x], [y])
    share = (x + 2.0) / 7.0, (y + 1.0) / 2.0
    assert across == pytest.approx(axes.left + share[0] * (axes.right - axes.left))
    assert down == pytest.approx(axes.bottom + share[1] * (axes.top - axes.bottom))


def test_curves_stay_in_their_frame() -> None:
    drawn = blank(320, 320)
    axes = drawing.axes_in(drawn, (0, 0, 640, 640), (0.0, 1.0), (0.0, 1.0))
    before = ink(drawn).copy()
    drawing.curve(axes, [0.0, 0.5, 1.0], [-9.0, 9.0, 0.5], BLACK, 2.0)
    changed = np.nonzero(ink(drawn) != before)[0]
    assert changed.min() >= 0.5 * axes.top - 2
    assert changed.max() <= 0.5 * axes.bottom + 2


def test_cells_fill_the_canvas() -> None:
    cells = drawing.grid_of(blank(64, 48), 2, 2)
    assert cells[0] == (0.0, 0.0, 320.0, 240.0)
    assert cells[3] == (320.0, 240.0, 640.0, 480.0)
