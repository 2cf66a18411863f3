"""A job: everything that frames depend on, its digest, and the folder of its frames.

The folder holds ``frame-0000.png``, ... and ``job.json`` with the digest. Frames of the
same digest are kept and not drawn again; a frame is there whole or not at all.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import hashlib
import json
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from refcloud.animation.moves import Moves
from refcloud.files import write_atomically
from refcloud.image.animation import check_animation
from refcloud.image.png import read_png
from refcloud.refusal import complaint
from refcloud.scene import Scene, View

FORMAT, VERSION = "refcloud.frames", 1
JOB_FILE = "job.json"
FRAME = re.compile(r"frame-\d{4,}\.png")
PACKAGE = Path(__file__).parents[1]


@dataclass(frozen=True)
class Saving:
    """How light becomes the codes of a frame; as `Picture.codes`."""

    exposure: float
    tone: Any
    dither: bool


@dataclass(frozen=True)
class Job:
    """Everything that the frames of one animation depend on.

    Attributes
    ----------
    scene, view
        What is drawn, and how, at rest.
    moves, closed
        What moves, completed, and whether it ends where it began.
    frames
        How many.
    saving
        How light becomes codes.
    digest
        Of all the above and of refcloud's own sources.
    """

    scene: Scene
    view: View
    moves: Moves
    closed: bool
    frames: int
    saving: Saving
    digest: str = ""


def signed(job: Job) -> Job:
    """Give a job its digest."""
    digest = hashlib.sha256(sources().encode())
    _feed(digest, job)
    return dataclasses.replace(job, digest=digest.hexdigest())


@functools.cache
def sources() -> str:
    """Give the digest of refcloud's own files: other code may draw other frames."""
    digest = hashlib.sha256()
    for path in sorted(PACKAGE.rglob("*.py")):
        digest.update(path.relative_to(PACKAGE).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _feed(digest: Any, value: Any) -> None:
    """Feed a value's kind and content, every bit of its numbers."""
    digest.update(f"<{type(value).__qualname__}>".encode())
    if isinstance(value, np.ndarray):
        digest.update(f"{value.dtype.str}{value.shape}".encode())
        digest.update(np.ascontiguousarray(value).tobytes())
    elif dataclasses.is_dataclass(value) and not isinstance(value, type):
        for field in dataclasses.fields(value):
            digest.update(field.name.encode())
            _feed(digest, getattr(value, field.name))
    elif isinstance(value, dict):
        _feed(digest, list(value.items()))
    elif isinstance(value, (tuple, list)):
        for item in value:
            _feed(digest, item)
    elif isinstance(value, functools.partial):
        _feed(digest, (value.func, value.args, value.keywords))
    elif callable(value):
        digest.update(f"{value.__module__}.{value.__qualname__}".encode())
    elif isinstance(value, float):
        digest.update(value.hex().encode())
    else:
        digest.update(repr(value).encode())
    digest.update(b"</>")


def frame_path(folder: Path, index: int) -> Path:
    """Give the name of a frame's file."""
    return folder / f"frame-{index:04}.png"


def folder_of(path: Path) -> Path:
    """Give the folder of an animation's frames: its own, or one beside its file."""
    if path.is_dir() or not path.suffix:
        return path
    return path.with_name(f"{path.name}.frames")


def held(folder: Path) -> list[Path]:
    """Give the files of a folder that are frames by their names."""
    if not folder.is_dir():
        return []
    return [path for path in folder.iterdir() if FRAME.fullmatch(path.name)]


def places(path: Path, view: View, transparent: bool) -> tuple[Path, bool]:
    """Give the folder of the frames, and whether they become one file.

    Parameters
    ----------
    path
        What was asked for: a file's name, or a folder's, which has no suffix or exists.
    view
        Its size is that of the frames.
    transparent
        Whether they have an alpha.

    Returns
    -------
    The folder, and whether its frames are to be joined.

    Raises
    ------
    ValueError
        The format is unknown or cannot hold the frames, or there is no such place.
    """
    folder = folder_of(path)
    if folder is not path:
        height, width = size_of(view)
        check_animation("path", path, width, height, transparent)
    elif path.exists() and not path.is_dir():
        raise ValueError(complaint("path", "a folder", f"the file {path}"))
    if not folder.parent.is_dir():
        advice = "create it first"
        raise ValueError(
            complaint("path", "a name in an existing folder", f"{path.parent}", advice)
        )
    return folder, folder is not path


def opened(folder: Path, job: Job, name: str, redraw: bool) -> list[int]:
    """Make the folder of a job's frames, or find the frames that it holds already.

    Parameters
    ----------
    folder
        Where the frames go.
    job
        A signed one.
    name
        What a refusal calls the output.
    redraw
        Whether frames of another job may be replaced.

    Returns
    -------
    The numbers of the frames that are there and whole.

    Raises
    ------
    ValueError
        The folder holds frames of another job.
    """
    folder.mkdir(exist_ok=True)
    there = held(folder)
    if _digest_in(folder) == job.digest and not redraw:
        wanted = {frame_path(folder, index): index for index in range(job.frames)}
        return sorted(wanted[p] for p in there if p in wanted and _whole(p, job))
    if not redraw and (there or (folder / JOB_FILE).exists()):
        raise ValueError(
            complaint(
                name,
                f"{folder} to be empty, or to hold frames of the same job",
                "frames that were drawn with other parameters",
                "choose another name, or give redraw to draw them anew",
            )
        )
    for path in there:
        path.unlink()
    content = {
        "format": FORMAT,
        "version": VERSION,
        "scene": job.scene.name,
        "frames": job.frames,
        "digest": job.digest,
    }
    text = json.dumps(content, indent=1) + "\n"
    write_atomically(folder / JOB_FILE, lambda file: file.write(text.encode()))
    return []


def _digest_in(folder: Path) -> str | None:
    """Read the digest of a folder's job; None where there is none to be read."""
    try:
        content = json.loads((folder / JOB_FILE).read_text("utf-8"))
        known = content["format"] == FORMAT and content["version"] == VERSION
        return content["digest"] if known else None
    except (OSError, ValueError, TypeError, KeyError):
        return None


def _whole(path: Path, job: Job) -> bool:
    """Tell whether a frame can be read and has the job's size."""
    try:
        return read_png(path).shape[:2] == size_of(job.view)
    except (OSError, ValueError):
        return False


def size_of(view: View) -> tuple[int, int]:
    """Give height and width of a view's picture, or of its camera, where it has one."""
    seen = view if view.camera is None else view.camera
    return seen.height, seen.width


def cleared(folder: Path, frames: int) -> None:
    """Remove a job's own files, and the folder where nothing else is in it."""
    for index in range(frames):
        frame_path(folder, index).unlink(missing_ok=True)
    (folder / JOB_FILE).unlink(missing_ok=True)
    with contextlib.suppress(OSError):
        folder.rmdir()
