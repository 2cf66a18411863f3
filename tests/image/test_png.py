"""PNG files: round trips, files of other makers, and every kind of damage."""

from __future__ import annotations

import os
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from PIL import Image

from refcloud.conventions import MOST_PIXELS
from refcloud.image import read_png, write_png
from refcloud.image.png import SIGNATURE

FILES = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])


@FILES
@given(
    codes=st.tuples(
        st.integers(1, 9), st.integers(1, 9), st.sampled_from([3, 4])
    ).flatmap(lambda shape: arrays(np.uint8, shape))
)
def test_codes_come_back(tmp_path: Path, codes: np.ndarray) -> None:
    path = tmp_path / "codes.png"
    assert write_png(path, codes) == path
    np.testing.assert_array_equal(read_png(path), codes)
    assert [found.name for found in tmp_path.iterdir()] == ["codes.png"]


def test_a_view_by_channel_is_written_too(tmp_path: Path) -> None:
    planes = np.arange(24, dtype=np.uint8).reshape(3, 2, 4).transpose(1, 2, 0)
    write_png(tmp_path / "a.png", planes)
    np.testing.assert_array_equal(read_png(tmp_path / "a.png"), planes)


@pytest.mark.parametrize(
    ("mode", "channels"),
    [("1", 3), ("L", 3), ("P", 3), ("RGB", 3), ("LA", 4), ("RGBA", 4)],
)
def test_other_kinds_of_png_are_read(tmp_path: Path, mode: str, channels: int) -> None:
    white = Image.new("RGBA" if channels == 4 else "RGB", (5, 4), "white")
    white.convert(mode).save(tmp_path / "a.png")
    codes = read_png(tmp_path / "a.png")
    assert codes.shape == (4, 5, channels)
    assert (codes == 255).all()


def test_an_indexed_file_with_a_transparent_colour_has_an_alpha(tmp_path: Path) -> None:
    image = Image.new("P", (2, 1), 1)
    image.putpalette([10, 20, 30, 40, 50, 60])
    image.save(tmp_path / "a.png", transparency=1)
    assert read_png(tmp_path / "a.png")[0, 0].tolist() == [40, 50, 60, 0]


def whole_file(folder: Path) -> bytes:
    path = folder / "whole.png"
    write_png(path, np.arange(7 * 9 * 3, dtype=np.uint8).reshape(7, 9, 3))
    return path.read_bytes()


def refusal(path: Path) -> str:
    with pytest.raises(ValueError, match=r".") as caught:
        read_png(path)
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    assert "\n" not in text
    return text


@FILES
@given(keep=st.floats(0.0, 1.0, exclude_max=True))
def test_a_file_cut_anywhere_is_refused(tmp_path: Path, keep: float) -> None:
    data = whole_file(tmp_path)
    path = tmp_path / "cut.png"
    path.write_bytes(data[: int(keep * len(data))])
    assert "expected a PNG file" in refusal(path) or "cut short" in refusal(path)


@FILES
@given(place=st.floats(0.0, 1.0, exclude_max=True), bit=st.integers(0, 7))
def test_any_wrong_bit_is_refused(tmp_path: Path, place: float, bit: int) -> None:
    data = bytearray(whole_file(tmp_path))
    data[int(place * len(data))] ^= 1 << bit
    path = tmp_path / "flipped.png"
    path.write_bytes(data)
    refusal(path)


@FILES
@given(data=st.binary(max_size=200))
@example(b"")
@example(SIGNATURE)
@example(b"GIF89a")
def test_other_bytes_are_refused(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "other.png"
    path.write_bytes(data)
    refusal(path)


@FILES
@given(data=st.binary(max_size=100), name=st.sampled_from([b"IHDR", b"IDAT", b"IEND"]))
def test_chunks_with_fitting_checksums_and_wrong_content_are_refused(
    tmp_path: Path, data: bytes, name: bytes
) -> None:
    path = tmp_path / "made.png"
    path.write_bytes(SIGNATURE + chunk(name, data) + chunk(b"IEND", b""))
    refusal(path)


def chunk(name: bytes, data: bytes) -> bytes:
    body = name + data
    return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))


def made(width: int, height: int, depth: int = 8, kind: int = 2) -> bytes:
    header = struct.pack(">IIBBBBB", width, height, depth, kind, 0, 0, 0)
    content = chunk(b"IDAT", zlib.compress(bytes(100)))
    return SIGNATURE + chunk(b"IHDR", header) + content + chunk(b"IEND", b"")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (
            made(10**6, 10**6),
            f"expected 1 to {MOST_PIXELS} pixels, got 1000000 x 1000000",
        ),
        (made(2**31 - 1, 1), "expected 1 to"),
        (made(0, 5), "got 0 x 5"),
        (made(3, 3, depth=16), "at most 8 bits a channel, got 16; save it again with"),
        (made(3, 3, kind=5), "a damaged one"),
        (made(50, 50), "a damaged one"),
        (SIGNATURE + chunk(b"IEND", b""), "no header"),
    ],
)
def test_wrong_headers_are_refused(tmp_path: Path, data: bytes, message: str) -> None:
    path = tmp_path / "made.png"
    path.write_bytes(data)
    assert message in refusal(path)


def test_an_enormous_file_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "large.png"
    with path.open("wb") as file:  # a hole: takes no room on disk
        os.truncate(file.fileno(), 10**12)
    assert "got a larger file" in refusal(path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"none\.png: .*got no such file"):
        read_png(tmp_path / "none.png")


def test_a_folder_is_no_picture(tmp_path: Path) -> None:
    assert "expected a readable file" in refusal(tmp_path)


@pytest.mark.parametrize(
    ("codes", "error"),
    [
        (np.zeros((2, 2, 3)), TypeError),
        (np.zeros((2, 2, 2), np.uint8), ValueError),
        (np.zeros((2, 2), np.uint8), ValueError),
        (np.zeros((0, 2, 3), np.uint8), ValueError),
    ],
)
def test_other_codes_are_refused(tmp_path: Path, codes, error) -> None:
    with pytest.raises(error, match="codes: expected codes of uint8"):
        write_png(tmp_path / "a.png", codes)
    assert not list(tmp_path.iterdir())


def test_a_second_header_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "two.png"
    data = made(3, 3)
    end = len(SIGNATURE) + 25  # the first chunk: 13 bytes in 12 of frame
    path.write_bytes(data[:end] + data[len(SIGNATURE) : end] + data[end:])
    assert "two headers" in refusal(path)
