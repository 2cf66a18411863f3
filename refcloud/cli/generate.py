"""``refcloud generate``: noise to a cloud map, paper M's first program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from refcloud.cli.docstrings import summary
from refcloud.cli.options import options_of
from refcloud.cli.outputs import OVER, ready, report
from refcloud.cli.parser import Command
from refcloud.cli.progress import Stages
from refcloud.cloudmap import VoxelGrid, generate, save_voxels
from refcloud.refusal import complaint, counted

ABOUT = summary(generate)
OPTIONS = options_of(generate)
DEFAULTS = {option.name: option.default for option in OPTIONS}
SUFFIXES = (".npz",)
# Options that only one shape has a use for.
ONLY = {
    **dict.fromkeys(("threshold", "dynamics", "ellipsoids"), "ellipsoid"),
    **dict.fromkeys(("relief", "edge"), "cumulus"),
}


def command() -> Command:
    """Give the command's options."""
    made = Command(
        "generate",
        ABOUT,
        output="name of the cloud map (.npz); by default SHAPE-seedSEED-voxels.npz"
        + OVER,
    )
    made.group("the cloud", "", OPTIONS)
    return made


def run(words: Sequence[str]) -> int:
    """Generate a cloud map and write its file."""
    given = command().parse(words)
    chosen = given.of(OPTIONS)
    told = {**DEFAULTS, **chosen}
    _refuse_idle(told["shape"], chosen)
    name = f"{told['shape']}-seed{told['seed']}-voxels.npz"
    path = ready(given.named(name), SUFFIXES)
    stages = Stages()
    with stages.stage("generate"):
        grid = generate(**chosen)
    with stages.stage("save"):
        save_voxels(grid, path)
    notes = [describe(grid)]
    if not occupied(grid):
        notes.append("the cloud is empty: no voxel is occupied")
    report(notes, grid.skipped, stages.line(), path)
    return 0


def _refuse_idle(shape: str, chosen: Mapping[str, Any]) -> None:
    """Refuse what the chosen shape has no use for."""
    for name in chosen:
        only = ONLY.get(name, shape)
        if only != shape:
            flag, expected = f"--{name}", f"none beside --shape {shape}"
            raise ValueError(complaint(flag, expected, "one", f"--shape {only} has it"))


def describe(grid: VoxelGrid) -> str:
    """Say how many voxels are occupied, of how many."""
    cells = " x ".join(str(n) for n in grid.density.shape[::-1])
    return f"{counted(occupied(grid), 'occupied voxel')} in a grid of {cells}"


def occupied(grid: VoxelGrid) -> int:
    """Count the voxels that hold cloud."""
    return int(np.count_nonzero(grid.density))
