"""``refcloud approximate``: a cloud map to metaballs, paper M's second program."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from refcloud.cli.docstrings import summary
from refcloud.cli.generate import describe
from refcloud.cli.options import options_of
from refcloud.cli.outputs import ready, report
from refcloud.cli.parser import Command
from refcloud.cli.progress import Stages
from refcloud.cloudmap import load_voxels
from refcloud.metaballs import approximate, errors_of_fit, save_metaballs
from refcloud.metaballs.errors import FitErrors

ABOUT = summary(approximate)
OPTIONS = options_of(approximate)
SUFFIXES = (".npz",)
VOXELS = "-voxels"  # what `refcloud generate` puts at the end of its names


def command() -> Command:
    """Give the command's argument and options."""
    made = Command(
        "approximate",
        ABOUT,
        output="name of the metaballs' file (.npz); by default IN-COUNTballs.npz with"
        " the number of balls that there are",
    )
    made.argument("IN.npz", "a cloud map, as refcloud generate writes it")
    made.group("the balls", "", OPTIONS)
    return made


def run(words: Sequence[str]) -> int:
    """Approximate a cloud map and write the metaballs' file."""
    given = command().parse(words)
    source = Path(given.arguments[0])
    stem = source.stem.removesuffix(VOXELS)
    path = ready(given.named(default_name(stem, 0)), SUFFIXES)
    stages = Stages()
    with stages.stage("load"):
        grid = load_voxels(source)
    with stages.stage("approximate"):
        balls = approximate(grid, **given.of(OPTIONS), observe=stages.watch)
    with stages.stage("measure"):
        errors = errors_of_fit(grid, balls)
    if given.output is None:
        path = ready(default_name(stem, len(balls)), SUFFIXES)
    with stages.stage("save"):
        save_metaballs(balls, path)
    notes = [f"{describe(grid)}: {len(balls)} balls", *described(errors)]
    report(notes, balls.skipped, stages.line(), path)
    return 0


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
