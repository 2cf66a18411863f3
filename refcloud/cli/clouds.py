"""What can be drawn: named scenes, metaballs' files and cloud maps' files."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated, Any

from refcloud.cli.generate import describe as described_grid
from refcloud.cloudmap import VoxelGrid, load_voxels
from refcloud.cloudmap.file import FORMAT as VOXELS
from refcloud.conventions import Range
from refcloud.declared import load_scene, scene_from
from refcloud.files import read_arrays
from refcloud.metaballs import Levels, Metaballs, load_levels, load_metaballs
from refcloud.metaballs.file import FORMAT as METABALLS
from refcloud.metaballs.levels_file import FORMAT as LEVELS
from refcloud.paths import refuse_path
from refcloud.refusal import complaint, counted, within
from refcloud.scenes import SCENES, Scene

ANY_VERSION = 2**62  # the loader of each kind refuses what it cannot read
NO_NUMBERS = 1
KINDS = "a cloud map, metaballs or levels (.npz, of refcloud generate or approximate)"
LOADERS = {VOXELS: load_voxels, LEVELS: load_levels, METABALLS: load_metaballs}
TOML = ".toml"
PICTURES = (".png", ".npy")


def find(what: str) -> bool:
    """Tell a scene (True) from a cloud's file (False), or refuse what is neither.

    Raises
    ------
    ValueError
        No scene has that name, and it does not look like a file.
    """
    path = Path(what)
    if what in SCENES:
        return True
    refuse_path("WHAT", what)
    if path.suffix == TOML:
        return True
    if path.suffix != ".npz" and not path.is_file():
        expected = "a file (.npz, .toml) or one of the scenes " + ", ".join(
            sorted(SCENES)
        )
        if path.exists():
            raise ValueError(complaint("WHAT", expected, f"{path}, no file"))
        raise ValueError(complaint("WHAT", expected, repr(what[:60])))
    if path.suffix.lower() in PICTURES:  # what is drawn of it would have that name
        raise ValueError(complaint(what, KINDS, "the name of a picture"))
    return False


def scene_of(what: str) -> Scene:
    """Give the scene of a name, or of a file that declares one.

    Raises
    ------
    FileNotFoundError, TypeError, ValueError
        There is no such file, or what it says does not fit.
    """
    if what in SCENES:
        return SCENES[what]
    scene = scene_from(load_scene(what))
    eye, named = scene.motion.eye, partial(_of_file, what)
    return dataclasses.replace(
        scene,
        model=partial(named, scene.model),
        draw=partial(named, scene.draw),
        motion=dataclasses.replace(scene.motion, eye=eye and partial(named, eye)),
    )


def _of_file(path: str, make: Callable[..., Any], *given: Any) -> Any:
    """Let what refuses a file's scene while it is drawn name the file."""
    with within(f"{path}: "):
        return make(*given)


def load(path: str) -> Metaballs | VoxelGrid | Levels:
    """Load what a file holds, by the kind that it says it is.

    Raises
    ------
    FileNotFoundError, ValueError
        There is no such file, it is damaged, or of another kind.
    """
    if not Path(path).exists():
        raise FileNotFoundError(complaint(path, KINDS, "no such file"))
    came = []
    for kind, load_kind in LOADERS.items():
        got = _other_than(kind, path)
        if not got:
            return load_kind(path)
        came.append(got)
    # Of the format that it tells, the file lacks less than of others.
    got = next((each for each in came if not each.startswith("format ")), came[0])
    raise ValueError(complaint(path, KINDS, got))


def denser(
    cloud: Metaballs | VoxelGrid,
    *,
    density: Annotated[float, Range(0.0, 1e9)] = 1.0,
) -> Metaballs | VoxelGrid:
    """Scale a cloud's density.

    Parameters
    ----------
    cloud
        What was loaded.
    density
        Factor on the density of the file's cloud.

    Returns
    -------
    The cloud, itself where the factor is 1.
    """
    if density == 1.0:
        return cloud
    if isinstance(cloud, VoxelGrid):
        return dataclasses.replace(cloud, density=density * cloud.density)
    return dataclasses.replace(cloud, densities=density * cloud.densities)


def _other_than(kind: str, path: str) -> str:
    """Say what a file is that does not say it is of some kind; nothing if it does."""
    try:
        read_arrays(path, kind, ANY_VERSION, {}, NO_NUMBERS)
    except ValueError as refusal:
        return str(refusal).rpartition(", got ")[2]
    return ""


def describe(cloud: Metaballs | VoxelGrid | Levels) -> str:
    """Say how many balls or voxels there are."""
    if isinstance(cloud, Levels):
        return "levels of " + ", ".join(str(len(each)) for each in cloud.levels)
    if isinstance(cloud, VoxelGrid):
        return described_grid(cloud)
    return counted(len(cloud), "ball")
