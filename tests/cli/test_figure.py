"""``refcloud figure`` draws one figure or all, and lists them."""

from __future__ import annotations

from pathlib import Path

import pytest

import refcloud as rc
from refcloud.figure import figures, find_figure


def test_list_names_every_figure(run) -> None:
    lines = run("figure", "--list").out.splitlines()
    assert [line.split()[0] for line in lines] == list(figures())
    assert "M, figure 5: basis functions" in lines[4]


def test_one_figure_is_drawn_with_its_caption(run, here: Path) -> None:
    status, out, err = run("figure", "man-05", "--quick")
    assert (status, err) == (0, "")
    assert out.splitlines()[0] == (
        "man-05: basis functions (document M, figure 5; quick)"
    )
    assert out.splitlines()[-1] == "man-05.png"
    expected = find_figure("man-05").draw(rc.scenes.View(320, 240))
    expected.save("expected.png", dither=False)
    assert Path("man-05.png").read_bytes() == Path("expected.png").read_bytes()


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("figure", "NAME: expected one of: a figure's name, --list, --all, got none"),
        ("figure man-05 --all", "got man-05 --all"),
        ("figure man-05 --quick --final", "--final: expected none beside --quick"),
        ("figure man-99", "NAME: expected one of man-01, "),
        ("figure man-05 -o a.gif", "--output: expected a name ending in .png or .npy"),
        ("figure --all -o a.png", "--output: expected a folder, got the file a.png"),
        ("figure a b", "arguments: expected 1: NAME, got also 'b'"),
        ("figure --all --jobs 0", "--jobs: expected a whole number in [1, 1024]"),
    ],
)
def test_refusals(line: str, message: str, run, here: Path) -> None:
    status, out, err = run(*line.split())
    assert (status, out) == (2, "")
    assert message in err
    assert err.count("\n") == 1
