"""Files: round trips, and one clear line for every kind of damage."""

from __future__ import annotations

import io
import os
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import refcloud as rc
from refcloud.conventions import Shape
from refcloud.declared import load_scene
from refcloud.files import read_arrays, write_arrays, write_atomically

SHAPES = {"points": Shape("N", 3), "values": Shape("N"), "name": Shape()}
MOST = 1000


def arrays(count: int = 4) -> dict:
    points = np.arange(3.0 * count).reshape(count, 3) / 7.0
    return {"points": points, "values": np.sqrt(points[:, 0]), "name": "wyvill"}


def as_bytes(**members) -> bytes:
    kept = {k: v for k, v in members.items() if v is not None}
    buffer = io.BytesIO()
    np.savez(buffer, **kept)
    return buffer.getvalue()


def whole(**changes) -> bytes:
    members = {"format": np.array("demo"), "version": np.array(1), **arrays()}
    return as_bytes(**{**members, **changes})


def read(path: Path) -> dict:
    return read_arrays(path, "demo", 1, SHAPES, MOST)


@pytest.mark.parametrize("count", [0, 1, 5])
def test_round_trip_is_bit_for_bit(tmp_path, count):
    path = tmp_path / "a.npz"
    write_arrays(path, "demo", 1, arrays(count))
    back = read(path)
    for name in ("points", "values"):
        assert back[name].dtype == np.float64
        assert back[name].tobytes() == arrays(count)[name].tobytes()
        assert back[name].shape == arrays(count)[name].shape
    assert str(back["name"]) == "wyvill"


def test_same_arrays_give_the_same_bytes(tmp_path):
    write_arrays(tmp_path / "a", "demo", 1, arrays())
    write_arrays(tmp_path / "b", "demo", 1, arrays())
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


@pytest.mark.parametrize(
    "values", [np.zeros(4, ">f8"), np.zeros(4, np.int32), np.zeros(4, np.float32)]
)
def test_other_plain_numbers_are_read(tmp_path, values):
    (tmp_path / "a").write_bytes(whole(values=values))
    assert read(tmp_path / "a")["values"].dtype == values.dtype.newbyteorder("=")


def test_column_order_is_read(tmp_path):
    points = np.asfortranarray(arrays()["points"])
    (tmp_path / "a").write_bytes(whole(points=points))
    np.testing.assert_array_equal(read(tmp_path / "a")["points"], points)


class Stop(BaseException):
    pass


@pytest.mark.parametrize("error", [Stop, KeyboardInterrupt, ValueError])
def test_failed_write_leaves_the_old_file_and_nothing_else(tmp_path, error):
    path = tmp_path / "a.npz"
    path.write_bytes(b"old")

    def write(file):
        file.write(b"half")
        raise error

    with pytest.raises(error):
        write_atomically(path, write)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_link_stays_and_what_it_leads_to_is_written(tmp_path):
    (tmp_path / "there").mkdir()
    for name in ("there/old", "there/new"):
        link = tmp_path / name[-3:]
        link.symlink_to(name)
        write_atomically(link, lambda file: file.write(b"cloud"))
        assert link.is_symlink()
        assert (tmp_path / name).read_bytes() == b"cloud"
        write_atomically(link, lambda file: file.write(b"clouds"))
        assert (tmp_path / name).read_bytes() == b"clouds"
    assert sorted(p.name for p in tmp_path.rglob("*")) == [
        *("new", "new", "old", "old", "there"),
    ]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="needs named pipes")
def test_a_pipe_is_refused_and_stays(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    (tmp_path / "link").symlink_to("pipe")
    for path in (pipe, tmp_path / "link"):
        with pytest.raises(ValueError, match="path: expected the name of a plain file"):
            write_atomically(path, lambda file: None)
    assert pipe.is_fifo()
    assert len(list(tmp_path.iterdir())) == 2


def test_a_full_disk_names_the_file(tmp_path):
    def write(file: object) -> None:
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space left on device") as failure:
        write_atomically(tmp_path / "a", write)
    assert failure.value.filename == f"{tmp_path / 'a'}"
    assert not list(tmp_path.iterdir())


def test_write_replaces_the_old_file(tmp_path):
    path = tmp_path / "a.npz"
    path.write_bytes(b"old and longer")
    write_atomically(path, lambda file: file.write(b"new"))
    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


def test_write_refuses_a_missing_folder_and_a_folder(tmp_path):
    with pytest.raises(FileNotFoundError, match="expected an existing folder"):
        write_atomically(tmp_path / "no" / "a", lambda file: None)
    with pytest.raises(ValueError, match="got a folder"):
        write_atomically(tmp_path, lambda file: None)


@pytest.mark.parametrize(
    ("name", "got"),
    [
        ("", "path: expected the name of a file or folder, got an empty text"),
        ("a\0b.png", "path: expected the name of .*, got a text with a zero byte"),
        ("n" * 300 + ".png", "path: expected a name of at most 255 bytes, got 304; "),
        ("é" * 127 + ".png", "path: expected a name of at most 255 bytes, got 258; "),
    ],
)
def test_names_that_no_system_takes_are_refused_by_every_door(
    name, got, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    grid = rc.VoxelGrid(np.ones((1, 1, 1)), [0, 0, 0], [1, 1, 1])
    for door in (
        lambda: rc.Picture(np.zeros((1, 1, 3))).save(name),
        lambda: rc.load_picture(name),
        lambda: rc.save_voxels(grid, name),
        lambda: rc.load_voxels(name),
        lambda: rc.animate("man-10", name, frames=2, moves=rc.Moves(turn_eye=9.0)),
        lambda: load_scene(name),
        lambda: write_atomically(name, lambda file: None),
    ):
        with pytest.raises(ValueError, match=f"^{got}[^\n]*$"):
            door()
    assert not list(tmp_path.iterdir())


def test_a_name_has_room_for_its_temporary_one(tmp_path):
    room = len(f"..{os.getpid()}.part")
    write_atomically(tmp_path / ("n" * (255 - room)), lambda file: None)
    with pytest.raises(ValueError, match=f"at most {255 - room} bytes, got 255"):
        write_atomically(tmp_path / ("n" * 255), lambda file: None)


DAMAGED = {
    "not a zip": (b"P6 3 3 255 picture", "no whole .npz"),
    "empty": (b"", "no whole .npz"),
    "truncated": (whole()[:-100], "no whole .npz"),
    "other format": (whole(format=np.array("other")), "got format 'other'"),
    "no format": (whole(format=None), "got one that tells no format"),
    "number as format": (whole(format=np.array(3)), "format as a short text"),
    "long format": (whole(format=np.array("a" * 1000)), "format as a short text"),
    "future version": (whole(version=np.array(2)), "got version 2; update"),
    "version 0": (whole(version=np.array(0)), "version from 1"),
    "version text": (whole(version=np.array("1")), "version as a whole number"),
    "version fraction": (whole(version=np.array(1.5)), "version as a whole number"),
    "version array": (
        whole(version=np.array([1])),
        r"version of shape \(\), got \(1,\)",
    ),
    "missing array": (whole(points=None), "expected an array 'points'"),
    "wrong shape": (whole(points=np.zeros((4, 2))), r"points of shape \(N, 3\)"),
    "unequal sizes": (whole(values=np.zeros(5)), r"\(N,\), N = 4, got \(5,\)"),
    "objects": (
        whole(values=np.array([None] * 4, dtype=object)),
        "values as integers or floats",
    ),
    "complex": (whole(values=np.zeros(4, complex)), "values as integers or floats"),
    "records": (whole(values=np.zeros(4, "f8,f8")), "values as integers or floats"),
    "text for numbers": (whole(values=np.array(["a"] * 4)), "integers or floats"),
    "numbers for text": (whole(name=np.array(1.0)), "name as a short text"),
    "too large": (
        whole(points=np.zeros((MOST, 3)), values=np.zeros(MOST)),
        "points of at most 1000 numbers, got 3000",
    ),
}


@pytest.mark.parametrize("kind", DAMAGED)
def test_damage_is_refused_in_one_line_with_the_name(tmp_path, kind):
    content, message = DAMAGED[kind]
    path = tmp_path / "cloud.npz"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=message) as refusal:
        read(path)
    assert "cloud.npz: expected" in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_missing_file_and_folder(tmp_path):
    with pytest.raises(FileNotFoundError, match="got no such file"):
        read(tmp_path / "none.npz")
    with pytest.raises(ValueError, match="got a folder"):
        read(tmp_path)


def with_header(shape: str) -> bytes:
    """Make an archive whose values claim a shape that their bytes do not have."""
    text = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}"
    text = text.ljust(117) + "\n"
    header = b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text.encode()
    buffer = io.BytesIO(whole(values=None))
    with zipfile.ZipFile(buffer, "a") as archive:
        archive.writestr("values.npy", header + bytes(32))
    return buffer.getvalue()


@pytest.mark.parametrize(
    "shape", ["(4,", "(-4,)", "('a',)", "(4.0,)", "4", "(1 << 60,)"]
)
def test_headers_that_lie_are_refused(tmp_path, shape):
    path = tmp_path / "a.npz"
    path.write_bytes(with_header(shape))
    with pytest.raises(ValueError, match=r"a\.npz: expected"):
        read(path)


def test_sizes_are_refused_before_memory_is_taken(tmp_path):
    path = tmp_path / "a.npz"
    path.write_bytes(with_header("(1000000000000000,)"))
    shapes = {"values": Shape("N")}
    with pytest.raises(ValueError, match="of at most 1000 numbers"):
        read_arrays(path, "demo", 1, shapes, MOST)
    with pytest.raises(ValueError, match="numbers, got fewer"):
        read_arrays(path, "demo", 1, shapes, 10**18)


def test_more_bytes_than_the_header_says_are_refused(tmp_path):
    path = tmp_path / "a.npz"
    path.write_bytes(with_header("(3,)"))
    with pytest.raises(ValueError, match="got another count"):
        read_arrays(path, "demo", 1, {"values": Shape("N")}, MOST)


@pytest.fixture(scope="module")
def good(tmp_path_factory) -> tuple[Path, bytes]:
    path = tmp_path_factory.mktemp("flips") / "a.npz"
    write_arrays(path, "demo", 1, arrays())
    return path, path.read_bytes()


@given(data=st.data())
def test_a_changed_byte_is_refused_or_without_effect(good, data):
    path, content = good
    at = data.draw(st.integers(0, len(content) - 1), label="at")
    to = data.draw(st.integers(0, 255), label="to")
    path.write_bytes(content[:at] + bytes([to]) + content[at + 1 :])
    try:
        points = read(path)["points"]
    except ValueError:
        return
    assert points.tobytes() == arrays()["points"].tobytes()


@given(data=st.data())
def test_a_truncated_file_is_refused(good, data):
    path, content = good
    path.write_bytes(content[: data.draw(st.integers(0, len(content) - 1))])
    with pytest.raises(ValueError, match=r"a\.npz: expected"):
        read(path)


def test_a_header_that_unpacks_to_gigabytes_is_refused_first(tmp_path: Path) -> None:
    path = tmp_path / "bomb.npz"
    header = b"\x93NUMPY\x02\x00" + (10**8).to_bytes(4, "little") + b" " * 100_000
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("format.npy", header)
    with pytest.raises(ValueError, match="got a damaged one"):
        read_arrays(path, "refcloud.voxels", 1, {}, 1)
