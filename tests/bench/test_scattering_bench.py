"""The scattering benchmark: every contender runs, and errors are what they say."""

from __future__ import annotations

import numpy as np
import pytest

from refcloud.bench import SUBJECTS, table
from refcloud.bench.scattering import apart, lumpy
from refcloud.bench.timing import timed


def test_the_noise_of_the_truth_is_taken_off() -> None:
    true = np.ones(100)
    found = true + 0.05
    assert apart(found, np.append(0.0, true)) == pytest.approx(0.05)
    assert apart(found, np.append(0.03, true)) == pytest.approx(0.04)
    assert apart(true, np.append(0.03, true)) == 0.0


def test_the_benchmarks_cloud_is_soft_and_has_an_empty_border() -> None:
    density = lumpy(24).density
    assert 0.05 < np.count_nonzero(density) / density.size < 0.3
    assert not density[0].any()
    assert density.max() <= 1.0


@pytest.mark.slow
def test_every_contender_runs() -> None:
    subject = SUBJECTS["scattering"]
    for make, _, small in subject.lists:
        rows = timed(make(small), 1)
        errors = {row.name: row.error for row in rows if row.error is not None}
        assert all(np.isfinite(list(errors.values())))
        assert table(subject, rows).count("\n") >= len(rows)
