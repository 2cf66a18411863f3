"""The cloud-map file: a generator writes it, an approximator reads it."""

from __future__ import annotations

import os
from pathlib import Path

from refcloud.checking import checked
from refcloud.cloudmap.voxels import MOST_VOXELS, VoxelGrid
from refcloud.conventions import Shape
from refcloud.files import read_arrays, write_arrays

FORMAT = "refcloud.voxels"
VERSION = 1


@checked
def save_voxels(grid: VoxelGrid, path: str | os.PathLike[str]) -> Path:
    """Write a cloud map as ``.npz``, whole or not at all.

    Formula: arrays density, lower, upper, format, version

    Parameters
    ----------
    grid
        The cloud map.
    path
        The file's name.

    Returns
    -------
    The path.

    Source: paper M, section 5 (W04).
    """
    arrays = {"density": grid.density, "lower": grid.lower, "upper": grid.upper}
    write_arrays(path, FORMAT, VERSION, arrays)
    return Path(path)


@checked
def load_voxels(path: str | os.PathLike[str]) -> VoxelGrid:
    """Read a cloud map.

    Formula: the inverse of `save_voxels`, bit for bit

    Parameters
    ----------
    path
        The file's name.

    Returns
    -------
    The cloud map.

    Raises
    ------
    FileNotFoundError
        There is no such file.
    ValueError
        It is not a cloud map, is damaged, too large, or holds values out of range.

    Source: paper M, section 5 (W04).
    """
    shapes = {"density": Shape("D", "H", "W"), "lower": Shape(3), "upper": Shape(3)}
    arrays = read_arrays(path, FORMAT, VERSION, shapes, MOST_VOXELS)
    try:
        return VoxelGrid(arrays["density"], arrays["lower"], arrays["upper"])
    except (TypeError, ValueError) as refusal:
        raise ValueError(f"{os.fspath(path)}: {refusal}") from None
