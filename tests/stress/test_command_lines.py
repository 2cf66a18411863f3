"""Any words behind ``refcloud``: a result, or one line and status 2; never more."""

from __future__ import annotations

import contextlib
import importlib
import io
import resource
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from strategies import values_for

import refcloud as rc
from refcloud.cli import main
from refcloud.cli.entry import COMMANDS
from refcloud.cli.options import Option

pytestmark = pytest.mark.stress

often = settings(
    max_examples=40, deadline=None, suppress_health_check=list(HealthCheck)
)
# Measuring and serving go on for long; figures are drawn at their own sizes.
FUZZED = sorted(set(COMMANDS) - {"bench", "studio", "figure"})
FILES = ["balls.npz", "voxels.npz", "levels.npz", "a.png", "d.toml", "no.npz", "text"]
CLOUDS = [["balls.npz"], ["voxels.npz"], ["levels.npz"], ["d.toml"], ["shader-raw"]]
RIGHT = {
    "animate": [[*each, "--turn-eye", "9"] for each in CLOUDS[:4]],
    "approximate": [["voxels.npz"]],
    "compare": [["a.png", "a.png"], ["a.png", "b.png"]],
    "generate": [[]],
    "list": [[]],
    "noise": [["value"], ["worley"], ["simplex"]],
    "render": CLOUDS,
    "scene": [["man-10"], ["cumulus"]],
}
# What keeps a good command short; of several values the last one counts.
SMALL = {
    "render": ["--width", "6", "--height", "4"],
    "animate": ["--width", "6", "--height", "4", "--jobs", "1", "--frames", "2"],
    "generate": [
        *("--diameters", "8", "6", "6", "--voxel", "1", "--relief", "1", "--edge", "1"),
    ],
    "approximate": ["--count", "3"],
    "noise": ["--size", "8"],
}
MOST_GROWTH = 300_000  # kilobytes: what a thousand small pictures may leave behind
WORDS = st.one_of(
    st.sampled_from(
        "0 -0 1 -1 2 3.5 1/3 1/0 nan inf -inf 1e300 1e-300 5e-324 -1e300 1e19 0x10 "
        "True none - -- -o --help= sky man hg ../x . / ~ \u2603 9999999999999999999"
        "".split()
    ),
    st.text(max_size=6).filter(lambda word: "\0" not in word),
)
NAMES = st.sampled_from([*FILES, "man-10", "demand-sky", "shader-raw", "value"]) | WORDS


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Stand in a folder with a small file of each kind."""
    made = tmp_path_factory.mktemp("words")
    with contextlib.chdir(made):
        balls = rc.Metaballs([[0, 0, 0], [1, 0.5, 0]], [2, 1], [1, 0.5])
        rc.save_metaballs(balls, "balls.npz")
        grid = rc.VoxelGrid(np.ones((2, 3, 4)), [0, 0, 0], [4, 3, 2])
        rc.save_voxels(grid, "voxels.npz")
        levels = rc.metaballs.Levels((balls,), [[0.5] * 4], [0.0])
        rc.metaballs.save_levels(levels, "levels.npz")
        rc.Picture(np.full((4, 6, 3), 0.5)).save("a.png")
        rc.Picture(np.full((4, 6, 3), 0.7)).save("b.png")
        Path("text").write_text("a cloud")
        assert called(["scene", "man-10", "-o", "d.toml"])[0] == 0
        yield made


def called(words: list[str]) -> tuple[int, str, str]:
    """Run a command in this process: its status, and what it printed."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = main(words)
    return status, out.getvalue(), err.getvalue()


def options_of(name: str) -> list[Option]:
    module = importlib.import_module(COMMANDS[name])
    return (
        list(module.command()._options.values()) if hasattr(module, "command") else []
    )


def typed(value: Any) -> list[str]:
    return [str(each) for each in np.ravel(value).tolist()]


@st.composite
def lines(draw: st.DrawFn, name: str) -> list[str]:
    """Draw a line that is right, or nearly; a word in some is any word at all."""
    words = [name, *draw(st.sampled_from(RIGHT[name]))]
    options = options_of(name)
    chosen = draw(st.lists(st.sampled_from(options), max_size=3)) if options else []
    for option in chosen:
        words.append(option.flag)
        if not option.is_switch and option.kinds != (str,):
            kinds = [values_for(kind) for kind in option.kinds]
            words += draw(st.one_of(kinds).map(typed) | st.lists(WORDS, max_size=3))
    if draw(st.integers(0, 3)) == 0:
        words.insert(draw(st.integers(1, len(words))), draw(NAMES | WORDS))
    if draw(st.booleans()):
        words += ["-o", draw(st.sampled_from(["x.png", "x.npz", "x.npy", "x.toml"]))]
    return words + SMALL.get(name, [])


def tidy(folder: Path) -> dict[str, bytes]:
    """Give every file; none is half-written."""
    found = {str(p.relative_to(folder)): p for p in folder.rglob("*") if p.is_file()}
    assert not [name for name in found if name.endswith(".part")]
    return {name: path.read_bytes() for name, path in found.items()}


@pytest.mark.parametrize("name", FUZZED)
@often
@given(data=st.data())
def test_any_words(name: str, folder: Path, data: st.DataObject) -> None:
    before = tidy(folder)
    words = data.draw(lines(name), label="words")
    # Reports of what is left out are none of a warning's.
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        status, out, err = called(words)
    after = tidy(folder)
    assert status in (0, 1, 2)
    assert "Traceback" not in out + err
    if status == 2:
        assert err.startswith("refcloud: ")
        assert err.count("\n") == 1
        assert after == before, "a refused command writes nothing"
    for added in set(after) - set(before):
        (folder / added).unlink()
    for kept, content in before.items():
        (folder / kept).write_bytes(content)


@often
@given(words=st.lists(st.sampled_from(sorted(COMMANDS)) | WORDS, max_size=2))
def test_any_command(words: list[str], folder: Path) -> None:
    if words and words[0] in COMMANDS:
        words = [words[0], "--no-such-option", *words[1:]]
    status, _, err = called(words)
    assert (status, err.count("\n")) == (2, 1) or words[:1] == ["--help"]


def test_memory_stays_where_it_was(folder: Path) -> None:
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(20):
        for name in ("balls.npz", "voxels.npz"):
            called(["render", name, "-o", "x.png", *SMALL["render"]])
        called(["generate", "-o", "y.npz", *SMALL["generate"]])
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert after - before < MOST_GROWTH
