"""Animated files: every frame, its time, and the loop, as another reader sees them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from refcloud.image import write_animation, write_png
from refcloud.image.png import chunks

COUNT, HEIGHT, WIDTH = 5, 12, 16


def frame(index: int, channels: int = 3) -> np.ndarray:
    down, across = np.mgrid[0:HEIGHT, 0:WIDTH]
    base = (10 * down + 5 * across + 40 * index) % 250
    return np.repeat(base[..., None], channels, axis=2).astype(np.uint8)


@pytest.fixture
def files(tmp_path: Path) -> list[Path]:
    return [write_png(tmp_path / f"{i}.png", frame(i)) for i in range(COUNT)]


def read(path: Path) -> tuple[list[np.ndarray], list[float], int]:
    frames, times = [], []
    with Image.open(path) as image:
        loop = image.info["loop"]
        for index in range(image.n_frames):
            image.seek(index)
            frames.append(np.asarray(image.convert("RGB")))
            times.append(float(image.info["duration"]))
    return frames, times, loop


@pytest.mark.parametrize("name", ["a.png", "a.apng"])
def test_apng_holds_the_frames_to_the_bit(name: str, files, tmp_path: Path) -> None:
    path = write_animation(tmp_path / name, files, fps=24.0)
    frames, times, loop = read(path)
    assert (len(frames), loop) == (COUNT, 0)
    for index, codes in enumerate(frames):
        np.testing.assert_array_equal(codes, frame(index))
    np.testing.assert_allclose(times, 1000.0 / 24.0)


def test_apng_counts_its_chunks(files, tmp_path: Path) -> None:
    path = write_animation(tmp_path / "a.png", files, fps=10.0)
    found = list(chunks(path, path.read_bytes()))
    numbers = [
        int.from_bytes(data[:4], "big")
        for name, data in found
        if name in (b"fcTL", b"fdAT")
    ]
    assert numbers == list(range(2 * COUNT - 1))
    control = next(data for name, data in found if name == b"acTL")
    assert control == COUNT.to_bytes(4, "big") + bytes(4)
    # A reader that knows no animation sees the first frame.
    assert [name for name, _ in found].index(b"IDAT") == 3


def test_apng_keeps_partial_cover(tmp_path: Path) -> None:
    files = [write_png(tmp_path / f"{i}.png", frame(i, 4)) for i in range(2)]
    with Image.open(write_animation(tmp_path / "a.png", files, fps=5.0)) as image:
        image.seek(1)
        np.testing.assert_array_equal(np.asarray(image.convert("RGBA")), frame(1, 4))


def test_gif_has_every_frame_and_its_time(files, tmp_path: Path) -> None:
    path = write_animation(tmp_path / "a.gif", files, fps=24.0)
    frames, times, loop = read(path)
    assert (len(frames), loop) == (COUNT, 0)
    for index, codes in enumerate(frames):
        # 192 pixels have fewer than 256 colours: none is changed.
        np.testing.assert_array_equal(codes, frame(index))
    # 1/24 s is 4 1/6 hundredths: the mean holds, not every one.
    assert times == [40.0, 40.0, 40.0, 50.0, 40.0]


def test_webp_has_every_frame_and_its_time(files, tmp_path: Path) -> None:
    path = write_animation(tmp_path / "a.webp", files, fps=30.0)
    frames, times, loop = read(path)
    assert (len(frames), loop) == (COUNT, 0)
    for index, codes in enumerate(frames):
        # Lossy: near the frame, and nearer to it than to any other.
        off = [np.abs(codes.astype(int) - frame(k)).mean() for k in range(COUNT)]
        assert int(np.argmin(off)) == index
        assert off[index] < 12.0
    assert times == [33.0, 34.0, 33.0, 33.0, 34.0]


@pytest.mark.parametrize("suffix", [".png", ".gif", ".webp"])
def test_the_same_frames_give_the_same_file(suffix: str, files, tmp_path: Path) -> None:
    one = write_animation(tmp_path / f"a{suffix}", files, fps=24.0).read_bytes()
    assert write_animation(tmp_path / f"b{suffix}", files, fps=24.0).read_bytes() == one


@pytest.mark.parametrize("suffix", [".png", ".gif", ".webp"])
def test_unlike_frames_are_refused_and_nothing_is_left(suffix, files, tmp_path) -> None:
    files[2] = write_png(tmp_path / "other.png", frame(2)[:-1])
    with pytest.raises(ValueError, match=r"other.png: expected a frame of the size"):
        write_animation(tmp_path / f"a{suffix}", files, fps=24.0)
    assert not list(tmp_path.glob("*a.*"))


def test_what_a_format_cannot_hold_is_refused(files, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"path: expected a name ending in \.png, "):
        write_animation(tmp_path / "a.mp4", files, fps=24.0)
    with pytest.raises(ValueError, match="frames: expected at least one"):
        write_animation(tmp_path / "a.png", [], fps=24.0)
    with pytest.raises(ValueError, match=r"fps: expected .*\[0.01, 100\]"):
        write_animation(tmp_path / "a.png", files, fps=0.0)
    clear = write_png(tmp_path / "clear.png", frame(0, 4))
    with pytest.raises(ValueError, match=r"path: expected an opaque background"):
        write_animation(tmp_path / "a.gif", [clear], fps=24.0)
    long = write_png(tmp_path / "long.png", np.zeros((1, 16384, 3), np.uint8))
    with pytest.raises(ValueError, match=r"path: .*16383 pixels in \.webp"):
        write_animation(tmp_path / "a.webp", [long], fps=24.0)
