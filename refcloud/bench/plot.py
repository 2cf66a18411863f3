"""A figure of any subject: error against run time, a point for each contender."""

from __future__ import annotations

import importlib
import itertools
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from refcloud.bench.subject import Subject
from refcloud.bench.timing import Row
from refcloud.refusal import complaint, installing

# Pixels of the figure, and dots to an inch: about as wide as a page.
WIDTH, HEIGHT, DENSITY = 640, 480, 100
ROW = 13  # pixels of a line of the legend, which stands below
COLUMNS, MANY = 2, 16  # of the legend; twice as many where it has more entries
LEAST_ERROR = 1e-17  # below it, and at 0, an error is as good as none
MARKS = "osD^v<>pP*X"
COLOURS = 10  # that the figures tell apart


def plot(subject: Subject, rows: Sequence[Row], path: str | os.PathLike[str]) -> Path:
    """Draw each row's error against its time on logarithmic axes, and the best rows.

    Hollow points are exact: they stand below all others. A line joins the rows of a
    task, or where all rows are one task of all, that no other beats in both.

    Parameters
    ----------
    subject
        What was measured.
    rows
        What `run` gave; rows without an error are left out.
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
    if subject.figure is not None:
        return subject.figure(rows, path)
    shown = [row for row in rows if row.error is not None and row.timing.median > 0.0]
    errors = [row.error for row in shown if row.error and row.error > LEAST_ERROR]
    if not errors:
        raise ValueError(f"{subject.name}: expected rows with an error, got none")
    figures = matplotlib_figures()
    none = min(errors) / 10.0  # where exact rows are drawn
    names = list(dict.fromkeys(row.name for row in shown))
    tasks = list(dict.fromkeys(row.task for row in shown))
    entries = len(names) + (0 if subject.one_task else len(tasks))
    columns = COLUMNS if entries <= MANY else 2 * COLUMNS
    below = ROW * (1 - entries // -columns)
    size = WIDTH / DENSITY, (HEIGHT + below) / DENSITY
    figure = figures.Figure(size, dpi=DENSITY)
    axes = figure.add_subplot()

    def place(row: Row) -> tuple[float, float]:
        time = row.timing.median / subject.unit.nanoseconds
        return time, none if (row.error or 0.0) <= LEAST_ERROR else row.error or none

    # 1. The fronts: of each task, or of all rows.
    groups = [shown] if subject.one_task else [of_task(shown, t) for t in tasks]
    for number, group in enumerate(groups):
        best = front([place(row) for row in group])
        colour = "black" if subject.one_task else f"C{number % COLOURS}"
        style = {"color": colour, "linewidth": 4.0, "alpha": 0.25, "zorder": 0}
        label = "no other row is better" if subject.one_task else tasks[number]
        axes.plot(*zip(*best, strict=True), label=label, **style)
    # 2. The points, a mark for each contender.
    for name, mark in zip(names, itertools.cycle(MARKS), strict=False):
        own = sorted((r for r in shown if r.name == name), key=lambda r: r.task)
        if subject.one_task:
            line = "-" if name.startswith("refcloud") else "--"
            places = zip(*map(place, own), strict=True)
            axes.plot(*places, f"{mark}{line}", linewidth=1.0, markersize=4, label=name)
            continue
        for number, row in enumerate(own):
            exact = place(row)[1] == none
            colour = f"C{tasks.index(row.task) % COLOURS}"
            style = {"color": colour, "linestyle": "", "markersize": 4}
            style["markerfacecolor"] = "none" if exact else colour
            label = None if number else name
            axes.plot(*place(row), marker=mark, label=label, **style)
    axes.set(xscale="log", yscale="log", ylabel="error", title=subject.name)
    axes.set_xlabel(f"CPU time, {subject.unit.name}")
    axes.grid(True, which="both", linewidth=0.3)
    figure.legend(fontsize=6, ncols=columns, loc="lower center", frameon=False)
    figure.tight_layout(rect=(0.0, below / (HEIGHT + below), 1.0, 1.0))
    figure.savefig(path, metadata={"Software": None})
    return Path(path)


def matplotlib_figures() -> Any:
    """Import what draws figures, or refuse in one line."""
    try:
        return importlib.import_module("matplotlib.figure")
    except ImportError:
        advice = installing("bench")
        raise ValueError(complaint("--plot", "matplotlib", "none", advice)) from None


def of_task(rows: Sequence[Row], task: str) -> list[Row]:
    """Take the rows of one task."""
    return [row for row in rows if row.task == task]


def front(places: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Keep the places (time, error) that no other beats in both: the Pareto front.

    Parameters
    ----------
    places
        Times and errors.

    Returns
    -------
    The best, by time; errors fall strictly.

    Examples
    --------
    >>> front([(1, 0.5), (2, 0.1), (3, 0.3), (2, 0.2)])
    [(1, 0.5), (2, 0.1)]
    """
    best: list[tuple[float, float]] = []
    for place in sorted(places):
        if not best or place[1] < best[-1][1]:
            best.append(place)
    return best
