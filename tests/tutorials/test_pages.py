"""Pages are what `python tutorials/page.py` writes, and show pictures that exist."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import page
import pytest

from refcloud.image import read_png

PATHS = page.tutorials()
LONGEST = 150  # lines, blank ones too
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
    readme = (page.HERE.parent / "README.md").read_text("utf-8")
    assert page.table("tutorials/") in readme, "README's table is that of the list"


@pytest.mark.parametrize("path", PATHS, ids=stem)
def test_every_tutorial_has_its_parts(path: Path) -> None:
    text = path.read_text("utf-8")
    lines = len(text.splitlines())
    assert lines <= LONGEST, f"{lines} lines"
    for part in PARTS:
        assert f"\n# {part}" in text, part
    assert re.search(
        r"^# \*[^*]+\?\*$|^# \*[^*]+\n(# [^*\n]+\n)*# [^*\n]*\?[^*]*\*$", text, re.M
    )
    shown = [method for _, body in page.cells(text) for method, _ in _calls(body)]
    sources = set(re.findall(r"^From \[`refcloud/(\w+)", page.page_of(path), re.M))
    assert "plain" in sources, "the plain form is shown from the library"
    assert sources - {"plain"}, "the array form is shown from the library"
    assert {"strip", "row"} & set(shown), "a strip of the main knob"
    exercises = text.split("## Exercises")[1].split("## Solutions")[0]
    assert re.findall(r"^# (\d)\. ", exercises, re.M) == ["1", "2", "3"]
    solutions = text.split("## Solutions")[1]
    for number in "123":
        assert re.search(rf"^# {number}[.:] ", solutions, re.M), f"solution {number}"


@pytest.mark.parametrize("path", PATHS, ids=stem)
def test_one_function_draws_the_main_picture(path: Path) -> None:
    text = path.read_text("utf-8")
    made = [
        node
        for node in ast.parse(text).body
        if isinstance(node, ast.FunctionDef) and node.name == "picture"
    ]
    assert len(made) == 1
    spec = made[0].args
    assert not spec.args, "every knob by its name"
    assert len(spec.kwonlyargs) >= 2
    assert len(spec.kw_defaults) == len(spec.kwonlyargs)
    described = parameter_texts_of(ast.get_docstring(made[0]) or "")
    for knob in spec.kwonlyargs:
        assert knob.annotation is not None
        words = ast.unparse(knob.annotation)
        # A number has a range, a name is one of a few.
        assert (
            "Range(" in words
            or "Literal" in words
            or words[0].isupper()
            or (words == "bool")
        ), f"{knob.arg}: {words}"
        assert knob.arg in described, f"{knob.arg} has no description"
    assert len(re.findall(r"lesson\.show\(\s*picture,", text)) == 1


def parameter_texts_of(text: str) -> set[str]:
    return set(re.findall(r"^(\w+)\n    \S", text, re.M))


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


@pytest.mark.parametrize("path", PATHS, ids=stem)
def test_pages_show_what_their_cells_print(path: Path) -> None:
    kept = page.stored(path)
    host = kept.pop(page.MACHINE, "")
    text, told = path.with_suffix(".md").read_text("utf-8"), set()
    for markdown, body in page.cells(path.read_text("utf-8")):
        if markdown or not re.search(r"\bprint\(|\blesson\.(told|timed)\(", body):
            continue
        told.add(page.key_of(body))
        lines = "\n".join(kept.get(page.key_of(body), ["(nothing)"]))
        block = f"```python\n{body}\n```\n\nIt prints:\n\n```text\n{lines}\n```\n"
        assert block in text, f"run python tutorials/page.py --pictures {path.name[:2]}"
        if "lesson.timed(" in body:
            assert f"{block}\n{page.TIMES.format(host)}\n" in text
    assert set(kept) == told, "what was printed by code that is no longer there"


def test_pages_say_what_a_plain_form_calls() -> None:
    ten, twelve = (PATHS[k].with_suffix(".md").read_text("utf-8") for k in (9, 11))
    row = r"^\* `(\w+)`, \[`(refcloud/plain/\w+\.py)`\]\(\.\./\2\): ([A-Z].+\.)$"
    called = {name: said for name, _, said in re.findall(row, twelve, re.M)}
    assert {"draw", "ball_colours", "light_field", "Scene"} <= set(called)
    assert called["draw"].startswith("Blend one ball over what lies behind it")
    assert "patch" in {name for name, *_ in re.findall(row, ten, re.M)}
    assert "range" not in re.findall(r"<code>(\w+)</code>", ten), "Python's own"


def test_a_changed_cell_does_not_show_what_the_old_one_printed() -> None:
    text = PATHS[5].read_text("utf-8")
    (body,) = (body for _, body in page.cells(text) if "print(" in body)
    kept = page.stored(PATHS[5])
    assert "It prints:" in "".join(page.shown_code(body, {}, kept))
    changed = body.replace("of the ellipsoid is cloud", "is cloud")
    assert changed != body
    assert "It prints:" not in "".join(page.shown_code(changed, {}, kept))


def test_what_a_cell_prints_is_its_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    script = tmp_path / "99_two.py"
    bodies = "import lesson\nprint(1)", "n = 2", "print(n)\nprint(n + 1)"
    script.write_text("# %%\n" + "\n\n# %%\n".join(bodies) + "\n", "utf-8")
    first, _, last = (page.key_of(body) for body in bodies)
    assert page.draw(script, tmp_path) == {first: ["1"], last: ["2", "3"]}
    assert capsys.readouterr().out == ""


def test_pages_link_to_each_other() -> None:
    for file in sorted(page.HERE.glob("*.md")):
        text = re.sub(r"^```.*?^```$", "", file.read_text("utf-8"), flags=re.M | re.S)
        for link in re.findall(r"\]\(([^)]+)\)", text):
            place, _, part = link.partition("#")
            target = page.HERE / place if place else file
            assert target.exists(), f"{file.name}: {link}"
            if part and target.suffix == ".md":
                assert part in anchors(target), f"{file.name}: {link}"


def anchors(page: Path) -> set[str]:
    """Give the marks of a page's headings, as Markdown makes them."""
    heads = re.findall(r"^#+ (.+)$", page.read_text("utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", h).strip().lower().replace(" ", "-") for h in heads}


def test_library_code_is_shown_without_its_long_docstring() -> None:
    from refcloud.noise import man2003

    path, line, code = page.source_of(man2003)
    assert path == "refcloud/noise/hashing.py"
    assert line > 1
    assert code.count('"""') == 2
    assert "Parameters" not in code
    compile(code, path, "exec")
