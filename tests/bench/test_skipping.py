"""The table of what scenes leave out says what their pictures report."""

from __future__ import annotations

import json

import pytest

from refcloud.bench import skipping
from refcloud.cli import main
from refcloud.conventions import Skipped
from refcloud.render import render
from refcloud.scene import SCENES


def test_rows_are_those_of_the_pictures(capsys, monkeypatch) -> None:
    some = {name: SCENES[name] for name in ("man-14", "shader-raw")}
    monkeypatch.setattr(skipping, "SCENES", some)
    size = dict(zip(("width", "height"), skipping.SMALL, strict=True))
    expected = render("man-14", **size, tolerance=skipping.TOLERANCE).skipped
    assert len(expected) > 1
    assert main(["bench", "skipping", "--quick", "--json"]) == 0
    *rows, none = json.loads(capsys.readouterr().out)
    assert none == {"scene": "shader-raw"}
    assert [row.pop("scene") for row in rows] == ["man-14"] * len(expected)
    assert tuple(Skipped(**row) for row in rows) == expected
    assert main(["bench", "skipping", "--quick"]) == 0
    machine, about, head, *lines = capsys.readouterr().out.splitlines()
    assert "numpy" in machine
    assert "64 x 48 pixels" in about
    assert head.split()[:3] == ["scene", "stage", "what"]
    assert len(lines) == len(rows) + 1
    for row, line in zip(expected, lines, strict=False):
        assert f"{row.skipped / row.of:.1%}" in line
        assert row.what in line
    assert "nothing" in lines[-1]


@pytest.mark.parametrize("words", [["--plot", "a.png"]])
def test_it_is_no_figure(words, capsys, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["bench", "skipping", *words]) == 2
    assert "--plot: expected none beside skipping" in capsys.readouterr().err
