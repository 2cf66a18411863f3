"""The table of twins: each array function beside the plain function that defines it.

A row draws arguments, calls both and returns (array result, plain result). The test in
``test_twins.py`` walks every row of every module in this folder, and fails where a
public function of a room has neither a row nor a reason to have none.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

Draw = Callable[[st.SearchStrategy[Any]], Any]


@dataclass(frozen=True)
class Twin:
    array: Callable[..., Any]
    plain: Callable[..., Any]
    both: Callable[[Draw], tuple[Any, Any]]
    tolerance: float  # largest |array - plain|, relative to max(1, largest |plain|)
    why: str  # worst seen and the margin

    @property
    def name(self) -> str:
        return f"{self.array.__module__}.{self.array.__name__}"


ROWS: list[Twin] = []


def twin(
    array: Callable[..., Any], plain: Callable[..., Any], tolerance: float, why: str
) -> Callable[[Callable[[Draw], tuple[Any, Any]]], Callable[..., Any]]:
    """Enter the decorated ``both(draw) -> (actual, expected)`` as a row."""

    def enter(both: Callable[[Draw], tuple[Any, Any]]) -> Callable[..., Any]:
        ROWS.append(Twin(array, plain, both, tolerance, why))
        return both

    return enter
