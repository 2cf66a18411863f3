"""The noise benchmark: run time against error, beside peers where installed."""

from __future__ import annotations

from refcloud.bench.contenders import LISTS, PEERS
from refcloud.bench.timing import Row, machine, timed

ROUNDS, QUICK_ROUNDS = 7, 2


def run(quick: bool = False) -> list[Row]:
    """Time every contender, the contenders of one list in turn.

    Parameters
    ----------
    quick
        Whether small arrays and few rounds do, for a look at the table.

    Returns
    -------
    One row per contender.
    """
    rows = []
    for make, full, small in LISTS:
        contenders = make(small if quick else full)
        rows += timed(contenders, QUICK_ROUNDS if quick else ROUNDS)
    return sorted(rows, key=lambda row: row.task)


def table(rows: list[Row]) -> str:
    """Write rows as text, under a line that says where they were measured.

    Parameters
    ----------
    rows
        What `run` gave.

    Returns
    -------
    Lines of text, without a last line break.
    """
    head = ("task", "contender", "ns", "spread", "Ms/s", "x rival", "error")
    lines: list[tuple[str, ...]] = [head]
    for row in rows:
        timing = row.timing
        rate = f"{1e3 / timing.median:.1f}" if timing.median > 0 else "-"
        lines.append(
            (
                row.task,
                row.name,
                f"{timing.median:.2f}",
                f"{timing.least:.2f}-{timing.most:.2f}",
                rate,
                "-" if row.ratio is None else f"{row.ratio:.1f}",
                "-" if row.error is None else f"{row.error:.1g}",
            )
        )
    widths = [max(len(line[k]) for line in lines) for k in range(len(head))]
    text = [
        "  ".join(
            cell.ljust(width) if k < 2 else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]
    return "\n".join([machine(PEERS), "CPU time per sample, medians", *text])
