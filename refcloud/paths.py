"""Names of files that no system takes, refused before anything is done with them."""

from __future__ import annotations

import os
from pathlib import Path

from refcloud.refusal import complaint

LONGEST_NAME = 255  # bytes of a file's or folder's name, on every system in use


def refuse_path(name: str, path: str | os.PathLike[str]) -> None:
    """Refuse a path that is an empty text, holds a zero byte, or a name too long.

    Parameters
    ----------
    name
        What the refusal calls the path.
    path
        What came. An empty text would mean the current folder.

    Raises
    ------
    ValueError
        It names no file.

    Examples
    --------
    >>> refuse_path("path", "")
    Traceback (most recent call last):
    ValueError: path: expected the name of a file or folder, got an empty text
    """
    text = os.fspath(path)
    expected = "the name of a file or folder"
    if not text:
        raise ValueError(complaint(name, expected, "an empty text"))
    if "\0" in text:
        raise ValueError(complaint(name, expected, "a text with a zero byte"))
    for part in Path(text).parts:
        refuse_long(name, part)


def refuse_long(name: str, part: str, room: int = 0) -> None:
    """Refuse one name of a path that is too long to be stored.

    Parameters
    ----------
    name
        What the refusal calls it.
    part
        The name of a file or a folder.
    room
        Bytes that are added to it while the file is written.

    Raises
    ------
    ValueError
        It has too many bytes.
    """
    size = len(part.encode("utf-8", "surrogatepass"))
    if size > LONGEST_NAME - room:
        expected = f"a name of at most {LONGEST_NAME - room} bytes"
        raise ValueError(complaint(name, expected, f"{size}", "choose a shorter one"))


def written_at(name: str, path: str | os.PathLike[str]) -> Path:
    """Follow a link to the file that is to be written; refuse what is no plain file.

    Parameters
    ----------
    name
        What the refusal calls the path.
    path
        Where a file is to be written. A file that is written under another name and
        renamed would take the place of a link, a pipe or a device.

    Returns
    -------
    The path, or what it leads to; that may be a folder, or not be there.

    Raises
    ------
    ValueError
        It is a pipe, a device or a socket.
    """
    path = Path(path)
    target = Path(os.path.realpath(path)) if path.is_symlink() else path
    if target.exists() and not (target.is_file() or target.is_dir()):
        got = f"{path}, a pipe or a device"
        raise ValueError(complaint(name, "the name of a plain file", got))
    return target
