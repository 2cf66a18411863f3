"""The page of the errata: what is printed, what holds, why, a figure, and the tests.

python tutorials/errata.py               the page
python tutorials/errata.py --pictures    the page, and its pictures anew
"""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from collections import defaultdict
from pathlib import Path

from errata_hash import FIGURES as HASH
from errata_light import FIGURES as LIGHT
from errata_noise import FIGURES as NOISE
from errata_shape import FIGURES as SHAPE
from errata_sheet import Draw, Figure
from errata_skies import FIGURES as SKIES
from errata_splats import FIGURES as SPLATS

from refcloud.image import write_png
from refcloud.references import DOCUMENTS, ERRATA

HERE = Path(__file__).parent
TESTS = HERE.parent / "tests"
PAGE = HERE / "errata.md"
PICTURES = HERE / "pictures" / "errata"
FIELDS = {"where", "printed", "right", "reason"}
NUMBERS = [f"E{number:02}" for number in range(1, 39)]
FIGURES: dict[str, Draw] = dict(
    sorted((HASH | NOISE | SHAPE | LIGHT | SPLATS | SKIES).items())
)
CARRIER = re.compile(r"(?:^|_)e(\d\d)(?=_|$)")  # of a number, in a test's name
ANY = re.compile(r"_e\d\d[_(]")


def entries() -> dict[str, dict[str, str]]:
    """Read what is said of each erratum."""
    return tomllib.loads((HERE / "errata.toml").read_text("utf-8"))


def holders(folder: Path = TESTS) -> dict[str, list[tuple[str, str]]]:
    """Find the tests that carry an erratum's number in their name.

    Parameters
    ----------
    folder
        Where the tests lie.

    Returns
    -------
    By number, (file relative to the folder's parent, name) of each test.
    """
    found: dict[str, list[tuple[str, str]]] = defaultdict(list)
    for path in sorted(folder.rglob("test_*.py")):
        text = path.read_text("utf-8")
        # Most files carry none: they need not be parsed.
        for node in ast.walk(ast.parse(text if ANY.search(text) else "")):
            if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
                for number in CARRIER.findall(node.name):
                    file = path.relative_to(folder.parent).as_posix()
                    found[f"E{number}"].append((file, node.name))
    return dict(found)


def refuse_gaps(told: dict[str, dict[str, str]], held: dict[str, list]) -> None:
    """Refuse a page on which an erratum lacks its entry, figure, short form or test."""
    for number in NUMBERS:
        lacks = [
            what
            for what, there in (
                ("an entry in errata.toml", set(told.get(number, {})) == FIELDS),
                ("a short form in refcloud/references.py", number in ERRATA),
                ("a figure", number in FIGURES),
                ("a test that carries its number", bool(held.get(number))),
            )
            if not there
        ]
        if lacks:
            raise ValueError(f"{number} lacks {', '.join(lacks)}")
    others = (set(told) | set(ERRATA) | set(FIGURES) | set(held)) - set(NUMBERS)
    if others:
        raise ValueError(f"no erratum has the number {', '.join(sorted(others))}")


def draw() -> dict[str, Figure]:
    """Draw every figure."""
    return {number: figure() for number, figure in FIGURES.items()}


def page_of(figures: dict[str, Figure]) -> str:
    """Write the page.

    Parameters
    ----------
    figures
        By number.

    Returns
    -------
    Markdown.
    """
    told, held = entries(), holders()
    refuse_gaps(told, held)
    documents = "\n".join(f"- **{key}** {text}" for key, text in DOCUMENTS.items())
    rows = "\n".join(
        f"| [{n}](#{n.lower()}) | {cell(ERRATA[n][0])} | {cell(ERRATA[n][1])} |"
        for n in NUMBERS
    )
    parts = [
        "# Errata",
        "What is wrong, or open, in the documents that refcloud implements; what"
        " refcloud does instead, and why. Numbers below the pictures are computed by"
        " the library as `python tutorials/errata.py` writes the page; a test writes it"
        " again and compares. In the pictures red is the printed form and blue"
        " refcloud's, where nothing else is said.",
        documents,
        "| | printed, or left open | in refcloud |\n|---|---|---|\n" + rows,
    ]
    for number in NUMBERS:
        parts += section(number, told[number], figures[number], held[number])
    return "\n\n".join(parts) + "\n"


def cell(text: str) -> str:
    """Write a text for a table."""
    return text.replace("|", "\\|")


def section(
    number: str, entry: dict[str, str], figure: Figure, tests: list[tuple[str, str]]
) -> list[str]:
    """Write what the page says of one erratum."""
    short = ERRATA[number][0]
    parts = [
        f"## {number}",
        f"**{short}** ({entry['where']})",
        f"- printed: {entry['printed']}\n- in refcloud: {entry['right']}",
        entry["reason"],
    ]
    if figure.canvas is not None:
        file = f"pictures/{PICTURES.name}/{number.lower()}.png"
        parts.append(f"![{number}: {short}]({file})")
    files: dict[str, list[str]] = defaultdict(list)
    for file, test in tests:
        files[file].append(f"`{test}`")
    lines = [f"- [{f}](../{f}): {', '.join(tests)}" for f, tests in files.items()]
    return [*parts, figure.line, "Held by\n\n" + "\n".join(lines)]


def main(words: list[str]) -> None:
    """Write the page, and with --pictures what it shows."""
    figures = draw()
    PAGE.write_text(page_of(figures), "utf-8", newline="\n")
    if words == ["--pictures"]:
        PICTURES.mkdir(parents=True, exist_ok=True)
        for number, figure in figures.items():
            if figure.canvas is not None:
                write_png(PICTURES / f"{number.lower()}.png", figure.codes())


if __name__ == "__main__":
    main(sys.argv[1:])
