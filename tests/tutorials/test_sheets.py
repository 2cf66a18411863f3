"""Sheets and plots: codes, places of panels, and curves where their numbers are."""

from __future__ import annotations

import numpy as np
import plots
import pytest
from sheets import GAP, LINE, Sheet, enlarged, grey, sheet_of, side_by_side

from refcloud import Picture


def test_grey_is_the_nearest_code() -> None:
    codes = grey([[0.0, 0.5, 1.0, 2.0, -1.0]]).codes
    assert codes[0, :, 0].tolist() == [0, 128, 255, 255, 0]
    assert (codes == codes[..., :1]).all()
    assert grey([[1.0, 3.0]], 1.0, 3.0).codes[0, :, 1].tolist() == [0, 255]
    assert grey([[1.0]], 3.0, 1.0).codes[0, 0, 2] == 255, "ends may be exchanged"


def test_a_transparent_picture_lies_on_white() -> None:
    clear = Picture(np.zeros((1, 2, 3)), alpha=[[0.0, 1.0]])
    white, black = sheet_of(clear).codes[0]
    assert white.min() > 200
    assert black.max() < 3


def test_enlarged_pixels_are_squares() -> None:
    codes = enlarged(grey([[0.0, 1.0]]), 3).codes
    assert codes.shape == (3, 6, 3)
    assert codes[2, 2, 0] == 0
    assert codes[2, 3, 0] == 255


@pytest.mark.parametrize("labels", [True, False])
def test_panels_stand_in_rows(labels: bool) -> None:
    panels = {str(k): grey(np.full((4, 60), k / 10)) for k in range(5)}
    codes = side_by_side(panels, columns=2, labels=labels).codes
    line = LINE if labels else 0
    assert codes.shape == (3 * (4 + line + GAP) - GAP, 2 * 60 + GAP, 3)
    for k in range(5):
        y, x = k // 2 * (4 + line + GAP), k % 2 * (60 + GAP)
        assert (codes[y : y + 4, x : x + 60] == panels[str(k)].codes).all()
    below = codes[4 : 4 + line, :60]
    assert labels == bool(below.size and below.min() < 100), "letters, or none"


@pytest.mark.parametrize("log", [False, True])
@pytest.mark.parametrize("width", [120, 400])
def test_a_curve_passes_where_its_numbers_are(log: bool, width: int) -> None:
    x = np.linspace(1.0, 100.0, 200)
    sheet = plots.curves(
        (width, 200), x, {"one": x}, y_range=(1.0, 100.0), log=(log, log)
    )
    assert sheet.codes.shape == (200, width, 3)
    margins = (52, 20, 12, 44) if width >= plots.WIDE else (2, 2, 2, 2)
    left, right, top, bottom = margins
    inside = sheet.codes[top : 200 - bottom, left : width - right].astype(int)
    rows, columns = inside.shape[:2]
    # y = x is the diagonal on axes of one kind.
    for share in (0.25, 0.5, 0.7):
        column = round(share * (columns - 1))
        inked = np.abs(inside[:, column] - plots.INKS[0]).sum(axis=-1)
        assert abs(inked.argmin() - (1.0 - share) * (rows - 1)) <= 1.5
        assert inked.min() < 60


def test_marks_stand_at_their_points() -> None:
    marks = {"here": (0.25, 0.75)}
    sheet = plots.curves((120, 120), [0.0, 1.0], {}, y_range=(0.0, 1.0), marks=marks)
    off = np.abs(sheet.codes.astype(int) - plots.INKS[0]).sum(axis=-1)
    row, column = np.unravel_index(off.argmin(), off.shape)
    assert abs(row - (2 + 0.25 * 115)) <= 3
    assert abs(column - (2 + 0.25 * 115)) <= 3


@pytest.mark.parametrize(
    ("span", "log", "ticks"),
    [
        ((0.0, 1.0), False, [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]),
        ((0.0, 1000.0), False, [0.0, 200.0, 400.0, 600.0, 800.0, 1000.0]),
        ((-2.0, 0.0), True, [0.01, 0.1, 1.0]),
        ((-9.0, 0.0), True, [1e-8, 1e-6, 1e-4, 1e-2, 1.0]),
    ],
)
def test_ticks_are_round(
    span: tuple[float, float], log: bool, ticks: list[float]
) -> None:
    np.testing.assert_allclose(plots._ticks(span, log), ticks, rtol=1e-12)


def test_a_sheet_shows_itself_in_a_notebook() -> None:
    assert Sheet(np.zeros((2, 2, 3), np.uint8))._repr_png_().startswith(b"\x89PNG")
