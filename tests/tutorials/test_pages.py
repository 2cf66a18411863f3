"""Pages are what `python tutorials/page.py` writes, and show pictures that exist."""

from __future__ import annotations

import re
from pathlib import Path

import page
import pytest

from refcloud.image import read_png

PATHS = page.tutorials()
LONGEST = 150  # lines with something on them
WIDEST, MOST_BYTES = 640, 8_000_000  # pixels, and the folder of pictures
PARTS = ("## One formula", "## Where this breaks", "## Exercises", "## Solutions")


def stem(path: Path) -> str:
    return path.stem


@pytest.mark.parametrize("path", PATHS, ids=stem)
def test_pages_are_fresh(path: Path) -> None:
    stored = path.with_suffix(".md").read_text("utf-8")
    assert stored == page.page_of(path), "run python tutorials/page.py"


def test_the_list_is_fresh_and_complete() -> None:
    stored = (page.HERE / "README.md").read_text("utf-8")
    assert stored == page.index(), "run python tutorials/page.py"
    assert [path.name[:2] for path in PATHS] == [f"{n:02}" for n in range(1, 18)]


@pytest.mark.parametrize("path", PATHS, ids=stem)
def test_every_tutorial_has_its_parts(path: Path) -> None:
    text = path.read_text("utf-8")
    filled = [line for line in text.splitlines() if line.strip(" #")]
    assert len(filled) <= LONGEST, f"{len(filled)} lines"
    for part in PARTS:
        assert f"\n# {part}" in text, part
    assert re.search(
        r"^# \*[^*]+\?\*$|^# \*[^*]+\n(# [^*\n]+\n)*# [^*\n]*\?[^*]*\*$", text, re.M
    )
    shown = [method for _, body in page.cells(text) for method, _ in _calls(body)]
    assert "source" in shown, "the library's own code is shown"
    assert {"strip", "row"} & set(shown), "a strip of the main knob"
    exercises = text.split("## Exercises")[1].split("## Solutions")[0]
    assert re.findall(r"^# (\d)\. ", exercises, re.M) == ["1", "2", "3"]
    solutions = text.split("## Solutions")[1]
    for number in "123":
        assert re.search(rf"^# {number}[.:] ", solutions, re.M), f"solution {number}"


def _calls(body: str) -> list:
    try:
        return page.calls(body)
    except SyntaxError:  # Markdown
        return []


def test_pictures_are_those_that_are_declared() -> None:
    names = [name for path in PATHS for name in page.pictures_of(path)]
    assert len(names) == len(set(names))
    for folder in (page.PICTURES, page.QUICK):
        stored = {file.stem for file in folder.glob("[0-9][0-9]-*.png")}
        assert stored == set(names), folder.name
    for path in PATHS:
        for name, caption in page.pictures_of(path).items():
            assert name.startswith(path.name[:2] + "-")
            assert 8 < len(caption) < 100, caption
            assert read_png(page.PICTURES / f"{name}.png").shape[1] <= WIDEST, name
    size = sum(file.stat().st_size for file in page.PICTURES.rglob("*.png"))
    assert size <= MOST_BYTES, f"{size} bytes"


def test_pages_link_to_each_other() -> None:
    for file in sorted(page.HERE.glob("*.md")):
        for link in re.findall(r"\]\(([^)]+)\)", file.read_text("utf-8")):
            assert (page.HERE / link).exists(), f"{file.name}: {link}"


def test_library_code_is_shown_without_its_long_docstring() -> None:
    from refcloud.noise import man2003

    path, line, code = page.source_of(man2003)
    assert path == "refcloud/noise/hashing.py"
    assert line > 1
    assert code.count('"""') == 2
    assert "Parameters" not in code
    compile(code, path, "exec")
