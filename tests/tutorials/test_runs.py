"""Every tutorial runs at `quick`, and draws the pictures that are stored."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import page
import pytest

from refcloud.image import compare_codes, read_png

PATHS = page.tutorials()
# Fits amplify what machines differ in, the last bits of matrix products; what is drawn
# within a tolerance changes within it when a saving changes. These are held by the
# means of blocks of pixels.
LOOSELY = (
    *("01-cloud", "01-count", "08-balls", "08-phases", "08-strip"),
    *("12-strip", "15-strip", "17-multiple", "17-once", "17-strip", "17-orders"),
)
BLOCK, LOOSE = 8, 12.0  # pixels, and codes of a block's mean
# Pictures of errors, each below a bound that the tutorial itself asserts.
ERRORS = ("12-same", "15-error", "15-promise")


@pytest.mark.slow
@pytest.mark.parametrize("path", PATHS, ids=lambda path: path.stem)
def test_a_tutorial_draws_its_stored_pictures(path: Path, tmp_path: Path) -> None:
    printed = page.draw(path, tmp_path, "--quick")
    kept = page.stored(path).keys() - {page.MACHINE}
    assert set(printed) == kept, "the cells that print are those whose text is kept"
    declared = page.pictures_of(path)
    assert {file.stem for file in tmp_path.iterdir()} == set(declared)
    for name in declared:
        new, old = (
            read_png(tmp_path / f"{name}.png"),
            read_png(page.QUICK / f"{name}.png"),
        )
        assert new.shape == old.shape, name
        if name in ERRORS:
            continue
        if name in LOOSELY:
            assert np.abs(blocks(new) - blocks(old)).max() <= LOOSE, name
            continue
        found = compare_codes(old, new)
        assert found.same, f"{name}: {found}; python tutorials/page.py --pictures"


def blocks(codes: np.ndarray) -> np.ndarray:
    """Give the means of blocks of pixels."""
    height, width = (n // BLOCK * BLOCK for n in codes.shape[:2])
    cut = codes[:height, :width].reshape(
        height // BLOCK, BLOCK, width // BLOCK, BLOCK, 3
    )
    return cut.mean(axis=(1, 3))


def test_the_blocks_see_a_wrong_patch() -> None:
    old = np.full((32, 32, 3), 100, np.uint8)
    new = old.copy()
    new[8:16, 8:16] += 13
    assert np.abs(blocks(new) - blocks(old)).max() > LOOSE


@pytest.mark.parametrize(
    ("flags", "files"),
    [
        ((), {"02-hash", "02-zoom", "02-period"}),
        (("--zoom", "8"), {"02-hash"}),
    ],
)
def test_a_knob_draws_the_main_picture_alone(
    flags: tuple[str, ...], files: set[str], tmp_path: Path
) -> None:
    path = next(path for path in PATHS if path.stem == "02_hash")
    if flags:
        with pytest.raises(SystemExit) as end:
            page.draw(path, tmp_path, "--quick", *flags)
        assert end.value.code == 0
    else:
        page.draw(path, tmp_path, "--quick")
    assert {file.stem for file in tmp_path.iterdir()} == files


def test_cells_of_a_notebook_show_pictures_and_write_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    # The words are the kernel's own, and none of a tutorial's business.
    monkeypatch.setattr(sys, "argv", ["kernel", "-f", "connection.json", "--quick"])
    path = next(path for path in PATHS if path.stem == "02_hash")
    names: dict[str, Any] = {"__name__": "__main__"}
    exec(compile(path.read_text("utf-8"), path.name, "exec"), names)
    assert not list(tmp_path.iterdir())
    shown = names["lesson"].show(names["picture"], "02-hash", "again")
    assert shown.codes.shape == (320, 480, 3)
    assert shown._repr_png_().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("flags", "line"),
    [
        (("--zoom", "99"), "02_hash.py: --zoom: expected a whole number in [1, 16]"),
        (("--zom", "8"), "did you mean --zoom?"),
        (("--seed", "often"), "02_hash.py: --seed: expected"),
    ],
)
def test_wrong_flags_are_refused_in_one_line(
    flags: tuple[str, ...],
    line: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = next(path for path in PATHS if path.stem == "02_hash")
    with pytest.raises(SystemExit) as end:
        page.draw(path, tmp_path, "--quick", *flags)
    assert end.value.code == 2
    said = capsys.readouterr().err
    assert line in said
    assert said.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_folder_that_is_not_there_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = PATHS[1]
    with pytest.raises(SystemExit) as end:
        page.draw(path, tmp_path / "nowhere", "--quick")
    assert end.value.code == 2
    assert "--output: expected a folder" in capsys.readouterr().err
    shutil.rmtree(tmp_path)


SLOW = """
import time
from lesson import Lesson
lesson = Lesson()
def picture():
    print("at work", flush=True)
    time.sleep(60.0)
lesson.show(picture, "a", "")
"""


def test_ctrl_c_ends_a_tutorial_in_one_line(tmp_path: Path) -> None:
    for module in ("lesson", "plots", "sheets"):
        shutil.copy(page.HERE / f"{module}.py", tmp_path)
    (tmp_path / "99_slow.py").write_text(SLOW)
    with subprocess.Popen(
        [sys.executable, "99_slow.py"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(page.HERE.parent)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "at work\n"
        process.send_signal(signal.SIGINT)
        _, err = process.communicate()
    assert (process.returncode, err) == (130, "99_slow.py: interrupted\n")


def test_a_tutorial_s_options_are_told_as_it_is_called() -> None:
    def told(word: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, PATHS[0], word],
            env={**os.environ, "PYTHONPATH": str(page.HERE.parent), "COLUMNS": "80"},
            capture_output=True,
            text=True,
            check=False,
        )

    call = f"python tutorials/{PATHS[0].name}"
    shown = told("--help").stdout
    assert shown.startswith(f"usage: {call} [options]\n")
    assert "-o FOLDER, --output FOLDER" in shown
    assert told("--zzz").stderr.endswith(f"; see {call} --help\n")
