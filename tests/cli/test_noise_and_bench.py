"""``refcloud noise`` draws every kind; ``refcloud bench`` prints a table or rows."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import get_args

import pytest

from refcloud import bench
from refcloud.cli import main
from refcloud.cli.bench import NAMES
from refcloud.image import read_png
from refcloud.noise_pictures import Kind, noise_picture


@pytest.mark.parametrize("kind", get_args(Kind))
def test_every_kind_is_drawn_with_its_codes(
    kind: Kind, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "noise.png"
    assert main(["noise", kind, "--size", "24", "--cells", "3", "-o", str(path)]) == 0
    picture = noise_picture(kind, size=24, cells=3)
    assert (read_png(path) == picture.codes(tone="none", dither=False)).all()
    assert capsys.readouterr().out.splitlines()[-1] == str(path)


def test_the_name_says_kind_and_view(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["noise", "value", "--view", "octaves", "--size", "16"]) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["value-octaves.png"]


def test_bench_prints_a_table_and_rows(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "noise", "--quick"]) == 0
    table = capsys.readouterr().out
    assert "Perlin grid" in table
    assert "numpy" in table
    assert main(["bench", "noise", "--quick", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert {"task", "name", "timing", "ratio", "error", "rms"} == set(rows[0])
    assert {row["task"] for row in rows} >= {"Perlin grid", "Worley scattered"}
    ours = [row for row in rows if row["name"] == "refcloud float32"]
    # Of values in [-1, 1]; float32 holds 1.2e-7 and a sum of corners some ten of it.
    assert all(row["error"] < 1e-5 for row in ours)
    assert len(ours) > 3


def test_bench_without_a_name_lists_what_there_is(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["bench"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(NAMES)
    assert all(len(line.split()) > 3 for line in lines)


def test_a_plot_without_matplotlib_is_refused_before_the_work(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)  # as if not installed
    monkeypatch.setattr(bench, "run", None)
    for name in ("sunward", "tolerance"):
        assert main(["bench", name, "--plot", str(tmp_path / "a.png")]) == 2
        out, err = capsys.readouterr()
        assert out == ""
        assert err == (
            "refcloud: --plot: expected matplotlib, got none;"
            ' pip install ".[bench]" in refcloud\'s folder\n'
        )
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("words", "what"), [(["noise", "pink"], "'pink'"), (["bench", "clouds"], "noise")]
)
def test_an_unknown_subject_is_refused(
    words: list[str], what: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words) == 2
    line = capsys.readouterr().err
    assert line.count("\n") == 1
    assert what in line
