"""Turns tutorials into pages: comments to Markdown, code to fences, shows to pictures.

python tutorials/page.py                 all pages, and the list of them
python tutorials/page.py --pictures 02   first draw the pictures of tutorial 02 anew

What the cells print is kept beside the pictures when they are drawn: pages show it.
"""

from __future__ import annotations

import ast
import contextlib
import hashlib
import inspect
import io
import json
import os
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from lesson import HERE, PICTURES, source_of

from refcloud.bench.timing import machine
from refcloud.cli.docstrings import summary

QUICK = PICTURES / "quick"  # the same, small, as the tests draw them
CELL = re.compile(r"^# %%(.*)$", re.MULTILINE)
DRAWS = ("show", "strip", "row", "plot")
SOLUTIONS = "## Solutions"
MACHINE = "machine"  # the key of the class of machine, among those of the cells


def tutorials() -> list[Path]:
    """List the tutorials in their order."""
    return sorted(HERE.glob("[0-9][0-9]_*.py"))


def cells(text: str) -> list[tuple[bool, str]]:
    """Part a percent-format file into cells: whether each is Markdown, and its text."""
    parts = CELL.split(text)
    found = []
    for kind, body in zip(parts[1::2], parts[2::2], strict=True):
        markdown = "[markdown]" in kind
        if markdown:
            body = re.sub(r"^# ?", "", body, flags=re.MULTILINE)
        found.append((markdown, body.strip("\n")))
    return found


def calls(code: str) -> list[tuple[str, ast.Call]]:
    """List the calls of a lesson's methods in a cell, in their order."""
    return [
        (node.func.attr, node)
        for node in ast.walk(ast.parse(code))
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and isinstance(node.func.value, ast.Name)
        and node.func.value.id == "lesson"
    ]


def pictures_of(path: Path) -> dict[str, str]:
    """Give the pictures that a tutorial declares: captions by name, in their order."""
    found = {}
    for markdown, body in cells(path.read_text("utf-8")):
        for method, call in [] if markdown else calls(body):
            if method in DRAWS:
                texts = [_text(a) for a in call.args[1:]]
                name, caption = [text for text in texts if text is not None][-2:]
                found[name] = caption
    return found


def key_of(body: str) -> str:
    """Name a cell by its code: what another code printed is not shown under it."""
    return hashlib.sha256(body.encode()).hexdigest()[:12]


def stored(path: Path) -> dict[str, Any]:
    """Read what a tutorial's cells printed: lines by `key_of`, and the machine."""
    file = PICTURES / f"{path.name[:2]}.json"
    return json.loads(file.read_text("utf-8")) if file.exists() else {}


def _text(node: ast.expr) -> str | None:
    """Give a text, written in one piece or in several."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return node.value
    return None


def page_of(path: Path) -> str:
    """Write a tutorial's page.

    Parameters
    ----------
    path
        Of the tutorial.

    Returns
    -------
    Markdown.
    """
    text = path.read_text("utf-8")
    names: dict[str, Any] = {}
    for node in ast.parse(text).body:
        if isinstance(node, (ast.Import, ast.ImportFrom)):
            exec(compile(ast.Module([node], []), path.name, "exec"), names)
    parts, folded, printed = [], False, stored(path)
    for markdown, body in cells(text):
        if markdown and SOLUTIONS in body:
            body = body.replace(
                SOLUTIONS, f"{SOLUTIONS}\n\n<details><summary>Show</summary>\n"
            )
            folded = True
        parts += [body] if markdown else shown_code(body, names, printed)
    if folded:
        parts.append("</details>")
    parts.append(_foot(path))
    return "\n\n".join(parts) + "\n"


def shown_code(body: str, names: dict[str, Any], printed: dict[str, Any]) -> list[str]:
    """Give a cell's code, the library's that it names, what it prints and draws."""
    parts, tree = [], ast.parse(body)
    shown = calls(body)
    sources = [call for method, call in shown if method == "source"]
    if len(tree.body) > len(sources):
        parts.append(f"```python\n{body}\n```")
    for call in sources:
        for argument in call.args:
            dotted = ast.unparse(argument)
            path, _, code = source_of(eval(dotted, names))
            link = f"[`{path}`](../{path})"
            parts.append(f"From {link}:\n\n```python\n{code}\n```")
            if path.startswith("refcloud/plain/"):
                parts += _called(eval(dotted, names), code)
    if lines := printed.get(key_of(body)):
        parts.append("It prints:\n\n```text\n" + "\n".join(lines) + "\n```")
        if any(method == "timed" for method, _ in shown):
            parts.append(TIMES.format(printed[MACHINE]))
    for method, call in shown:
        if method in DRAWS:
            texts = [_text(a) for a in call.args[1:]]
            name, caption = [text for text in texts if text is not None][-2:]
            parts.append(f"![{caption}](pictures/{name}.png)")
    return parts


def _called(function: Callable[..., Any], code: str) -> list[str]:
    """Say what a plain form calls, where it stands and what it does, folded."""
    room = inspect.unwrap(function).__globals__
    named = {
        node.func.id: room.get(node.func.id)
        for node in ast.walk(ast.parse(code))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    }
    rows = {}
    for name, what in named.items():
        place = str(getattr(what, "__module__", "")).replace(".", "/") + ".py"
        if place.startswith("refcloud/"):
            rows[name] = f"* `{name}`, [`{place}`](../{place}): {summary(what)}"
    if not rows:
        return []
    head = ", ".join(f"<code>{name}</code>" for name in rows)
    fold = f"<details><summary>It calls {head}</summary>"
    return [fold, "\n".join(rows.values()), "</details>"]


TIMES = "(Times are of one core of the machine that drew this page: {}.)"


def _foot(path: Path) -> str:
    """Link to the neighbours, and say how the page is run."""
    every = tutorials()
    k = every.index(path)
    links = []
    if k > 0:
        links.append(f"[← {title_of(every[k - 1])}]({every[k - 1].stem}.md)")
    if k + 1 < len(every):
        links.append(f"[{title_of(every[k + 1])} →]({every[k + 1].stem}.md)")
    run = f"`python tutorials/{path.name} --help` lists the parameters,"
    run += " `--sliders` opens a page with a slider for each."
    return "---\n\n" + run + "\n\n" + " · ".join(links)


def title_of(path: Path) -> str:
    """Give a tutorial's title."""
    return cells(path.read_text("utf-8"))[0][1].splitlines()[0].removeprefix("# ")


INDEX = """# Tutorials

Each is one file of plain Python in cells that runs with nothing but refcloud:

```sh
python tutorials/01_ten_lines.py              # its pictures, into the current folder
python tutorials/01_ten_lines.py --count 30   # the main one, with another value
python tutorials/01_ten_lines.py --sliders    # a page with a slider for each parameter
```

With `--quick` everything is small and fast, sliders too. In an editor that knows cells,
or in a notebook, the pictures show where they are made.
The pages below are written from the files by `python tutorials/page.py`.
[For teachers](teachers.md): a course of eight sessions, and pictures that students'
own code can be compared with.

"""


def index() -> str:
    """Write the page that lists all tutorials."""
    return INDEX + table()


def table(folder: str = "") -> str:
    """Write the table of tutorials, with the first picture of each.

    Parameters
    ----------
    folder
        Where the tutorials are, as seen from the page that holds the table.
    """
    rows = ["| | tutorial | |", "|---|---|---|"]
    for path in tutorials():
        name, caption = next(iter(pictures_of(path).items()))
        number, _, title = title_of(path).partition(" · ")
        source = f"{folder}pictures/{name}.png"
        picture = f'<img src="{source}" width="120" alt="{title}">'
        link = f"[**{number}** {title}]({folder}{path.stem}.md)"
        rows.append(f"| {picture} | {link} | {caption} |")
    return "\n".join(rows) + "\n"


def draw(path: Path, folder: Path, *flags: str) -> dict[str, list[str]]:
    """Run a tutorial as a reader does, its pictures into a folder.

    Parameters
    ----------
    path, folder
        Of the tutorial, and where its pictures go.
    flags
        Of the run.

    Returns
    -------
    The lines that each cell printed, by `key_of`; of cells that print.
    """
    words, paths = sys.argv, list(sys.path)
    sys.argv = [str(path), *flags, "--output", str(folder)]
    text, printed = path.read_text("utf-8"), {}
    names: dict[str, Any] = {"__name__": "__main__"}
    try:
        for markdown, body in cells(text):
            if markdown:
                continue
            above = "\n" * text[: text.index(body)].count("\n")  # lines keep numbers
            with contextlib.redirect_stdout(io.StringIO()) as said:
                exec(compile(above + body, str(path), "exec"), names)
            if lines := said.getvalue().splitlines():
                printed[key_of(body)] = lines
    finally:
        sys.argv, sys.path = words, paths
    return printed


def _keep(path: Path, printed: dict[str, list[str]]) -> None:
    """Store what a tutorial printed beside its pictures; nothing where it is silent."""
    file = PICTURES / f"{path.name[:2]}.json"
    file.unlink(missing_ok=True)
    if printed:
        text = json.dumps({MACHINE: machine(), **printed}, indent=1, ensure_ascii=False)
        file.write_text(text + "\n", "utf-8", newline="\n")


def main(words: list[str]) -> None:
    """Write the pages; with --pictures draw those of the named tutorials first."""
    if words[:1] == ["--pictures"]:
        os.environ.setdefault("OMP_NUM_THREADS", "1")
        QUICK.mkdir(exist_ok=True)
        for path in tutorials():
            if not words[1:] or path.name[:2] in words[1:]:
                for old in QUICK.glob(f"{path.name[:2]}-*.png"):
                    old.unlink()
                _keep(path, draw(path, PICTURES))
                draw(path, QUICK, "--quick")
    for path in tutorials():
        path.with_suffix(".md").write_text(page_of(path), "utf-8", newline="\n")
    (HERE / "README.md").write_text(index(), "utf-8", newline="\n")


if __name__ == "__main__":
    main(sys.argv[1:])
