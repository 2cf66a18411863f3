"""A figure of any subject: error against run time, a line for each contender."""

from __future__ import annotations

import importlib
import itertools
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from refcloud.bench.subject import Subject
from refcloud.bench.timing import Row

# Pixels of the figure, and dots to an inch: about as wide as a page.
WIDTH, HEIGHT, DENSITY = 640, 480, 100
LEAST_ERROR = 1e-17  # below it, and at 0, an error is as good as none
MARKS = "osD^v<>pP*X"


def plot(subject: Subject, rows: Sequence[Row], path: str | os.PathLike[str]) -> Path:
    """Draw each row's error against its time on logarithmic axes.

    Parameters
    ----------
    subject
        What was measured.
    rows
        What `run` gave; rows without an error are left out. Those of one contender are
        joined in the order of its tasks.
    path
        Where the picture goes (.png).

    Returns
    -------
    The path.

    Raises
    ------
    ValueError
        matplotlib is not installed, or no row has an error above 0.
    """
    shown = [row for row in rows if row.error is not None and row.error > LEAST_ERROR]
    if not shown:
        raise ValueError(f"{subject.name}: expected rows with an error, got none")
    try:
        figures: Any = importlib.import_module("matplotlib.figure")
    except ImportError:
        raise ValueError(
            "--plot: expected matplotlib, got none; install refcloud[bench]"
        ) from None
    figure = figures.Figure((WIDTH / DENSITY, HEIGHT / DENSITY), dpi=DENSITY)
    axes = figure.add_subplot()
    names = list(dict.fromkeys(row.name for row in shown))
    for name, mark in zip(names, itertools.cycle(MARKS)):
        own = sorted((r for r in shown if r.name == name), key=lambda r: r.task)
        axes.plot(
            [row.timing.median / subject.unit.nanoseconds for row in own],
            [row.error for row in own],
            marker=mark,
            linestyle="-" if name.startswith("refcloud") else "--",
            linewidth=1.0,
            markersize=4.0,
            label=name,
        )
    axes.set(xscale="log", yscale="log", ylabel="error", title=subject.name)
    axes.set_xlabel(f"CPU time, {subject.unit.name}")
    axes.grid(True, which="both", linewidth=0.3)
    axes.legend(fontsize=6, ncols=2)
    figure.tight_layout()
    figure.savefig(path, metadata={"Software": None})
    return Path(path)
