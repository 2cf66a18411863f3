"""What is skipped does not show: every row of a report has its proof."""

from __future__ import annotations

import ast
import importlib
import pkgutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import skipping

PACKAGE = Path(__file__).parent.parent / "refcloud"
for found in pkgutil.iter_modules(skipping.__path__):
    importlib.import_module(f"skipping.{found.name}")


def words(node: ast.expr, names: dict[str, ast.expr]) -> list[str | None]:
    """Read an argument as texts: one, or several of a starred tuple; None else."""
    if isinstance(node, ast.Starred):
        inner = names.get(getattr(node.value, "id", ""), node.value)
        parts = inner.elts if isinstance(inner, ast.Tuple) else [inner]
        return [text for part in parts for text in words(part, names)]
    if isinstance(node, ast.Name) and node.id in names:
        return words(names[node.id], names)
    value = node.value if isinstance(node, ast.Constant) else None
    return [value if isinstance(value, str) else None]


def assigned(node: ast.Assign) -> Iterator[tuple[str, ast.expr]]:
    """List the names that an assignment gives a value, member by member of tuples."""
    for target in node.targets:
        if isinstance(target, ast.Name):
            yield target.id, node.value
        elif isinstance(target, ast.Tuple) and isinstance(node.value, ast.Tuple):
            for one, value in zip(target.elts, node.value.elts, strict=False):
                if isinstance(one, ast.Name):
                    yield one.id, value


def rows_made(source: str) -> Iterator[tuple[int, tuple[str | None, ...]]]:
    """List the rows that a file makes: line, stage and what; None where unreadable."""
    tree = ast.parse(source)
    names: dict[str, ast.expr] = {}
    nodes = [n for n in ast.walk(tree) if isinstance(n, (ast.Assign, ast.Call))]
    makers: dict[str, list[ast.expr]] = {"Skipped": []}
    for node in sorted(nodes, key=lambda n: (n.lineno, n.col_offset)):
        if isinstance(node, ast.Assign):
            for name, value in assigned(node):
                names[name] = value
                if isinstance(value, ast.Call) and _named(value) == "partial":
                    first, *rest = value.args
                    if getattr(first, "id", "") == "Skipped":
                        makers[name] = rest
            continue
        stages = [k.value for k in node.keywords if k.arg == "stage"]
        if _named(node) == "replace" and stages:  # a row of another stage, renamed
            yield node.lineno, (words(stages[0], names)[0], "octaves too fine to show")
        elif isinstance(node.func, ast.Name) and node.func.id in makers:
            given = [*makers[node.func.id], *node.args]
            read = [text for part in given for text in words(part, names)]
            yield node.lineno, tuple(read[:2])


def _named(call: ast.Call) -> str:
    return getattr(call.func, "attr", getattr(call.func, "id", ""))


EVERY = {
    f"{path.relative_to(PACKAGE)}:{line}": row
    for path in sorted(PACKAGE.rglob("*.py"))
    for line, row in rows_made(path.read_text("utf-8"))
}


@pytest.mark.parametrize("place", EVERY)
def test_every_row_that_can_be_reported_has_a_proof(place: str) -> None:
    stage, what = EVERY[place]
    assert stage, "write the stage as a text, that it can be read here"
    assert what, "write the row's name as a text, that it can be read here"
    assert (stage, what) in {p.row for p in skipping.PROOFS}, (
        f"({stage!r}, {what!r}): enter a proof in tests/skipping/"
    )


def test_no_proof_is_left_over() -> None:
    assert {p.row for p in skipping.PROOFS} <= set(EVERY.values())


def test_the_reader_of_rows_itself() -> None:
    source = (
        'what, of = "balls", 3\nrows = [Skipped("eye", what, 1, of)]\n'
        'both = "noise", "octaves"\nSkipped(*both, 1, 2)\n'
        'told = functools.partial(Skipped, "eye", how="x")\ntold("tiles", 1, 2)\n'
        'replace(row, stage="erosion")\nSkipped(name, f"{x}", 1, 2)\n'
    )
    assert [row for _, row in rows_made(source)] == [
        ("eye", "balls"),
        ("noise", "octaves"),
        ("eye", "tiles"),
        ("erosion", "octaves too fine to show"),
        (None, None),
    ]


@pytest.mark.parametrize(
    "proof", skipping.PROOFS, ids=lambda p: f"{p.stage}:{p.run.__name__}"
)
def test_what_is_skipped_changes_no_more_than_its_bound(proof) -> None:
    found = proof.run()
    (row,) = [row for row in found.rows if (row.stage, row.what) == proof.row]
    assert 0 < row.skipped <= row.of, "the scene has something to skip"
    bound = row.bound
    if proof.together:
        bound = sum(other.bound for other in found.rows if other.unit == row.unit)
    change = float(np.abs(found.skipping - found.whole).max())
    assert change <= bound + proof.rounding
    assert np.abs(found.whole).max() > 0.0, "there is something to change"
    if row.bound > 1e-9 and not proof.together:
        assert change > 0.0, "with a bound the saving shows: it was switched off"
