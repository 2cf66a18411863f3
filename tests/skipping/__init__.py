"""The table of savings: each row that a report may hold, and how it is proved.

A proof runs a stage twice on a small scene, once as it is and once with the saving
switched off, and gives both results with the rows of the report. The test in
``test_skipping.py`` holds them against the row's bound, and fails where the package
can report a row that has no proof here.
"""

from __future__ import annotations

import contextlib
import importlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pytest

from refcloud.conventions import Skipped


class Found(NamedTuple):
    """Results with a saving and without it, and what the first one reported."""

    skipping: np.ndarray
    whole: np.ndarray
    rows: Sequence[Skipped]


@dataclass(frozen=True)
class Proof:
    """How a row is proved.

    Attributes
    ----------
    stage, what
        Of the row.
    run
        Gives both results.
    rounding
        What the other order of the same sums may change, and why; 0: the same bits.
    together
        Whether the saving works beside others: their bounds count together.
    """

    stage: str
    what: str
    run: Callable[[], Found]
    rounding: float = 0.0
    together: bool = False

    @property
    def row(self) -> tuple[str, str]:
        return self.stage, self.what


PROOFS: list[Proof] = []


def proof(
    stage: str, what: str, *, rounding: float = 0.0, together: bool = False
) -> Callable[[Callable[[], Found]], Callable[[], Found]]:
    """Enter the decorated function as a proof of a row."""

    def enter(run: Callable[[], Found]) -> Callable[[], Found]:
        PROOFS.append(Proof(stage, what, run, rounding, together))
        return run

    return enter


@contextlib.contextmanager
def replaced(module: str, **values: object) -> Iterator[None]:
    """Switch a saving off: inside, names of a module stand for other values."""
    found = importlib.import_module(module)
    with pytest.MonkeyPatch.context() as patch:
        for name, value in values.items():
            patch.setattr(found, name, value)
        yield
