"""Files of named arrays: written whole or not at all, read without trust."""

from __future__ import annotations

import io
import lzma
import math
import os
import struct
import tokenize
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, BinaryIO

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Range, Shape
from refcloud.paths import refuse_long, written_at

# Kinds of array: numpy's letters for them, in words, and most bytes of one element.
NUMBERS = ("iuf", "integers or floats", 8)
WHOLE = ("iu", "a whole number", 8)
TEXT = ("U", "a short text", 4 * 64)  # names of formats and kernels are shorter
SUFFIX = ".npy"  # what numpy appends to an array's name inside the archive
# Everything that the readers of zip archives and of array headers raise on damage.
MOST_HEADER = 10_000  # characters; those of the files here have about 100
DAMAGE = (
    *(
        zipfile.BadZipFile,
        zlib.error,
        lzma.LZMAError,
        struct.error,
        tokenize.TokenError,
        EOFError,
    ),
    *(OSError, ValueError, KeyError, TypeError, OverflowError, RuntimeError),
    *(SyntaxError, UserWarning),
)


@checked
def write_atomically(
    path: str | os.PathLike[str], write: Callable[[BinaryIO], Any]
) -> None:
    """Write a file under a temporary name beside its own, then rename it.

    Formula: the file holds all that `write` wrote, or what it held before.

    Parameters
    ----------
    path
        Where the file goes. Its folder must exist; a link stays, and what it leads to
        is written.
    write
        Function that is called with the open binary file.

    Raises
    ------
    FileNotFoundError
        The folder does not exist.
    ValueError
        The path is a folder, a pipe or a device.

    Source: project, W04 and W05.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_atomically(Path(folder, "a"), lambda file: file.write(b"cloud"))
    ...     Path(folder, "a").read_bytes()
    b'cloud'
    """
    target = written_at("path", path)
    temporary = target.with_name(f".{target.name}.{os.getpid()}.part")
    refuse_long("path", target.name, len(temporary.name) - len(target.name))
    if not target.parent.is_dir():
        raise FileNotFoundError(
            f"{target}: expected an existing folder, got {target.parent}; create it"
        )
    if target.is_dir():
        raise ValueError(f"{target}: expected a file name, got a folder")
    try:
        with open(temporary, "wb") as file:
            write(file)
        os.replace(temporary, target)
    except BaseException as error:  # an interrupt leaves nothing behind either
        temporary.unlink(missing_ok=True)
        if isinstance(error, OSError) and error.strerror and not error.filename:
            # Such as a full disk's: it does not say of which file.
            raise OSError(error.errno, error.strerror, f"{target}") from None
        raise


@checked
def write_arrays(
    path: str | os.PathLike[str],
    format: str,
    version: Annotated[int, Range(1)],
    arrays: dict[str, Any],
) -> None:
    """Write named arrays and short texts as one ``.npz`` file.

    Formula: members ``format``, ``version`` and one for each name, compressed.

    Parameters
    ----------
    path
        Where the file goes.
    format
        Name of the kind of file, for instance ``refcloud.voxels``.
    version
        Version of that kind, from 1.
    arrays
        Arrays of numbers, or texts, by name.

    Raises
    ------
    FileNotFoundError, ValueError
        As `write_atomically`.

    Source: project, W04 and W05.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_arrays(Path(folder, "a"), "demo", 1, {"x": np.zeros(3)})
    ...     read_arrays(Path(folder, "a"), "demo", 1, {"x": Shape("N")}, 9)
    {'x': array([0., 0., 0.])}
    """
    members: dict[str, Any] = {
        name: np.asarray(array) for name, array in arrays.items()
    }
    members |= {"format": np.array(format), "version": np.array(version)}
    write_atomically(path, lambda file: np.savez_compressed(file, **members))


@checked
def read_arrays(
    path: str | os.PathLike[str],
    format: str,
    version: Annotated[int, Range(1)],
    shapes: dict[str, Shape],
    most: Annotated[int, Range(1)],
) -> dict[str, np.ndarray]:
    """Read named arrays, after their headers have shown that they fit.

    Formula: format, version, kinds and sizes are checked before memory is taken.

    Parameters
    ----------
    path
        The file.
    format
        Name of the kind of file that is expected.
    version
        Newest version that the caller understands.
    shapes
        Shape of each array by name; ``Shape()`` is one short text. A letter stands
        for one size in the whole file.
    most
        Most numbers that one array may hold.

    Returns
    -------
    The arrays by name, read-only, in their stored kind of number; a text is an array
    of shape ().

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ValueError
        The file is damaged, of another kind, from a newer version, or too large.

    Source: project, W04 and W05.

    Examples
    --------
    >>> read_arrays("nothing.npz", "refcloud.voxels", 1, {}, 1)
    Traceback (most recent call last):
    FileNotFoundError: nothing.npz: expected a refcloud.voxels file, got no such file
    """
    file = Path(path)
    if not file.exists():
        raise FileNotFoundError(f"{file}: expected a {format} file, got no such file")
    if not file.is_file():
        kind = "a folder" if file.is_dir() else "a device"
        raise ValueError(f"{file}: expected a {format} file, got {kind}")
    sizes: dict[str, int] = {}
    try:
        with _opened(file, format) as archive:
            _check_kind(archive, format, version)
            return {
                name: _read(
                    archive, name, shape, NUMBERS if shape.axes else TEXT, sizes, most
                )
                for name, shape in shapes.items()
            }
    except _UnfitError as unfit:
        raise ValueError(f"{file}: expected {unfit}") from None


class _UnfitError(Exception):
    """What was expected and what came; the file's name is added where it is caught."""


def _opened(file: Path, format: str) -> zipfile.ZipFile:
    try:
        return zipfile.ZipFile(file)
    except PermissionError:
        raise _UnfitError("a readable file, got no permission") from None
    except DAMAGE:
        raise _UnfitError(f"a {format} file, got one that is no whole .npz") from None


def _check_kind(archive: zipfile.ZipFile, format: str, version: int) -> None:
    """Compare the file's own format and version with those that are expected."""
    told = []
    for name, letters in (("format", TEXT), ("version", WHOLE)):
        if name + SUFFIX not in archive.NameToInfo:
            raise _UnfitError(f"a {format} file, got one that tells no {name}")
        told.append(_read(archive, name, Shape(), letters, {}, 1))
        if str(told[0]) != format:
            raise _UnfitError(f"a {format} file, got format {str(told[0])!r}")
    stored = int(told[1])
    if stored < 1:
        raise _UnfitError(f"a version from 1, got {stored}")
    if stored > version:
        raise _UnfitError(
            f"{format} version {version} or older, got version {stored}; update"
        )


def _read(
    archive: zipfile.ZipFile,
    name: str,
    shape: Shape,
    kind: tuple[str, str, int],
    sizes: dict[str, int],
    most: int,
) -> np.ndarray:
    """Read one member: its header first, its numbers when they fit."""
    if name + SUFFIX not in archive.NameToInfo:
        raise _UnfitError(f"an array {name!r}, got none of that name")
    info = archive.getinfo(name + SUFFIX)
    letters, words, widest = kind
    try:
        with archive.open(info) as member:
            stored, fortran, dtype = _header(member)
            count = math.prod(stored)
            size = count * dtype.itemsize
            if not shape.fits(stored, sizes):
                known = {k: v for k, v in sizes.items() if k in shape.axes}
                where = "".join(f", {k} = {v}" for k, v in known.items())
                raise _UnfitError(f"{name} of shape {shape}{where}, got {stored}")
            if dtype.kind not in letters or dtype.itemsize > widest:
                raise _UnfitError(f"{name} as {words}, got {dtype}")
            if count > most:
                raise _UnfitError(f"{name} of at most {most} numbers, got {count}")
            if size > info.file_size:
                raise _UnfitError(f"{name} with {count} numbers, got fewer")
            data = member.read(size)
            if len(data) != size or member.read(1):  # the end also proves the checksum
                raise _UnfitError(f"{name} with {count} numbers, got another count")
    except DAMAGE:
        raise _UnfitError(f"a readable array {name!r}, got a damaged one") from None
    array = np.frombuffer(data, dtype).reshape(stored, order="F" if fortran else "C")
    return array.astype(dtype.newbyteorder("="), copy=False)


def _header(stream: Any) -> tuple[tuple[int, ...], bool, np.dtype]:
    """Read shape, order and kind of number, and none of the numbers."""
    # The header says how long it is: a long one is refused before it is unpacked.
    start = stream.read(np.lib.format.MAGIC_LEN + 4)
    width = 2 if start[6:7] == b"\x01" else 4
    length = int.from_bytes(start[8 : 8 + width], "little")
    if length > MOST_HEADER:
        raise ValueError("a header that is too long")
    rest = stream.read(length - (4 - width))
    member = io.BytesIO(start + rest)
    version = np.lib.format.read_magic(member)
    if version == (1, 0):
        shape, fortran, dtype = np.lib.format.read_array_header_1_0(member)
    elif version == (2, 0):
        shape, fortran, dtype = np.lib.format.read_array_header_2_0(member)
    else:
        raise ValueError("a header of another version")
    if any(not isinstance(axis, int) or axis < 0 for axis in shape):
        raise ValueError("a size below 0")
    return shape, fortran, dtype
