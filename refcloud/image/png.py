"""Codes in PNG files: 8 bits a channel, RGB or RGBA.

Files are read with suspicion: sizes come from the header before memory is taken, and
the checksum of every chunk is compared, since decoders pass over some damage.
"""

from __future__ import annotations

import io
import os
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import numpy as np
from PIL import Image

from refcloud.checking import checked, complaint
from refcloud.conventions import MOST_PIXELS
from refcloud.files import write_atomically
from refcloud.image.encode import Codes

SIGNATURE = b"\x89PNG\r\n\x1a\n"
MOST_BYTES = 5 * MOST_PIXELS  # RGBA that does not compress, and some
GREY, INDEXED, GREY_ALPHA, RGB_ALPHA = 0, 3, 4, 6  # colour types of the header


@checked
def write_png(path: str | Path, codes: np.ndarray) -> Path:
    """Write codes as a PNG file; the file is whole or absent.

    Formula: one RGB or RGBA pixel of 8-bit codes for each pixel

    Parameters
    ----------
    path
        Name of the file; an old one is replaced.
    codes
        Codes, shape (H, W, 3) or (H, W, 4), uint8.

    Returns
    -------
    The path.

    Raises
    ------
    TypeError, ValueError
        Codes of another type or shape.

    Source: the PNG specification.
    """
    _check_codes("codes", codes)
    write_atomically(path, lambda file: encode_png(codes, file))
    return Path(path)


def encode_png(codes: Codes, file: BinaryIO) -> None:
    """Write codes into an open file, unchecked.

    Parameters
    ----------
    codes
        Shape (H, W, 3) or (H, W, 4), uint8.
    file
        Where the bytes go.
    """
    Image.fromarray(np.ascontiguousarray(codes)).save(file, format="PNG")


@checked
def read_png(path: str | Path) -> Codes:
    """Read the codes of a PNG file with at most 8 bits a channel.

    Formula: grey and indexed files become RGB, transparent ones RGBA

    Parameters
    ----------
    path
        Name of the file.

    Returns
    -------
    Codes, shape (H, W, 3) or (H, W, 4), uint8.

    Raises
    ------
    FileNotFoundError
        No such file.
    ValueError
        Not a PNG, a damaged one, one of 16 bits, or one above 8.3 million pixels.

    Source: the PNG specification.
    """
    try:
        if os.path.exists(path) and not os.path.isfile(path):
            raise ValueError(complaint(f"{path}", "a readable file", "no plain file"))
        if os.path.getsize(path) > MOST_BYTES:
            raise ValueError(
                f"{path}: expected at most {MOST_BYTES} bytes, got a larger file"
            )
        data = Path(path).read_bytes()
    except FileNotFoundError:
        raise FileNotFoundError(
            f"{path}: expected a picture, got no such file"
        ) from None
    except OSError as error:
        raise ValueError(
            f"{path}: expected a readable file, got: {error.strerror}"
        ) from None
    transparent = _check_png(path, data)
    try:
        with Image.open(io.BytesIO(data), formats=["PNG"]) as image:
            return np.asarray(image.convert("RGBA" if transparent else "RGB"))
    except Exception as error:  # the decoder names damage by many types
        raise ValueError(_damaged(path, f"{error}")) from None


def _check_png(path: str | Path, data: bytes) -> bool:
    """Refuse what is not a whole PNG of 8 bits; tell whether it has an alpha."""
    if not data.startswith(SIGNATURE):
        raise ValueError(f"{path}: expected a PNG file, got another kind")
    found = list(chunks(path, data))
    if found[0][0] != b"IHDR" or len(found[0][1]) != 13:
        raise ValueError(_damaged(path, "no header"))
    if sum(name == b"IHDR" for name, _ in found) > 1:
        raise ValueError(_damaged(path, "two headers"))
    if found[-1][0] != b"IEND":
        raise ValueError(_damaged(path, "cut short"))
    width, height, depth, kind = struct.unpack(">IIBB", found[0][1][:10])
    check_size(path, width, height)
    if depth > 8:
        expected, advice = "at most 8 bits a channel", "save it again with 8 bits"
        raise ValueError(complaint(f"{path}", expected, f"{depth}", advice))
    return kind in (GREY_ALPHA, RGB_ALPHA) or any(n == b"tRNS" for n, _ in found)


def chunks(path: str | Path, data: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Walk the chunks (name, content) and compare each checksum.

    Parameters
    ----------
    path
        What a refusal calls the file.
    data
        All of its bytes.

    Returns
    -------
    Name and content of each chunk, up to the last.

    Raises
    ------
    ValueError
        The file is cut short, or a checksum does not fit.
    """
    at = len(SIGNATURE)
    while at < len(data):
        if at + 12 > len(data):
            raise ValueError(_damaged(path, "cut short"))
        (length,) = struct.unpack_from(">I", data, at)
        end = at + 8 + length
        if end + 4 > len(data):
            raise ValueError(_damaged(path, "cut short"))
        if zlib.crc32(data[at + 4 : end]) != struct.unpack_from(">I", data, end)[0]:
            raise ValueError(_damaged(path, "a checksum does not fit"))
        name = data[at + 4 : at + 8]
        yield name, data[at + 8 : end]
        at = end + 4
        if name == b"IEND":
            return
    if at == len(SIGNATURE):
        raise ValueError(_damaged(path, "cut short"))


def check_size(path: str | Path, width: int, height: int) -> None:
    """Refuse a picture without pixels or with too many of them.

    Parameters
    ----------
    path
        What the refusal calls it.
    width, height
        Size in pixels.

    Raises
    ------
    ValueError
        No pixels, or more than 8.3 million.
    """
    if not 1 <= width * height <= MOST_PIXELS:
        raise ValueError(
            f"{path}: expected 1 to {MOST_PIXELS} pixels, got {width} x {height}"
        )


def _check_codes(name: str, codes: np.ndarray) -> None:
    expected = "codes of uint8, shape (H, W, 3) or (H, W, 4)"
    if codes.dtype != np.uint8:
        raise TypeError(complaint(name, expected, f"{codes.dtype}"))
    if codes.ndim != 3 or codes.shape[2] not in (3, 4) or codes.size == 0:
        raise ValueError(complaint(name, expected, f"shape {codes.shape}"))


def _damaged(path: str | Path, how: str) -> str:
    return f"{path}: expected a whole PNG file, got a damaged one ({how})"
