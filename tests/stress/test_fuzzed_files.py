"""Damaged and strange files: read, or refused in one line, and memory stays small."""

from __future__ import annotations

import io
import tracemalloc
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from refcloud.cli.clouds import load
from refcloud.cloudmap import VoxelGrid, load_voxels, save_voxels
from refcloud.declared import load_scene, save_scene
from refcloud.image import Picture, load_picture
from refcloud.metaballs import (
    Levels,
    Metaballs,
    load_levels,
    load_metaballs,
    save_levels,
    save_metaballs,
)
from refcloud.scenes.as_files import FILES

pytestmark = pytest.mark.stress

often = settings(
    max_examples=60, deadline=None, suppress_health_check=list(HealthCheck)
)
MOST_MEMORY = 8_000_000  # bytes: the good files here have some hundred each
BALLS = Metaballs([[0, 0, 0], [1, 0.5, 0]], [2, 1], [1, 0.5])
LOADERS: dict[str, tuple[Callable[[Path], Any], str]] = {
    "voxels": (load_voxels, ".npz"),
    "balls": (load_metaballs, ".npz"),
    "levels": (load_levels, ".npz"),
    "any cloud": (lambda path: load(str(path)), ".npz"),
    "scene": (load_scene, ".toml"),
    "picture": (load_picture, ".png"),
    "light": (load_picture, ".npy"),
}


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """Give a whole file of each kind."""
    folder = tmp_path_factory.mktemp("good")
    grid = VoxelGrid(np.arange(24.0).reshape(2, 3, 4), [0, 0, 0], [4, 3, 2])
    levels = Levels((BALLS, BALLS), [[0.5] * 4, [0.4] * 4], [0.1, 0.0])
    picture = Picture(np.linspace(0, 1, 60).reshape(4, 5, 3))
    made = {
        "voxels": save_voxels(grid, folder / "a.npz"),
        "balls": save_metaballs(BALLS, folder / "b.npz"),
        "levels": save_levels(levels, folder / "c.npz"),
        "any cloud": folder / "c.npz",
        "scene": save_scene(folder / "d.toml", next(iter(FILES.values()))),
        "picture": picture.save(folder / "e.png"),
        "light": picture.save(folder / "f.npy"),
    }
    return {kind: Path(path).read_bytes() for kind, path in made.items()}


def read_or_refused(kind: str, content: bytes, folder: Path) -> str:
    """Read a file of some bytes; give the refusal, or nothing where it was read."""
    loader, suffix = LOADERS[kind]
    path = folder / f"fuzzed{suffix}"
    path.write_bytes(content)
    tracemalloc.start()
    refusal = ""
    try:
        loader(path)
    except (ValueError, TypeError) as error:
        refusal = str(error)
        assert refusal.startswith(str(path)), "the line names the file"
        assert "expected" in refusal
        assert "\n" not in refusal
    finally:
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert peak < MOST_MEMORY
    path.unlink()
    assert not list(folder.iterdir())
    return refusal


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("fuzzed")


@pytest.mark.parametrize("kind", LOADERS)
@often
@given(data=st.data())
def test_changed_bytes(kind: str, good, folder: Path, data: st.DataObject) -> None:
    content = bytearray(good[kind])
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(content) - 1))
        end = data.draw(st.integers(at, min(at + 8, len(content))))
        content[at:end] = data.draw(st.binary(max_size=8))
    read_or_refused(kind, bytes(content), folder)


@pytest.mark.parametrize("kind", LOADERS)
@often
@given(content=st.binary(max_size=200))
def test_any_bytes(kind: str, folder: Path, content: bytes) -> None:
    assert read_or_refused(kind, content, folder)


NUMBERS = st.sampled_from(
    [0, 1, -1, 2, 2**31, 2**63 - 1, 1e-300, 1e300, np.nan, np.inf, -np.inf]
)
DTYPES = st.sampled_from(["f8", "f4", "f2", ">f8", "i8", "u8", "i1", "?", "U3", "c16"])


@st.composite
def members(draw: st.DrawFn) -> np.ndarray:
    """Draw an array that may stand in a file in the place of another."""
    shape = draw(st.lists(st.integers(0, 3), max_size=4))
    dtype = np.dtype(draw(DTYPES))
    values = np.array([draw(NUMBERS) for _ in range(int(np.prod(shape)))])
    with np.errstate(all="ignore"):
        return values.reshape(shape).astype(dtype)


@pytest.mark.filterwarnings("ignore::numpy.exceptions.ComplexWarning")
@pytest.mark.parametrize("kind", ["voxels", "balls", "levels", "any cloud"])
@often
@given(data=st.data())
def test_other_arrays(kind: str, good, folder: Path, data: st.DataObject) -> None:
    arrays = dict(np.load(io.BytesIO(good[kind])))
    for name in data.draw(st.sets(st.sampled_from(sorted(arrays)), min_size=1)):
        if data.draw(st.booleans()):
            arrays[name] = data.draw(members())
        else:
            del arrays[name]
    file = io.BytesIO()
    np.savez_compressed(file, **arrays)
    read_or_refused(kind, file.getvalue(), folder)


@pytest.mark.parametrize("kind", ["voxels", "balls", "levels"])
@often
@given(
    shape=st.lists(st.integers(-2, 2**66), max_size=4),
    claimed=st.sampled_from(["<f8", "<f4", "|O", "<U9", "|V99", "x", "<i8"]),
    name=st.sampled_from(["density", "centers", "radii", "counts", "errors", "kernel"]),
)
def test_headers_that_claim_anything(kind, good, folder, shape, claimed, name) -> None:
    text = f"{{'descr': {claimed!r}, 'fortran_order': False, 'shape': {tuple(shape)}}}"
    head = text.encode().ljust(117) + b"\n"
    member = b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head + bytes(64)
    arrays = dict(np.load(io.BytesIO(good[kind])))
    if name not in arrays:
        return
    del arrays[name]
    file = io.BytesIO()
    np.savez(file, **arrays)
    with zipfile.ZipFile(file, "a") as archive:
        archive.writestr(f"{name}.npy", member)
    read_or_refused(kind, file.getvalue(), folder)


VALUES = st.recursive(
    st.one_of(
        st.booleans(),
        st.integers(-(2**70), 2**70),
        st.floats(),
        st.text(max_size=5),
        st.sampled_from([0, 1e300, -1e300, "cumulus", "hg", "a\nb"]),
    ),
    lambda inner: st.lists(inner, max_size=3),
    max_leaves=5,
)


def toml_of(value: Any) -> str:
    """Write a value as TOML has it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        signs = (f"\\U{ord(c):08x}" for c in value)
        return '"' + "".join(signs) + '"'
    if isinstance(value, list):
        return "[" + ", ".join(map(toml_of, value)) + "]"
    return repr(value)


@settings(often, max_examples=120)
@given(data=st.data())
def test_scenes_with_other_values(good, folder: Path, data: st.DataObject) -> None:
    lines = good["scene"].decode().splitlines()
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(lines) - 1))
        key, equals, _ = lines[at].partition("=")
        if equals:
            lines[at] = f"{key}= {toml_of(data.draw(VALUES))}"
        elif data.draw(st.booleans()):
            lines[at] = data.draw(
                st.sampled_from(["[cloud]", "[[look]]", "[sun]", "[camera.x]", "", "["])
            )
    text = "\n".join(lines)
    read_or_refused("scene", text.encode("utf-8", "surrogatepass"), folder)
