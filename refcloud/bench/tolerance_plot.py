"""A figure of tolerances: asked against measured, and time against measured error."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from refcloud.bench.plot import DENSITY, MARKS, matplotlib_figures
from refcloud.bench.timing import Row

ASKED = (1e-1, 1e-2, 1.0 / 255.0, 1e-3, 1e-4)
NAME = "refcloud tolerance {:.2g}"
WIDTH, HEIGHT = 640, 360  # pixels of the figure, without the legend below
ACROSS, ROW = 4, 13  # columns of the legend, and pixels of one of its lines
LEAST = 1e-9  # smaller errors are drawn here
COLOURS = 10  # that the figures tell apart
HEADROOM = 2.0  # of the errors' axis, above what is asked for most


def asked_of(row: Row) -> float | None:
    """Give the tolerance that a row asked for, None for an exact one."""
    return next((t for t in ASKED if row.name == NAME.format(t)), None)


def asked_figure(rows: Sequence[Row], path: str | os.PathLike[str]) -> Path:
    """Draw both panels, a line for each scene that a tolerance changes.

    Parameters
    ----------
    rows
        Of scenes at tolerances; exact ones give the times that others are shares of.
    path
        Where the picture goes (.png).

    Returns
    -------
    The path.
    """
    figures = matplotlib_figures()
    exact = {row.task: row.timing.median for row in rows if asked_of(row) is None}
    # Scenes that no tolerance changes have nothing to show, unless there are no others.
    changed = {row.task for row in rows if row.error}
    exact = {task: t for task, t in exact.items() if task in changed} or exact
    below = ROW * (1 - len(exact) // -ACROSS)
    size = WIDTH / DENSITY, (HEIGHT + below) / DENSITY
    figure = figures.Figure(size, dpi=DENSITY)
    left, right = figure.subplots(1, 2, sharey=True)
    for number, task in enumerate(exact):
        own = [(asked_of(r), r) for r in rows if r.task == task]
        points = [
            (asked, max(row.error or 0.0, LEAST), row.timing.median / exact[task])
            for asked, row in own
            if asked is not None
        ]
        asked, error, time = zip(*sorted(points), strict=True)
        style = {"marker": MARKS[number % len(MARKS)], "markersize": 4.0}
        style |= {"color": f"C{number % COLOURS}", "linewidth": 0.8}
        left.plot(asked, error, label=task, **style)
        right.plot(time, error, **style)
    ends = [min(ASKED), max(ASKED)]
    left.plot(ends, ends, color="black", linewidth=1.0)
    left.set(xscale="log", yscale="log", xlabel="tolerance asked")
    left.set_ylabel(f"error measured (at least {LEAST:g})")
    left.set_ylim(0.5 * LEAST, HEADROOM * max(ASKED))
    right.set(xlabel="CPU time, of the exact picture's")
    right.set_xlim(left=0.0)
    for axes in (left, right):
        axes.grid(True, linewidth=0.3)
    figure.legend(fontsize=6, ncols=ACROSS, loc="lower center", frameon=False)
    figure.tight_layout(rect=(0.0, below / (HEIGHT + below), 1.0, 1.0))
    figure.savefig(path, metadata={"Software": None})
    return Path(path)
