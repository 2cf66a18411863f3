"""The noise benchmark: every contender runs, ratios and errors are what they say."""

from __future__ import annotations

import numpy as np
import pytest

from refcloud.bench import SUBJECTS, table
from refcloud.bench.contenders import LISTS
from refcloud.bench.timing import Contender, machine, timed


def busy(steps: int):
    return lambda: np.full(3, float(sum(i % 7 for i in range(steps))))


def test_ratios_are_taken_to_the_rival_and_errors_to_the_reference() -> None:
    rows = timed(
        [
            Contender("sum", "slow", 10, busy(400_000), rival=True),
            Contender("sum", "fast", 10, busy(4_000), lambda: busy(4_000)() + 0.5),
            Contender("other", "alone", 10, busy(4_000)),
        ],
        rounds=3,
    )
    slow, fast, alone = rows
    assert slow.ratio == pytest.approx(1.0)
    assert slow.error is None
    assert fast.error == 0.5
    assert alone.ratio is None
    for row in rows:
        assert 0 <= row.timing.least <= row.timing.median <= row.timing.most


def test_every_contender_gives_its_samples_within_its_error() -> None:
    for make, _, _ in LISTS:
        for contender in make(8):
            assert np.size(contender.work()) == contender.samples, contender.name
    rows = timed([c for make, _, _ in LISTS for c in make(8)], rounds=1)
    for row in rows:
        if row.name.endswith("float64"):
            assert row.error == 0.0
        elif row.name.endswith("float32") and "neighbours" not in row.name:
            assert row.error is None or row.error < 1e-4


def test_the_table_names_machine_and_every_row() -> None:
    rows = timed(LISTS[0][0](4), rounds=1)
    text = table(SUBJECTS["noise"], rows)
    assert text.startswith(machine()[:10])
    assert len(text.splitlines()) == len(rows) + 4
