"""``refcloud approximate``: a cloud map to metaballs, paper M's second program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from refcloud.cli.docstrings import summary
from refcloud.cli.generate import describe
from refcloud.cli.options import FileOption, options_of
from refcloud.cli.outputs import OVER, ready, report
from refcloud.cli.parser import Command
from refcloud.cli.progress import Stages
from refcloud.cloudmap import VoxelGrid, cell_centres, cell_size, load_voxels
from refcloud.extremes import refuse_far, refuse_small
from refcloud.fit_pictures import FitPictures, fit_pictures
from refcloud.metaballs import (
    FitErrors,
    Metaballs,
    approximate,
    errors_of_fit,
    levels_of_detail,
    save_levels,
    save_metaballs,
)
from refcloud.paths import refuse_path
from refcloud.refusal import complaint, counted, within

ABOUT = summary(approximate)
OPTIONS = options_of(approximate)
DEFAULTS = {option.name: option.default for option in OPTIONS}
IN_A_CHAIN = ("seed", "kernel")  # what levels of detail take of these
# What a method takes beside a count or a tolerance, a seed and a kernel.
_CLUSTERED = ("overlap", "rim", "rim_depth", "rounds", "least_radius")
TAKES: dict[str, tuple[str, ...]] = {
    "quick": _CLUSTERED,
    "standard": (*_CLUSTERED, "refine_steps"),
    "full": (*_CLUSTERED, "refine_steps"),
    "man": ("overlap",),
    "uniform": ("overlap", "least_radius"),
    "random": ("overlap", "least_radius"),
    "orthogonal": ("least_radius",),
    "subtract": ("least_radius",),
}
EVERY = ("count", "tolerance", "method", "seed", "kernel")
SUFFIXES = (".npz",)
PICTURES = (".png", ".npy")
# Density, and density times volume: float64 holds the sums over all voxels and balls.
MOST_MASS = 1e290
VOXELS = "-voxels"  # what `refcloud generate` puts at the end of its names


@dataclass(frozen=True)
class Outputs:
    """What is written beside or in place of one set of balls.

    Attributes
    ----------
    levels
        A chain of 30, 100, 300 and 1000 balls in one file, by method "full", to be
        chosen from by size in the picture.
    """

    levels: bool = False


OUTPUTS = options_of(Outputs)
PICTURE = FileOption(
    "picture",
    "--picture",
    (str,),
    None,
    "Name of a picture (.png or .npy) of three panels: voxels on the left, balls in"
    " the middle, |difference| on the right; none without it.",
)


def command() -> Command:
    """Give the command's argument and options."""
    made = Command(
        "approximate",
        ABOUT,
        output="name of the metaballs' file (.npz); by default IN-COUNTballs.npz with"
        " the number of balls that there are, or IN-levels.npz" + OVER,
    )
    made.argument("IN.npz", "a cloud map, as refcloud generate writes it")
    made.group("the balls", "", OPTIONS)
    made.group("the files", "", (*OUTPUTS, PICTURE))
    return made


def run(words: Sequence[str]) -> int:
    """Approximate a cloud map and write the metaballs' file."""
    given = command().parse(words)
    chosen, levels = given.of(OPTIONS), given.of(OUTPUTS).get("levels", False)
    if levels and not set(chosen) <= set(IN_A_CHAIN):
        other = ", ".join("--" + name for name in chosen if name not in IN_A_CHAIN)
        expected = "no other option of the balls than --seed and --kernel"
        raise ValueError(complaint("--levels", expected, other.replace("_", "-")))
    _refuse_idle(chosen)
    source = Path(given.arguments[0])
    refuse_path("IN.npz", source)
    stem = source.stem.removesuffix(VOXELS)
    name = f"{stem}-levels.npz" if levels else default_name(stem, 0)
    path = ready(given.named(name), SUFFIXES, inputs=[source])
    shown = given.options.get(PICTURE.flag)
    if shown is not None:
        shown = ready(shown, PICTURES, PICTURE.flag, inputs=[source])
    stages = _Stages()
    with stages.stage("load"):
        grid = load_voxels(source)
        refuse_extreme(f"{source}", grid)
    if levels:
        with stages.stage("approximate"):
            chain = levels_of_detail(grid, **chosen, observe=stages.watch)
        sets, rows = chain.levels, chain.finest.skipped
        save = partial(save_levels, chain)
    else:
        with stages.stage("approximate"):
            balls = approximate(grid, **chosen, observe=stages.watch)
        sets, rows = (balls,), balls.skipped
        if given.output is None:
            path = ready(default_name(stem, len(balls)), SUFFIXES, inputs=[source])
        save = partial(save_metaballs, balls)
    notes = list(stages.tried)
    # Measured first: what cannot be measured leaves no file.
    with stages.stage("measure"), within(f"{source}: "):
        drawn = None
        for balls in sets:
            pictures = fit_pictures(grid, balls, voxels=drawn and drawn.voxels)
            notes += _measured(grid, balls, pictures)
            drawn = pictures
    with stages.stage("save"):
        save(path)
        if shown is not None and drawn is not None:
            drawn.side_by_side().save(shown)
            notes.append(f"voxels, balls and difference: {shown}")
    report(notes, rows, stages.line(), path)
    return 0


def _refuse_idle(chosen: Mapping[str, Any]) -> None:
    """Refuse what the chosen method has no use for."""
    method = chosen.get("method", DEFAULTS["method"])
    for name in chosen:
        if name in EVERY or name in TAKES[method]:
            continue
        flag = f"--{name.replace('_', '-')}"
        others = [other for other in TAKES if name in TAKES[other]]
        expected = f"none beside --method {method}"
        advice = "what takes it: --method " + ", ".join(others)
        raise ValueError(complaint(flag, expected, "one", advice))


def refuse_extreme(name: str, grid: VoxelGrid) -> None:
    """Refuse a cloud map whose balls could not be measured and drawn.

    Parameters
    ----------
    name
        The file's.
    grid
        What it holds.

    Raises
    ------
    ValueError
        Its places, its cells or its densities are beyond the ends of scenes.
    """
    refuse_far(name, [grid.lower, grid.upper])
    refuse_small(name, cell_size(grid))
    if not all((np.diff(axis) > 0.0).all() for axis in cell_centres(grid)):
        largest = float(np.abs([grid.lower, grid.upper]).max())
        expected = "a box near enough to the origin for its cells to have places"
        got = (
            f"coordinates up to {largest:.4g} and cells of {cell_size(grid).min():.4g}"
        )
        raise ValueError(complaint(name, expected, got, "move the box"))
    volume = float(np.max(grid.upper - grid.lower)) ** 3
    most = MOST_MASS / max(volume, 1.0)
    densest = float(grid.density.max(initial=0.0))
    if densest > most:
        expected = f"densities of at most {most:.4g} in a box of this size"
        advice = "choose another unit of density"
        raise ValueError(complaint(name, expected, f"{densest:.4g}", advice))


class _Stages(Stages):
    """Stages that keep what a tolerance made the fit try."""

    def __init__(self) -> None:
        super().__init__()
        self.tried: list[str] = []

    def watch(self, name: str, value: Any) -> None:
        super().watch(name, value)
        if name.startswith("tried "):
            self.tried.append(name)


def _measured(grid: VoxelGrid, balls: Metaballs, pictures: FitPictures) -> list[str]:
    """Say how far one set of balls is from the cloud map."""
    return [
        f"{describe(grid)}: {counted(len(balls), 'ball')}",
        *described(errors_of_fit(grid, balls)),
        f"relative RMSE of the rendered picture: {pictures.error:.4f}",
    ]


def default_name(stem: str, count: int) -> str:
    """Name a file by the cloud and the number of its balls."""
    return f"{stem}-{count}balls.npz"


def described(errors: FitErrors) -> list[str]:
    """Say how far the balls are from the cloud map, a line for each measure."""
    along = ", ".join(
        f"{axis} {error:.4f}"
        for axis, error in zip("xyz", errors.projected, strict=True)
    )
    return [
        f"relative RMSE over all voxels: {errors.density:.4f}",
        f"relative RMSE over occupied voxels: {errors.occupied:.4f}",
        f"relative RMSE of the projected optical depth: {along}",
    ]
