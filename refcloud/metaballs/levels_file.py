"""The file of a cloud's levels of detail: all of them one after the other."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Shape
from refcloud.files import read_arrays, write_arrays
from refcloud.metaballs.balls import Metaballs
from refcloud.metaballs.file import MOST_BALLS
from refcloud.metaballs.levels import Levels

FORMAT = "refcloud.levels"
VERSION = 1
SHAPES = {
    "counts": Shape("L"),
    "errors": Shape("L", 4),
    "differences": Shape("L"),
    "centers": Shape("N", 3),
    "radii": Shape("N"),
    "densities": Shape("N"),
    "kernel": Shape(),
}


@checked
def save_levels(levels: Levels, path: str | os.PathLike[str]) -> Path:
    """Save levels of detail as one ``.npz`` file, whole or not at all.

    Formula: arrays ``counts``, ``errors`` and ``differences`` of the levels, and the
    balls of all of them behind one another as in the cloud file

    Parameters
    ----------
    levels
        The cloud. Rows of ``skipped`` are not stored.
    path
        Where the file goes.

    Returns
    -------
    The path.

    Raises
    ------
    FileNotFoundError, ValueError
        The folder does not exist, or the path is a folder.

    Source: project, W05; paper M, A12.

    Examples
    --------
    >>> import tempfile
    >>> balls = Metaballs([[0, 0, 0]], [2], [1])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = save_levels(Levels((balls,), [[0.5] * 4], [0.0]), f"{folder}/a.npz")
    ...     load_levels(path)
    Levels(1 balls)
    """
    arrays = {
        "counts": np.array([len(level) for level in levels.levels]),
        "errors": levels.errors,
        "differences": levels.differences,
        "kernel": levels.finest.kernel,
    }
    for name in ("centers", "radii", "densities"):
        parts = [getattr(level, name) for level in levels.levels]
        arrays[name] = np.concatenate(parts)
    write_arrays(path, FORMAT, VERSION, arrays)
    return Path(path)


@checked
def load_levels(path: str | os.PathLike[str]) -> Levels:
    """Load levels of detail from a file that `save_levels` wrote.

    Formula: the same bits

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    The levels.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ValueError
        The file is damaged, of another kind, or holds numbers that no level may have.

    Source: project, W05; paper M, A12.

    Examples
    --------
    >>> load_levels("nothing.npz")
    Traceback (most recent call last):
    FileNotFoundError: nothing.npz: expected a refcloud.levels file, got no such file
    """
    arrays = read_arrays(path, FORMAT, VERSION, SHAPES, 3 * MOST_BALLS)
    kernel, counts = str(arrays["kernel"]), arrays["counts"]
    total = len(arrays["radii"])
    whole = counts.dtype.kind in "iu" and bool(np.all(counts >= 0))
    if not whole or sum(int(n) for n in counts) != total:
        raise ValueError(f"{path}: counts: expected whole numbers that sum to {total}")
    ends = np.cumsum(counts)[:-1]
    parts = [np.split(arrays[n], ends) for n in ("centers", "radii", "densities")]
    try:
        levels = tuple(
            Metaballs(c, R, v, kernel)  # pyright: ignore[reportArgumentType]
            for c, R, v in zip(*parts, strict=True)
        )
        return Levels(levels, arrays["errors"], arrays["differences"])
    except (TypeError, ValueError) as error:
        raise ValueError(f"{path}: {error}") from None
