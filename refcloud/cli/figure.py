"""``refcloud figure``: one figure of a document, or all of them with a page."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from refcloud.animation.animate import Jobs
from refcloud.cli.options import options_of
from refcloud.cli.outputs import OVER, ready, ready_folder, report, say
from refcloud.cli.parser import Command
from refcloud.cli.progress import Stages
from refcloud.figure import figures, find_figure
from refcloud.figure_pages import PAGE, draw_all, draw_figure
from refcloud.refusal import complaint

ABOUT = "Draw a figure of the documents, or all of them with a page that shows them."
SUFFIXES = (".png", ".npy")


@dataclass(frozen=True)
class Setting:
    """Which figures, and how.

    Attributes
    ----------
    list
        Name the figures, and draw none.
    all
        Draw every figure, into a folder with a page index.html.
    quick
        Small and fast, 320 x 240; the setting where none is named.
    final
        Large, 1024 x 768.
    jobs
        How many processes draw when all are drawn; without it as many as there are
        processors.
    """

    list: bool = False
    all: bool = False
    quick: bool = False
    final: bool = False
    jobs: Jobs | None = None


OPTIONS = options_of(Setting)


def command() -> Command:
    """Give the command's argument and options."""
    made = Command(
        "figure",
        ABOUT,
        output="name of the picture (.png, or .npy for linear light), by default"
        " NAME.png; with --all the folder, by default figures" + OVER,
    )
    made.argument("NAME", "which figure (see --list)", optional=True)
    made.group("the figures", "", OPTIONS)
    return made


def run(words: Sequence[str]) -> int:
    """Draw a figure, or all, or name them."""
    given = command().parse(words)
    how = Setting(**given.of(OPTIONS))
    names = given.arguments
    asked = [f"--{flag}" for flag in ("list", "all") if getattr(how, flag)]
    if len(names) + len(asked) != 1:
        got = " ".join([*names, *asked]) or "none"
        expected = "one of: a figure's name, --list, --all"
        raise ValueError(complaint("NAME", expected, got))
    if how.quick and how.final:
        raise ValueError(complaint("--final", "none beside --quick", "both"))
    idle = ("quick", "final", "jobs") if how.list else () if how.all else ("jobs",)
    for name in idle:
        if getattr(how, name):
            expected = "none beside " + ("--list" if how.list else "one figure")
            raise ValueError(complaint(f"--{name}", expected, "one"))
    if how.list and given.output is not None:
        raise ValueError(complaint("--output", "none beside --list", "one"))
    quality = "final" if how.final else "quick"
    if how.list:
        return _list()
    if how.all:
        return _all(Path(given.named("figures")), quality, how.jobs or _processors())
    find_figure(names[0])
    path = ready(given.named(f"{names[0]}.png"), SUFFIXES)
    stages = Stages()
    with stages.stage("draw"):
        made = draw_figure(names[0], quality, path)
    report([made.caption, *made.notes], made.skipped, stages.line(), path)
    return 0


def _list() -> int:
    every = figures()
    width = max(map(len, every))
    for name, figure in every.items():
        number = f", {figure.number}" if figure.number else ""
        say(f"{name:{width}}  {figure.document}{number}: {figure.title}")
    return 0


def _all(folder: Path, quality: str, jobs: int) -> int:
    ready_folder(folder)
    stages, names = Stages(), list(figures())

    def tell(done: int) -> None:
        stages.part(done, len(names))

    with stages.stage("draw"):
        rows = draw_all(names, quality, folder, jobs=jobs, tell=tell)
    for row in rows:
        say(f"{row.seconds:7.2f} s  {row.caption}")
    computed = sum(row.cpu for row in rows)
    say(f"{len(rows)} figures, {computed:.1f} s of computing")
    say(stages.line())
    say(str(folder / PAGE))
    return 0


def _processors() -> int:
    return os.cpu_count() or 1
