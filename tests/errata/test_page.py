"""The page of the errata is complete and fresh, and so are its pictures."""

from __future__ import annotations

from pathlib import Path

import errata
import numpy as np
import pytest

from refcloud.drawing import canvas
from refcloud.image import compare_codes, read_png
from refcloud.references import ERRATA

ROOT = Path(__file__).parents[2]
WIDEST = 320  # pixels
MOST_BYTES = 8_000_000  # of all pictures of the tutorials together
LETTERS = 2  # pixels around a letter that another release of its font may reach

WITH_PICTURE = [
    n for n in errata.NUMBERS if (errata.PICTURES / f"{n.lower()}.png").exists()
]


@pytest.fixture(scope="module")
def figures() -> dict:
    return errata.draw()


@pytest.fixture(scope="module")
def held() -> dict:
    return errata.holders()


def test_the_page_is_what_the_library_computes(figures) -> None:
    stored = errata.PAGE.read_text("utf-8")
    assert stored == errata.page_of(figures), "run python tutorials/errata.py"


def test_every_erratum_has_entry_short_form_figure_and_test(held) -> None:
    errata.refuse_gaps(errata.entries(), held)
    assert list(ERRATA) == list(errata.FIGURES) == errata.NUMBERS
    for number, entry in errata.entries().items():
        assert all(text.strip() == text != "" for text in entry.values()), number


def test_a_gap_is_named(held) -> None:
    told = errata.entries()
    with pytest.raises(ValueError, match=r"^E07 lacks an entry in errata\.toml$"):
        errata.refuse_gaps({k: v for k, v in told.items() if k != "E07"}, held)
    without = {k: v for k, v in held.items() if k != "E28"}
    with pytest.raises(ValueError, match=r"^E28 lacks a test that carries its number$"):
        errata.refuse_gaps(told, without)
    with pytest.raises(ValueError, match=r"^no erratum has the number E39$"):
        errata.refuse_gaps(told, held | {"E39": [("a", "b")]})


def test_tests_are_found_by_the_numbers_in_their_names(tmp_path: Path) -> None:
    (tmp_path / "tests" / "room").mkdir(parents=True)
    text = "def test_e04_a(): ...\nclass C:\n    def test_b_e17_e05(self): ...\n"
    text += "def test_the_e4_road_and_e123(): ...\ndef no_test_e09_(): ...\n"
    (tmp_path / "tests" / "room" / "test_a.py").write_text(text)
    file = "tests/room/test_a.py"
    assert errata.holders(tmp_path / "tests") == {
        "E04": [(file, "test_e04_a")],
        "E05": [(file, "test_b_e17_e05")],
        "E17": [(file, "test_b_e17_e05")],
    }


def test_pictures_are_those_of_the_figures_and_small(figures) -> None:
    drawn = {n for n, figure in figures.items() if figure.canvas is not None}
    assert drawn == set(WITH_PICTURE)
    assert {p.stem.upper() for p in errata.PICTURES.iterdir()} == drawn
    for path in errata.PICTURES.iterdir():
        assert read_png(path).shape[1] <= WIDEST, path.name
    folder = errata.PICTURES.parent
    size = sum(p.stat().st_size for p in folder.rglob("*") if p.is_file())
    assert size <= MOST_BYTES


def around(letters: np.ndarray) -> np.ndarray:
    """Widen a mask."""
    wide = letters.copy()
    for axis in (0, 1):
        for step in range(-LETTERS, LETTERS + 1):
            wide |= np.roll(letters, step, axis)
        letters = wide.copy()
    return wide


@pytest.mark.parametrize("number", WITH_PICTURE)
def test_a_picture_is_what_the_library_draws(number, figures, monkeypatch) -> None:
    stored = read_png(errata.PICTURES / f"{number.lower()}.png")
    found = figures[number].codes()
    assert stored.shape == found.shape
    # Letters depend on the release of the font's library: they are left out by
    # drawing without them, and must take up little of the picture.
    monkeypatch.setattr(canvas, "LEGIBLE", np.inf)
    bare = errata.FIGURES[number]().codes()
    letters = around((bare != found).any(axis=-1))
    assert letters.mean() < 0.15, "worst seen 0.10"
    compared = np.where(letters[..., None], found, stored)
    result = compare_codes(compared, found)
    assert result.same, f"{result}; run python tutorials/errata.py --pictures"
