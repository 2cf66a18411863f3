"""The triangle benchmark: every contender draws the same picture."""

from __future__ import annotations

import numpy as np
import pytest

from refcloud.bench import triangles_scene as scene
from refcloud.bench.subject import run
from refcloud.bench.triangles import TRIANGLES, drawn
from refcloud.bench.triangles_loop import loop_over_triangles, scalar


def test_no_list_is_timed_twice_be_it_quick_or_not() -> None:
    for quick in (False, True):
        listed = [
            (make, small if quick else full) for make, full, small in TRIANGLES.lists
        ]
        assert len(set(listed)) == len(listed)


@pytest.mark.slow
def test_every_contender_draws_the_same() -> None:
    rows = run(TRIANGLES, quick=True)
    assert len({(row.task, row.name) for row in rows}) == len(rows)
    for row in rows:
        assert row.error is not None
        cut = "dome" in row.task and "loop" in row.name  # what is cut is left out
        assert row.error <= (0.2 if cut else 2e-3 if "mipmap" in row.task else 1e-4)
        if "exact" in row.name:
            assert row.error == 0.0


@pytest.mark.slow
def test_loops_differ_at_silhouettes_alone() -> None:
    exact = drawn("sphere", 40, "LINEAR", True, 0.0)
    for loop in (loop_over_triangles, scalar):
        off = np.abs(loop("sphere", 40) - exact)
        assert scene.mean_difference(loop("sphere", 40), exact) <= 1e-4
        assert np.quantile(off, 0.999) <= 1e-9
