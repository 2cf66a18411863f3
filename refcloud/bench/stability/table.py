"""The map of stability as text, and as rows for machines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from refcloud.bench.stability.probe import Panel
from refcloud.bench.timing import machine

COLOURS = ("green", "amber", "red", "refused")


def rows_of(panels: Sequence[Panel]) -> list[dict[str, Any]]:
    """Give one row for each cell.

    Parameters
    ----------
    panels
        Of `refcloud.bench.stability.panels`.

    Returns
    -------
    Dictionaries: algorithm, dtype, the two parameters, colour, error and why.
    """
    return [
        {
            "algorithm": one.probe.name,
            "dtype": one.probe.dtype,
            "down": f"{one.probe.down.name} {a}",
            "across": f"{one.probe.across.name} {b}",
            "colour": cell.colour,
            "error": cell.error,
            "why": cell.why,
        }
        for one in panels
        for a, row in zip(one.probe.down.labels(), one.cells, strict=True)
        for b, cell in zip(one.probe.across.labels(), row, strict=True)
    ]


def text_of(panels: Sequence[Panel]) -> str:
    """Write a line for each algorithm, then every red cell.

    Parameters
    ----------
    panels
        Of `refcloud.bench.stability.panels`.

    Returns
    -------
    Lines of text, without a last line break.
    """
    lines = [machine(), "cells by verdict; worst relative error; what it is held to"]
    width = max(len(one.probe.name) for one in panels)
    lines.append(f"{'algorithm':{width}}  dtype    green amber   red refused    worst")
    for one in panels:
        counts = [one.count(colour) for colour in COLOURS]
        worst = "-" if one.worst is None else f"{one.worst:.1e}"
        lines.append(
            f"{one.probe.name:{width}}  {one.probe.dtype}"
            f"{counts[0]:6}{counts[1]:6}{counts[2]:6}{counts[3]:8}{worst:>9}"
            f"  {one.probe.reference}"
        )
        if counts[1] and one.probe.note:
            lines.append(f"{'':{width}}  amber: {one.probe.note}")
    for row in rows_of(panels):
        if row["colour"] == "red":
            where = f"{row['algorithm']} at {row['down']}, {row['across']}"
            lines.append(f"red: {where}: {row['why']}")
    return "\n".join(lines)
