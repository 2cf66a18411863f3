"""How commands end: verdicts, interrupts, closed pipes, lack of memory, defects."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import refcloud as rc
import refcloud.cli.generate
from refcloud.cli import progress
from refcloud.cli.progress import Stages
from refcloud.image import read_png, write_png

from .conftest import contents

ROOT = Path(__file__).parents[2]
OVER = np.float64(1e300)


def raising(error: BaseException):
    def fail(*words: object, **options: object) -> None:
        raise error

    return fail


@pytest.mark.parametrize(
    ("error", "status", "line"),
    [
        (KeyboardInterrupt(), 130, "interrupted"),
        (MemoryError(), 2, "memory: expected what fits, got more than this machine"),
        (FloatingPointError("overflow"), 2, "arithmetic: expected numbers that stay"),
        (OSError(28, "No space left", "a.npz"), 2, "a.npz: expected to read or write"),
        (OSError(11, "Try again"), 2, "system: expected it to do what the command"),
        (ValueError("x: expected\n1"), 2, "x: expected 1"),
        (KeyError("a"), 70, "defect: KeyError: 'a'; please report this command"),
    ],
)
@pytest.mark.parametrize("step", ["generate", "save_voxels"])
def test_every_failure_is_one_line(
    step, error, status, line, run, here, monkeypatch
) -> None:
    monkeypatch.setattr(refcloud.cli.generate, step, raising(error))
    before = contents(here)
    ended = run("generate", *"--diameters 8 6 6 --relief 1 --voxel 1".split())
    assert (ended.status, ended.out) == (status, "")
    assert ended.err.startswith(f"refcloud: {line}")
    assert ended.err.count("\n") == 1
    assert contents(here) == before


def test_an_interrupt_while_writing_leaves_nothing(run, here, monkeypatch) -> None:
    before = contents(here)
    monkeypatch.setattr(os, "replace", raising(KeyboardInterrupt()))
    small = "--diameters 8 6 6 --relief 1 --voxel 1 -o a.npz"
    assert run("generate", *small.split()).status == 130
    assert contents(here) == before


def test_overflow_is_refused_and_not_warned_about(run, here, monkeypatch) -> None:
    monkeypatch.setattr(refcloud.cli.generate, "generate", lambda **_: OVER * OVER)
    with np.errstate(all="ignore"):
        status, _, err = run("generate")
    assert status == 2
    assert err.startswith("refcloud: arithmetic: expected numbers that stay finite")


def test_a_closed_pipe_is_a_quiet_end() -> None:
    for words in (["list"], ["render", "--help"], ["--version"]):
        reader, writer = os.pipe()
        os.close(reader)
        with os.fdopen(writer, "wb") as pipe:
            done = subprocess.run(
                [sys.executable, "-m", "refcloud", *words],
                env={**os.environ, "PYTHONPATH": str(ROOT)},
                stdout=pipe,
                stderr=subprocess.PIPE,
                check=False,
            )
        assert (done.returncode, done.stderr) == (141, b"")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
@pytest.mark.parametrize("words", ["list", "--version", "render --help", "compare"])
def test_a_full_disk_under_the_results_is_one_line(words, here) -> None:
    line = words.replace("compare", "compare a.png a.png")
    with open("/dev/full", "wb") as full:
        done = subprocess.run(
            [sys.executable, "-m", "refcloud", *line.split()],
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            stdout=full,
            stderr=subprocess.PIPE,
            check=False,
            text=True,
        )
    assert done.returncode == 2
    assert done.stderr == (
        "refcloud: standard output: expected to write the results there,"
        " got No space left on device\n"
    )


@pytest.fixture
def pictures(here: Path) -> Path:
    grey = np.full((4, 6, 3), 0.502)  # of code 188, and near the next
    near, far = grey.copy(), grey.copy()
    near[2, 5] += 0.005  # one code
    far[2, 5, 1], far[0, 1, 2] = 0.9, 0.6
    for name, light in (("grey", grey), ("near", near), ("far", far)):
        rc.Picture(light).save(f"{name}.png", tone="none", dither=False)
    rc.Picture(grey).save("grey.npy")
    return here


@pytest.mark.parametrize(
    ("line", "status"),
    [
        ("grey.png grey.png", 0),
        ("grey.png grey.npy", 0),
        ("grey.png near.png", 1),
        ("grey.png near.png --fraction 0.05", 0),
        ("grey.png near.png --fraction 1 --codes 0", 1),
        ("grey.png far.png --fraction 1", 1),
        ("grey.png far.png --fraction 1 --codes 255", 0),
        ("grey.png none.png", 2),
    ],
)
def test_compare_has_three_ends(line, status, run, pictures) -> None:
    ended = run("compare", *line.split())
    assert ended.status == status
    verdict = {0: "same\n", 1: "different\n", 2: ""}[status]
    assert ended.out.startswith(verdict)
    assert bool(ended.err) == (status == 2)


def test_compare_names_the_worst_pixels_and_draws_them(run, pictures) -> None:
    out = run("compare", "grey.png", "far.png", "-o", "d.npy", "--gain", 1).out
    worst = [line for line in out.splitlines() if line.startswith("worst pixel")]
    assert [line.split(", ")[:2] for line in worst] == [
        ["worst pixel: row 2", "column 5"],
        ["worst pixel: row 0", "column 1"],
    ]
    assert out.splitlines()[-1] == "d.npy"
    off = np.argwhere(rc.load_picture("d.npy").linear > 0.0)
    assert off.tolist() == [[0, 1, 2], [2, 5, 1]]


@pytest.fixture
def alphas(pictures: Path) -> Path:
    """Give the same colours with an opaque alpha, and with one clear pixel."""
    codes = np.dstack([read_png("grey.png"), np.full((4, 6), 255, np.uint8)])
    write_png("opaque.png", codes)
    codes[1, 2, 3] = 254
    write_png("clear.png", codes)
    return pictures


@pytest.mark.parametrize("line", ["opaque.png grey.png", "grey.png opaque.png"])
def test_compare_leaves_out_an_opaque_alpha_and_says_so(line, run, alphas) -> None:
    ended = run("compare", *line.split(), "-o", "d.png")
    assert (ended.status, ended.err) == (0, "")
    verdict, note, found = ended.out.splitlines()[:3]
    assert verdict == "same"
    assert note == "opaque.png: its alpha is opaque, and left out"
    assert found == "largest difference: 0 codes"
    assert run("compare", "opaque.png", "far.png").status == 1


@pytest.mark.parametrize("line", ["clear.png grey.png", "grey.png clear.png"])
def test_compare_refuses_an_alpha_that_counts_by_its_own_file(line, run, alphas):
    status, _, err = run("compare", *line.split())
    assert status == 2
    assert err.startswith(
        "refcloud: clear.png: expected an opaque picture beside grey.png, which has no"
        " alpha, got 1 pixel that is not opaque; draw it before a background, or"
    )


def test_compare_takes_alphas_of_both_into_account(run, alphas) -> None:
    ended = run("compare", *"clear.png opaque.png --codes 0".split())
    assert ended.status == 1
    assert "worst pixel: row 1, column 2, 1 code\n" in ended.out
    assert "alpha" not in ended.out


class Terminal:
    """A stderr that notes what is written, a terminal or not."""

    def __init__(self, is_terminal: bool) -> None:
        self.text, self.is_terminal = "", is_terminal

    def isatty(self) -> bool:
        return self.is_terminal

    def write(self, text: str) -> None:
        self.text += text

    def flush(self) -> None:
        pass


@pytest.mark.parametrize("is_terminal", [True, False])
def test_long_stages_show_a_sign_of_life(is_terminal, monkeypatch) -> None:
    screen = Terminal(is_terminal)
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setattr(progress, "PATIENCE", 0.01)
    stages = Stages()
    with stages.stage("fit"):
        stages.watch("clusters", None)
        while screen.text.count("fit") < 2:
            time.sleep(0.001)
    assert "refcloud: fit, 0 s, clusters done" in screen.text
    if is_terminal:
        assert screen.text.endswith(progress.CLEAR)
        assert "\n" not in screen.text
    else:
        assert screen.text.endswith("\n")
    assert stages.line().startswith("seconds: fit 0.")


def test_short_stages_show_nothing(monkeypatch) -> None:
    screen = Terminal(is_terminal=True)
    monkeypatch.setattr(sys, "stderr", screen)
    with Stages().stage("fit"):
        pass
    assert screen.text == ""
