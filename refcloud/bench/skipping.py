"""What each named scene leaves out: the report's rows beside each other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from refcloud.bench.timing import machine
from refcloud.choices import SIZES
from refcloud.conventions import Skipped
from refcloud.render import render
from refcloud.scene import SCENES

TOLERANCE = 1.0 / 255.0
SMALL = 64, 48  # pixels, for a look at the table
ABOUT = "what is left out of each scene, at {} x {} pixels and a tolerance of {:.3g}"


@dataclass(frozen=True)
class Saving:
    """A scene's row; None for a scene that needs all of its work."""

    scene: str
    row: Skipped | None


def savings(names: Iterable[str], size: tuple[int, int]) -> Iterator[Saving]:
    """Draw scenes and give their rows as they come.

    Parameters
    ----------
    names
        Of the scenes.
    size
        Width and height, pixels.
    """
    width, height = size
    for name in names:
        picture = render(name, width=width, height=height, tolerance=TOLERANCE)
        rows = picture.skipped or (None,)
        yield from (Saving(name, row) for row in rows)


def named_savings(quick: bool = False) -> tuple[tuple[int, int], list[Saving]]:
    """Draw all named scenes.

    Parameters
    ----------
    quick
        Whether pictures of a few thousand pixels do.

    Returns
    -------
    Their size, and the rows.
    """
    size = SMALL if quick else SIZES["quick"]
    return size, list(savings(sorted(SCENES), size))


def text_of(size: tuple[int, int], found: Iterable[Saving]) -> str:
    """Write a line for each row.

    Parameters
    ----------
    size
        Of the pictures, pixels.
    found
        What was left out.

    Returns
    -------
    Lines of text, without a last line break.
    """
    head = ("scene", "stage", "what", "skipped", "of", "share", "error at most")
    lines: list[tuple[str, ...]] = [head]
    for saving in found:
        row = saving.row
        if row is None:
            lines.append((saving.scene, "-", "nothing", "-", "-", "-", "-"))
            continue
        unit = "" if row.unit == "displayed white" else f" ({row.unit})"
        error = f"{row.bound:.2g}{unit}" if row.bound else "0"
        counts = str(row.skipped), str(row.of), f"{row.skipped / row.of:.1%}"
        lines.append((saving.scene, row.stage, row.what, *counts, error))
    widths = [max(len(line[k]) for line in lines) for k in range(len(head))]
    text = [
        "  ".join(
            cell.ljust(width) if k in (0, 1, 2, 6) else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    ]
    return "\n".join([machine(), ABOUT.format(*size, TOLERANCE), *text])


def rows_of(found: Iterable[Saving]) -> list[dict[str, Any]]:
    """Give the rows for machines; `what` is none for a scene that needs all.

    Parameters
    ----------
    found
        What was left out.
    """
    return [{"scene": s.scene, **(vars(s.row) if s.row else {})} for s in found]
