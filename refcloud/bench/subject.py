"""A subject of ``refcloud bench``: who takes part, and how its table reads."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

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
    name
        The word.
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
    rms
        Whether a column gives the errors' root mean square beside the largest.
    """

    name: str
    about: str
    lists: tuple[tuple[Callable[[int], list[Contender]], int, int], ...]
    peers: tuple[str, ...] = ()
    unit: Unit = MS
    rate: tuple[str, float] | None = None
    rms: bool = False


def run(subject: Subject, quick: bool = False) -> list[Row]:
    """Time every contender, the contenders of one list in turn.

    Parameters
    ----------
    subject
        What is measured.
    quick
        Whether small arrays and few rounds do, for a look at the table.

    Returns
    -------
    One row per contender, sorted by task.
    """
    rows = []
    for make, full, small in subject.lists:
        contenders = make(small if quick else full)
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
        line.append("-" if row.error is None else f"{row.error:.1g}")
        if subject.rms:
            line.append("-" if row.rms is None else f"{row.rms:.1g}")
        lines.append(line)
    widths = [max(len(line[k]) for line in lines) for k in range(len(lines[0]))]
    text = [
        "  ".join(
            cell.ljust(width) if k < 2 else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]
    return "\n".join([machine(subject.peers), subject.about, *text])
