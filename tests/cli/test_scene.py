"""``refcloud scene`` writes a scene that ``refcloud render`` draws as the named one."""

from __future__ import annotations

from pathlib import Path

from refcloud.cli.studio_file import is_studio_file
from refcloud.studio.scene_file import FORMAT, VERSION

SIZE = "--width 24 --height 18"


def test_a_written_scene_is_rendered_and_changed(run, here: Path) -> None:
    assert run("scene", "man-10") == (0, "man-10.toml\n", "")
    for what, out in (("man-10", "a.png"), ("man-10.toml", "b.png")):
        assert run(*f"render {what} {SIZE} -o {out}".split()).status == 0
    assert Path("a.png").read_bytes() == Path("b.png").read_bytes()
    ended = run("scene", "man-10")
    assert (ended.status, ended.out) == (2, "")
    assert "--output: expected a new file, got man-10.toml; " in ended.err
    assert run("scene", "man-10", "--force").status == 0
    text = Path("man-10.toml").read_text("utf-8")
    Path("few.toml").write_text(text.replace("count = 30", "count = 5"), "utf-8")
    ended = run(*f"render few.toml {SIZE}".split())
    assert "cloud: 5 balls, densities not fitted\n" in ended.out
    assert ended.out.splitlines()[-1] == "few.png"
    moved = run(*f"animate few.toml --frames 2 --turn-eye 360 {SIZE} -o f".split())
    assert "the way closes" in moved.out


def test_what_does_not_fit_is_refused_in_one_line(run, here: Path) -> None:
    Path("bad.toml").write_text("[cloud", "utf-8")
    for line, message in (
        ("scene demanded", "NAME: expected one of cumulus, demand, "),
        ("scene man-10 -o a.txt", "--output: expected a name ending in .toml"),
        ("render none.toml", "none.toml: expected a scene (.toml), got no such file"),
        ("render bad.toml", "bad.toml: expected a TOML file"),
    ):
        status, out, err = run(*line.split())
        assert (status, out) == (2, "")
        assert message in err
        assert err.count("\n") == 1


def test_a_mark_of_utf_8_hides_no_file_of_the_studio(here: Path) -> None:
    text = f'format = "{FORMAT}"\nversion = {VERSION}\n'
    Path("a.toml").write_text(text, "utf-8-sig")
    assert is_studio_file("a.toml")
