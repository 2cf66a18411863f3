"""The house holds together: who imports whom, how long files are, what they say."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parent.parent / "refcloud"
FILES = sorted(PACKAGE.rglob("*.py"))
LONGEST_FILE = 300

# From the ground up. A file imports from lower floors and from its own room only.
FLOORS = (
    ("conventions", "interrupts", "references", "products"),
    ("refusal", "frozen"),
    ("paths", "shapes"),
    ("checking", "extremes"),
    ("files", "parameters", "processes"),
    ("noise", "optics", "camera", "image"),
    ("cloudmap", "drawing"),
    ("metaballs", "transport"),
    ("raster", "march"),
    ("lighting", "sky"),
    ("compose", "scene", "noise_pictures", "choices", "scattering_pictures"),
    ("march_picture", "figure"),
    ("render", "declared"),
    ("scenes", "fit_pictures", "animation", "figure_pages"),
    ("bench", "studio"),
    ("cli",),
    ("__main__",),
)
LEVEL = {room: level for level, rooms in enumerate(FLOORS) for room in rooms}
TOP_OF_GL = LEVEL["lighting"]  # the optional backend may import up to here
PLAIN_MAY = {"__future__", "math", "typing", "collections.abc"}


def room_of(path: Path) -> str:
    return path.relative_to(PACKAGE).with_suffix("").parts[0]


def name_of(path: Path) -> str:
    return path.relative_to(PACKAGE.parent).as_posix()


def imported(tree: ast.AST) -> list[str]:
    """List the full names of modules that a file imports, wherever it does."""
    names = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = "." * node.level + (node.module or "")
            if base == "refcloud":  # from refcloud import noise
                names += [f"{base}.{alias.name}" for alias in node.names]
            else:
                names.append(base)
    return names


def broken_imports(room: str, names: list[str]) -> list[str]:
    """List the imports that the floors forbid to a file of a room."""
    broken = []
    for name in names:
        if name.startswith("."):
            broken.append(f"{name}: write imports in full")
        if room == "plain" and name not in PLAIN_MAY:
            if not re.match(r"refcloud\.(plain|conventions)\b", name):
                broken.append(f"{name}: plain imports math and conventions only")
            continue
        if name.split(".")[0] != "refcloud" or room == "plain":
            continue
        other = name.split(".")[1] if "." in name else "__init__"
        if other == room:
            continue
        if other == "plain" and room == "bench":
            continue  # the twins are references to measure against
        if other in ("plain", "gl"):
            broken.append(f"{name}: nothing imports {other}")
        elif other == "__init__":
            if room not in ("cli", "__main__"):
                broken.append(f"{name}: import the room, not the whole package")
        elif room == "gl":
            if LEVEL[other] > TOP_OF_GL:
                broken.append(f"{name}: gl imports the floors up to lighting")
        elif LEVEL[other] >= LEVEL[room]:
            broken.append(f"{name}: not below {room}")
    return broken


# The public door alone imports every room.
@pytest.mark.parametrize("path", FILES[1:], ids=name_of)
def test_imports_go_downward(path: Path) -> None:
    assert FILES[0] == PACKAGE / "__init__.py"
    room = room_of(path)
    assert room in LEVEL or room in ("plain", "gl"), f"{room}: enter it in FLOORS"
    assert not broken_imports(room, imported(ast.parse(path.read_text("utf-8"))))


@pytest.mark.parametrize(
    ("room", "name", "allowed"),
    [
        ("raster", "refcloud.image.encode", True),
        ("raster", "refcloud.raster.splat", True),
        ("raster", "numpy", True),
        ("image", "refcloud.raster", False),
        ("noise", "refcloud.image", False),
        ("sky", "refcloud.lighting", False),
        ("files", "refcloud.checking", True),
        ("checking", "refcloud.files", False),
        ("noise", "refcloud.plain.noise", False),
        ("bench", "refcloud.plain.noise", True),
        ("render", "refcloud.gl", False),
        ("noise", "refcloud", False),
        ("noise", ".hashing", False),
        ("plain", "math", True),
        ("plain", "refcloud.plain.noise", True),
        ("plain", "refcloud.conventions", True),
        ("plain", "refcloud.noise", False),
        ("plain", "numpy", False),
        ("gl", "refcloud.lighting", True),
        ("gl", "refcloud.render", False),
        ("cli", "refcloud", True),
    ],
)
def test_the_rule_of_imports_itself(room: str, name: str, allowed: bool) -> None:
    assert (not broken_imports(room, [name])) is allowed


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_files_are_short(path: Path) -> None:
    lines = len(path.read_text("utf-8").splitlines())
    assert lines <= LONGEST_FILE, f"{lines} lines: it holds two ideas, split it"


def test_no_test_has_a_name_that_pytest_passes_over() -> None:
    """Of a file of tests every function is one, or something there names it."""
    lost = []
    for path in sorted(Path(__file__).parent.rglob("test_*.py")):
        tree = ast.parse(path.read_text("utf-8"))
        named = {
            getattr(node, field)
            for node in ast.walk(tree)
            for kind, field in (
                (ast.Name, "id"),
                (ast.Attribute, "attr"),
                (ast.arg, "arg"),
            )
            if isinstance(node, kind)
        }
        lost += [
            f"{path.name}: {node.name}"
            for node in tree.body
            if isinstance(node, ast.FunctionDef)
            and not node.name.startswith("test_")
            and node.name not in named
        ]
    assert not lost, f"never run: {lost}"


@pytest.mark.parametrize(
    "path", [p for p in FILES if p.name == "__init__.py"], ids=name_of
)
def test_doors_hold_no_code(path: Path) -> None:
    body = ast.parse(path.read_text("utf-8")).body
    assert ast.get_docstring(ast.parse(path.read_text("utf-8"))), "say what is inside"
    for node in body[1:]:
        names = {
            target.id
            for target in getattr(node, "targets", [])
            if isinstance(target, ast.Name)
        }
        assert isinstance(node, (ast.Import, ast.ImportFrom)) or (
            names and names <= {"__all__", "__version__"}
        ), f"line {node.lineno}: code in a door"


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_chance_comes_from_hashes_alone(path: Path) -> None:
    tree = ast.parse(path.read_text("utf-8"))
    modules = imported(tree)
    assert not [m for m in modules if m in ("random", "secrets", "numpy.random")]
    drawn = [
        node.lineno
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute)
        and node.attr == "random"
        and isinstance(node.value, ast.Name)
        and node.value.id in ("np", "numpy")
    ]
    assert not drawn, f"numpy.random on lines {drawn}"


def functions(path: Path) -> list[ast.FunctionDef]:
    """List the public functions of a file: those that check their arguments."""
    return [
        node
        for node in ast.parse(path.read_text("utf-8")).body
        if isinstance(node, ast.FunctionDef)
        and not node.name.startswith("_")
        and any(isinstance(d, ast.Name) and d.id == "checked" for d in _marks(node))
    ]


def _marks(node: ast.FunctionDef) -> list[ast.expr]:
    return node.decorator_list


PUBLIC = [(path, node) for path in FILES for node in functions(path)]


def section(text: str, title: str) -> str:
    """Give the lines of a numpydoc section of a cleaned docstring."""
    pattern = rf"^{title}\n-+\n((?:(?!^[A-Z][a-z]+\n---).*\n?)*)"
    match = re.search(pattern, text, re.M)
    return match.group(1) if match else ""


def described(text: str) -> set[str]:
    """Give the names that a docstring's Parameters describe."""
    heads = re.findall(r"^(\S[^\n]*)\n    \S", section(text, "Parameters"), re.M)
    return {name.strip(" *") for head in heads for name in head.split(",")}


@pytest.mark.parametrize(
    ("path", "node"), PUBLIC, ids=[f"{name_of(p)}:{n.name}" for p, n in PUBLIC]
)
def test_public_functions_say_what_they_do(path: Path, node: ast.FunctionDef) -> None:
    text = ast.get_docstring(node)
    assert text, "no docstring"
    spec = node.args
    every = [*spec.posonlyargs, *spec.args, spec.vararg, *spec.kwonlyargs, spec.kwarg]
    every = [argument for argument in every if argument]
    names = {argument.arg for argument in every}
    assert not names - described(text), "parameters without a description"
    assert not described(text) - names, "descriptions without a parameter"
    assert all(argument.annotation for argument in every), "an annotation is missing"
    nothing = isinstance(node.returns, ast.Constant) and node.returns.value is None
    assert nothing or section(text, "Returns").strip(), "no Returns"
    assert re.search(r"^Source: \S", text, re.M), "no Source: which paper or issue?"


def test_the_reader_of_docstrings_itself() -> None:
    text = "Do.\n\nParameters\n----------\na, b\n    Two.\nc\n    One.\n\n"
    text += "Returns\n-------\nIt.\n\nSource: paper M, eq 1.\n"
    assert described(text) == {"a", "b", "c"}
    assert section(text, "Returns").startswith("It.")
    assert section(text, "Raises") == ""
