"""A probe: one algorithm, two axes of its parameters, and what a cell measures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from refcloud.bench.stability.verdict import Cell, Found, judge

DType = Literal["float64", "float32"]


@dataclass(frozen=True)
class Axis:
    """A parameter and the values that the map gives it, ends and beyond."""

    name: str
    values: tuple[Any, ...]

    def labels(self) -> list[str]:
        """Write each value in a few letters, numbers near 1 by what they lack."""
        return [v if isinstance(v, str) else _label(v) for v in self.values]


def _label(value: float) -> str:
    size = abs(value)
    if 0.9999 <= size < 1.0:
        return f"1-{1.0 - size:.0e}" if value > 0.0 else f"{1.0 - size:.0e}-1"
    return f"{value:g}"


@dataclass(frozen=True)
class Probe:
    """One panel of the map.

    Attributes
    ----------
    name
        Of the algorithm, with its room.
    reference
        What its numbers are held against.
    down, across
        The two axes.
    measure
        Takes a value of each, down first.
    dtype
        In which the function under test computes.
    note
        Why cells are amber, where some are.
    slow
        Whether the map takes more than half a second for it.
    """

    name: str
    reference: str
    down: Axis
    across: Axis
    measure: Callable[[Any, Any], Found]
    dtype: DType = "float64"
    note: str = ""
    slow: bool = False


@dataclass(frozen=True)
class Panel:
    """A probe and its cells, [down][across]."""

    probe: Probe
    cells: tuple[tuple[Cell, ...], ...]

    def count(self, colour: str) -> int:
        """Count the cells of one colour."""
        return sum(cell.colour == colour for row in self.cells for cell in row)

    @property
    def worst(self) -> float | None:
        """The largest error of all cells that have one."""
        errors = [c.error for row in self.cells for c in row if c.error is not None]
        return max(errors, default=None)


def panel(probe: Probe) -> Panel:
    """Judge every cell of a probe.

    Parameters
    ----------
    probe
        What is measured.

    Returns
    -------
    The panel.
    """
    return Panel(
        probe,
        tuple(
            tuple(
                judge(lambda a=a, b=b: probe.measure(a, b), probe.dtype)
                for b in probe.across.values
            )
            for a in probe.down.values
        ),
    )


def panels(probes: Sequence[Probe]) -> list[Panel]:
    """Judge every cell of every probe."""
    return [panel(probe) for probe in probes]
