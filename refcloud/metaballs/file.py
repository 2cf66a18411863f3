"""The cloud file: metaballs as named arrays."""

from __future__ import annotations

import os
from pathlib import Path

from refcloud.checking import checked
from refcloud.conventions import Shape
from refcloud.files import read_arrays, write_arrays
from refcloud.metaballs.balls import Metaballs

FORMAT = "refcloud.metaballs"
VERSION = 1
SHAPES = {
    "centers": Shape("N", 3),
    "radii": Shape("N"),
    "densities": Shape("N"),
    "kernel": Shape(),
}
MOST_BALLS = 1 << 24  # 400 MB of centres: larger files are refused before allocation


@checked
def save_metaballs(balls: Metaballs, path: str | os.PathLike[str]) -> Path:
    """Save metaballs as an ``.npz`` file, whole or not at all.

    Formula: arrays ``centers``, ``radii``, ``densities`` and ``kernel``

    Parameters
    ----------
    balls
        The cloud. Its rows of ``skipped`` are not stored.
    path
        Where the file goes.

    Returns
    -------
    The path.

    Raises
    ------
    FileNotFoundError, ValueError
        The folder does not exist, or the path is a folder.

    Source: project, W05.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = save_metaballs(Metaballs([[0, 0, 0]], [2], [1]), f"{folder}/a.npz")
    ...     load_metaballs(path).radii
    array([2.])
    """
    arrays = {name: getattr(balls, name) for name in SHAPES}
    write_arrays(path, FORMAT, VERSION, arrays)
    return Path(path)


@checked
def load_metaballs(path: str | os.PathLike[str]) -> Metaballs:
    """Load metaballs from a file that `save_metaballs` wrote.

    Formula: the same bits

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    The cloud.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ValueError
        The file is damaged, of another kind, or holds numbers that no ball may have.

    Source: project, W05.

    Examples
    --------
    >>> load_metaballs("nothing.npz")
    Traceback (most recent call last):
    FileNotFoundError: nothing.npz: expected a refcloud.metaballs file, got no such file
    """
    arrays = read_arrays(path, FORMAT, VERSION, SHAPES, 3 * MOST_BALLS)
    kernel = str(arrays.pop("kernel"))
    try:
        return Metaballs(**arrays, kernel=kernel)  # pyright: ignore[reportArgumentType]
    except (TypeError, ValueError) as error:
        raise ValueError(f"{path}: {error}") from None
