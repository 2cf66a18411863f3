"""Every code in a docstring stands in refcloud/references.py, and every one is used."""

from __future__ import annotations

import re
from pathlib import Path

from refcloud.references import DOCUMENTS, ERRATA, PIECES

ROOT = Path(__file__).parent.parent
OWN = ROOT / "refcloud" / "references.py"
SOURCES = {
    path: path.read_text("utf-8")
    for path in (ROOT / "refcloud").rglob("*.py")
    if path != OWN
}
TESTS = "\n".join(path.read_text("utf-8") for path in (ROOT / "tests").rglob("*.py"))


def codes(letters: str) -> set[str]:
    pattern = rf"\b[{letters}][0-9][0-9]\b"
    return {code for text in SOURCES.values() for code in re.findall(pattern, text)}


def test_every_piece_is_listed_and_used() -> None:
    assert codes("AFGLNRTUVWX") == set(PIECES)


def test_every_erratum_is_listed_and_met() -> None:
    assert codes("E") <= set(ERRATA)
    assert set(ERRATA) <= codes("E"), "an erratum without a docstring that meets it"


def test_every_erratum_has_a_test_that_names_it() -> None:
    named = {code.upper() for code in re.findall(r"def test_(e[0-9][0-9])_", TESTS)}
    assert named == set(ERRATA)


def test_documents_are_cited_by_their_letter() -> None:
    texts = "\n".join(SOURCES.values())
    for letter in "MDC":
        assert re.search(rf"\b(paper|document) {letter}\b", texts), letter
    assert set(DOCUMENTS) == set("MSDC")


def test_no_docstring_cites_a_file_that_is_not_here() -> None:
    for path, text in SOURCES.items():
        for name in re.findall(r"\b[\w/-]+\.md\b", text):
            assert (ROOT / name).exists(), f"{path.name}: {name}"
