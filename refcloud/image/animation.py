"""Frames to one animated file: APNG, GIF or WebP, one frame in memory at a time.

APNG holds the very chunks of the frames' PNG files, nothing is encoded again. GIF has
256 colours a frame; WebP is lossy at a quality where nothing shows.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any, BinaryIO

import numpy as np
from PIL import GifImagePlugin, Image

from refcloud.checking import checked, complaint
from refcloud.conventions import Range
from refcloud.files import write_atomically
from refcloud.image.png import SIGNATURE, chunks, read_png

Rate = Annotated[float, Range(0.01, 100.0, "frames per second")]
SUFFIXES = (".png", ".apng", ".gif", ".webp")
FOREVER = 0  # how the three formats say that an animation starts again at its end
GIF_LONGEST = 65_535  # pixels along a side, and hundredths of a second
WEBP_LONGEST = 16_383  # pixels along a side
WEBP_QUALITY = 90  # of 100
FINEST_RATE = 600  # parts of a frame per second: both numbers of a delay fit 16 bits
COLOURS = 256
SHOW_WHOLE = (0, 0)  # APNG: leave the frame as it is; put the next in its place


@checked
def write_animation(path: str | Path, frames: Sequence[Path], *, fps: Rate) -> Path:
    """Write PNG files of one size as an animated file; it is whole or absent.

    Formula: frame i is shown from i / fps to (i + 1) / fps seconds, over and over

    Parameters
    ----------
    path
        Name of the file, ending in .png, .apng, .gif or .webp; an old one is replaced.
    frames
        PNG files of 8 bits a channel, in their order, all of one size and kind.
    fps
        Frames per second. GIF counts in hundredths of a second; its frames take turns
        so that the mean holds.

    Returns
    -------
    The path.

    Raises
    ------
    ValueError
        The name ends otherwise, there are no frames, they differ in size or kind, or
        the format cannot hold them.

    Source: the specifications of PNG (third edition), GIF 89a and WebP.
    """
    path = Path(path)
    check_animation("path", path)
    if not frames:
        raise ValueError(complaint("frames", "at least one file", "none"))
    height, width, depth = read_png(frames[0]).shape
    check_animation("path", path, width, height, transparent=depth == 4)
    if path.suffix.lower() == ".webp":
        write_atomically(path, lambda file: _write_webp(file, frames, fps))
        return path
    write = _write_gif if path.suffix.lower() == ".gif" else _write_apng
    write_atomically(path, lambda file: write(file, frames, fps))
    return path


def check_animation(
    name: str, path: Path, width: int = 1, height: int = 1, transparent: bool = False
) -> None:
    """Refuse what a format cannot hold, before anything is drawn for it.

    Parameters
    ----------
    name
        What the refusal calls the file.
    path
        Its name.
    width, height
        Size of the frames, pixels.
    transparent
        Whether they have an alpha.

    Raises
    ------
    ValueError
        The name's end is of no such format; the format holds no such frames.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        expected = "a name ending in " + ", ".join(SUFFIXES)
        raise ValueError(complaint(name, expected, repr(path.name)))
    longest = {".gif": GIF_LONGEST, ".webp": WEBP_LONGEST}.get(suffix)
    if longest is not None and max(width, height) > longest:
        expected = f"sides of at most {longest} pixels in {suffix}"
        got = f"{width} x {height}"
        raise ValueError(complaint(name, expected, got, "choose .png"))
    if transparent and suffix == ".gif":
        expected = "an opaque background in .gif, which knows no partial cover"
        raise ValueError(
            complaint(name, expected, "transparent", "choose .png or .webp")
        )


def _write_apng(file: BinaryIO, frames: Sequence[Path], fps: float) -> None:
    """Copy the frames' own chunks: IDAT of the first, the others numbered as fdAT."""
    header, number = b"", 0
    rate = Fraction(fps).limit_denominator(FINEST_RATE)
    delay = (rate.denominator, rate.numerator)
    file.write(SIGNATURE)
    for index, path in enumerate(frames):
        parts = list(chunks(path, path.read_bytes()))
        if index == 0:
            header = parts[0][1]
            _chunk(file, b"IHDR", header)
            _chunk(file, b"acTL", struct.pack(">II", len(frames), FOREVER))
        _refuse_unlike(path, parts[0][1], header)
        size = header[:8]
        control = size + struct.pack(">IIHHBB", 0, 0, *delay, *SHOW_WHOLE)
        _chunk(file, b"fcTL", struct.pack(">I", number) + control)
        number += 1
        for name, data in parts:
            if name != b"IDAT":
                continue
            if index == 0:
                _chunk(file, b"IDAT", data)
            else:
                _chunk(file, b"fdAT", struct.pack(">I", number) + data)
                number += 1
    _chunk(file, b"IEND", b"")


def _chunk(file: BinaryIO, name: bytes, data: bytes) -> None:
    file.write(struct.pack(">I", len(data)) + name + data)
    file.write(struct.pack(">I", zlib.crc32(name + data)))


def _write_gif(file: BinaryIO, frames: Sequence[Path], fps: float) -> None:
    """Give each frame its own 256 colours; Pillow finds them and packs the pixels."""
    ends = [round(100.0 * (index + 1) / fps) for index in range(len(frames))]
    shape, shown = None, 0
    for path, end in zip(frames, ends, strict=True):
        codes = read_png(path)
        if shape is None:
            shape = codes.shape
            file.write(b"GIF89a" + struct.pack("<HHBBB", shape[1], shape[0], 0, 0, 0))
            loop = struct.pack("<BBHB", 3, 1, FOREVER, 0)
            file.write(b"!\xff\x0bNETSCAPE2.0" + loop)
        _refuse_unlike(path, codes.shape, shape)
        image = Image.fromarray(np.ascontiguousarray(codes)).quantize(COLOURS)
        hundredths = min(max(end - shown, 1), GIF_LONGEST)
        shown += hundredths
        for block in GifImagePlugin.getdata(
            image, duration=10 * hundredths, include_color_table=True
        ):
            file.write(block)
    file.write(b";")


def _write_webp(file: BinaryIO, frames: Sequence[Path], fps: float) -> None:
    ends = [round(1000.0 * (index + 1) / fps) for index in range(len(frames))]
    times = [max(b - a, 1) for a, b in zip([0, *ends], ends, strict=False)]
    _Frames(frames).save(
        file,
        format="WEBP",
        save_all=True,
        duration=times,
        loop=FOREVER,
        quality=WEBP_QUALITY,
    )


class _Frames(Image.Image):
    """An image of many frames whose pixels are read when the encoder seeks them."""

    def __init__(self, paths: Sequence[Path]) -> None:
        super().__init__()
        self.paths, self.at = paths, 0
        self.n_frames = len(paths)
        self.shape = read_png(paths[0]).shape
        self.seek(0)

    def seek(self, frame: int) -> None:
        """Read a frame in place of the one before."""
        codes = read_png(self.paths[frame])
        _refuse_unlike(self.paths[frame], codes.shape, self.shape)
        image = Image.fromarray(np.ascontiguousarray(codes))
        self.im, self._mode, self._size = image.im, image.mode, image.size
        self.at = frame

    def tell(self) -> int:
        """Say which frame is there."""
        return self.at


def _refuse_unlike(path: Path, one: Any, first: Any) -> None:
    if one != first:
        expected = "a frame of the size and kind of the first"
        raise ValueError(complaint(f"{path}", expected, "another"))
