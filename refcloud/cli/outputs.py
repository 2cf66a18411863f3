"""Outputs: their names are refused before the work, and results are printed after."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from refcloud.conventions import Skipped
from refcloud.paths import written_at
from refcloud.refusal import complaint

FLAG = "--output"
OVER = "; a file of that name is written over"  # what help says of most outputs
STDOUT = "standard output"  # in the place of a file's name


def ready(
    path: str | Path,
    suffixes: tuple[str, ...],
    flag: str = FLAG,
    *,
    inputs: Iterable[str | Path] = (),
) -> Path:
    """Find out that the file of an option can be written, before any work is done.

    Parameters
    ----------
    path
        The file.
    suffixes
        How its name may end.
    flag
        The option.
    inputs
        What the command reads: it is not written over, by whatever name.

    Raises
    ------
    ValueError
        The name ends otherwise, is a folder's, a pipe's or a device's, its folder is
        missing or closed, or the file is one of the inputs.
    """
    path = Path(path)
    try:
        _check_place(path, suffixes, flag)
        for source in inputs:
            _refuse_input(path, Path(source), flag)
        target = written_at(flag, path)
        _check_parent(target, flag)
        _try(target)
    except OSError as error:
        expected = "a file that can be written"
        got = f"{str(path)[:60]} ({error.strerror})"
        advice = "choose another name or folder"
        raise ValueError(complaint(flag, expected, got, advice)) from None
    return path


def ready_folder(path: Path, flag: str = FLAG) -> None:
    """Find out that a folder can be made or written into, before any work is done.

    Raises
    ------
    ValueError
        It is a file, or its own folder is missing or closed.
    """
    if path.exists() and not path.is_dir():
        raise ValueError(complaint(flag, "a folder", f"the file {path}"))
    _check_parent(path, flag)
    try:
        if path.is_dir():
            _try(path / "a")
        else:
            path.mkdir()
            path.rmdir()
    except OSError as error:
        expected = "a folder that can be written"
        got = f"{str(path)[:60]} ({error.strerror})"
        advice = "choose another name or folder"
        raise ValueError(complaint(flag, expected, got, advice)) from None


def _check_place(path: Path, suffixes: tuple[str, ...], flag: str) -> None:
    if path.is_dir():
        raise ValueError(complaint(flag, "a file's name", f"the folder {path}"))
    if path.suffix.lower() not in suffixes:
        expected = "a name ending in " + " or ".join(suffixes)
        raise ValueError(complaint(flag, expected, repr(path.name)))
    _check_parent(path, flag)


def _check_parent(path: Path, flag: str) -> None:
    if not path.parent.is_dir():
        expected = "a name in an existing folder"
        raise ValueError(complaint(flag, expected, f"{path.parent}", "create it first"))


def _refuse_input(path: Path, source: Path, flag: str) -> None:
    """Refuse to write over what is read; links to one file are the same file."""
    if path.exists() and source.exists() and path.samefile(source):
        expected = "another file than those that are read"
        raise ValueError(complaint(flag, expected, f"{path}", "choose another name"))


def _try(path: Path) -> None:
    """Make an empty file as the writer will: only trying tells on every system."""
    probe = path.with_name(f".{path.name}.{os.getpid()}.part")
    probe.open("xb").close()
    probe.unlink()


def say(line: str) -> None:
    """Print a line of results; signs that the terminal lacks are escaped."""
    with to_stdout():
        print(printable(line, sys.stdout))


@contextmanager
def to_stdout() -> Iterator[None]:
    """Let what cannot be printed name standard output; a closed pipe is no failure."""
    try:
        yield
    except BrokenPipeError:
        raise
    except OSError as error:
        raise OSError(error.errno, error.strerror, STDOUT) from None


def printable(line: str, stream: TextIO) -> str:
    """Escape the signs that a stream cannot show, such as those of odd file names."""
    encoding = stream.encoding or "utf-8"
    return line.encode(encoding, "backslashreplace").decode(encoding)


def report(
    notes: Iterable[str], skipped: Iterable[Skipped], seconds: str, path: Path | None
) -> None:
    """Print what was found, what was skipped, the times, and the file's name."""
    for line in notes:
        say(line)
    for row in skipped:
        say(str(row))
    say(seconds)
    if path is not None:
        say(str(path))
