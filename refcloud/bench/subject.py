"""A subject of ``refcloud bench``: who takes part, and how its table reads."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from refcloud.bench.timing import Contender, Row, machine, timed

ROUNDS, QUICK_ROUNDS = 7, 2


@dataclass(frozen=True)
class Unit:
    """How a time is written: its name, and nanoseconds in one."""

    name: str
    nanoseconds: float


NS = Unit("ns", 1.0)
MS = Unit("ms", 1e6)


@dataclass(frozen=True)
class Subject:
    """What one word behind ``refcloud bench`` measures.

    Attributes
    ----------
    name, title
        The word, and what is compared, in a line.
    about
        One line: what a time is of and what an error is, for the table's head.
    lists
        Contenders that are timed in turn with each other: a list's maker, its size,
        its size when quick.
    peers
        Distributions whose versions the head names.
    unit
        Of the times in the table.
    rate
        Name of the column of samples per unit of time, and how many of them one sample
        a nanosecond is; None for no such column.
    digits
        Significant digits of the errors.
    rms
        Whether a column gives the errors' root mean square beside the largest.
    reference
        What errors count against, and how far that is from the truth.
    one_task
        Whether all rows do the same at different sizes: then the figure joins those of
        a contender, and has one front; otherwise each task has its own.
    summary
        Writes more below the table; None for nothing.
    figure
        Draws a figure of its own; None for that of every subject.
    """

    name: str
    title: str
    about: str
    lists: tuple[tuple[Callable[[int], list[Contender]], int, int], ...]
    peers: tuple[str, ...] = ()
    unit: Unit = MS
    rate: tuple[str, float] | None = None
    digits: int = 1
    rms: bool = False
    reference: str = ""
    one_task: bool = False
    summary: Callable[[Sequence[Row]], str] | None = None
    figure: Callable[[Sequence[Row], str | os.PathLike[str]], Path] | None = None


def run(subject: Subject, quick: bool = False, peers: bool = True) -> list[Row]:
    """Time every contender, the contenders of one list in turn.

    Parameters
    ----------
    subject
        What is measured.
    quick
        Whether small arrays and few rounds do, for a look at the table.
    peers
        Whether other libraries take part, where they are installed.

    Returns
    -------
    One row per contender, sorted by task.
    """
    rows = []
    for make, full, small in subject.lists:
        listed = make(small if quick else full)
        contenders = [c for c in listed if peers or not c.peer]
        rows += timed(contenders, QUICK_ROUNDS if quick else ROUNDS)
    return sorted(rows, key=lambda row: row.task)


def table(subject: Subject, rows: list[Row]) -> str:
    """Write rows as text, under lines that say where and what was measured.

    Parameters
    ----------
    subject
        What was measured.
    rows
        What `run` gave.

    Returns
    -------
    Lines of text, without a last line break.
    """
    unit, rate = subject.unit, subject.rate
    head = ["task", "contender", unit.name, "spread"]
    head += [rate[0]] if rate else []
    last = ["x rival", "error", *(["rms"] if subject.rms else [])]
    lines = [[*head, *last]]
    for row in rows:
        timing = row.timing
        middle, least, most = (
            t / unit.nanoseconds for t in (timing.median, timing.least, timing.most)
        )
        line = [row.task, row.name, f"{middle:.2f}", f"{least:.2f}-{most:.2f}"]
        if rate:
            line.append(f"{rate[1] / timing.median:.1f}" if timing.median > 0 else "-")
        line.append("-" if row.ratio is None else f"{row.ratio:.1f}")
        errors = [row.error, row.rms] if subject.rms else [row.error]
        line += ["-" if e is None else f"{e:.{subject.digits}g}" for e in errors]
        lines.append(line)
    text = columns(lines, 2)
    head_lines = [machine(subject.peers), subject.about]
    if subject.reference:
        head_lines.append(f"reference: {subject.reference}")
    if subject.summary is not None:
        text.append(subject.summary(rows))
    return "\n".join([*head_lines, *text])


def columns(lines: Sequence[Sequence[str]], left: int) -> list[str]:
    """Write cells as lines of text, in columns; the first `left` ones start alike.

    Parameters
    ----------
    lines
        Cells, as many in each line.
    left
        How many columns start at the left; numbers end at the right.

    Returns
    -------
    The lines.
    """
    widths = [max(len(line[k]) for line in lines) for k in range(len(lines[0]))]
    return [
        "  ".join(
            cell.ljust(width) if k < left else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]
