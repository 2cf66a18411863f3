"""The skies benchmark: who takes part, and that what is compared is the same."""

from __future__ import annotations

import numpy as np
import pytest

from refcloud.bench import skies
from refcloud.bench.skies import SKIES
from refcloud.bench.subject import run, table
from refcloud.noise import cloud_sheet, exponential_filter, overlap_octaves, sheet_map


def test_the_loops_are_document_cs_sheet() -> None:
    loops = np.array(skies._looped_sheet(32))
    small = sheet_map(seed=7)
    np.testing.assert_allclose(loops, cloud_sheet(32, seed=7), atol=1e-10)
    total = overlap_octaves(small, 32)
    np.testing.assert_allclose(loops, exponential_filter(total), atol=1e-10)


def test_every_frame_of_an_animation_is_another_moment() -> None:
    times = []

    def draw(model, view):
        times.append(view.time)

    view = skies.view_of(8, kept={})
    for _ in range(3):
        skies._next_frame(draw, None, view)
    assert len(set(times)) == 3


@pytest.mark.slow
def test_every_contender_takes_part() -> None:
    rows = run(SKIES, quick=True)
    assert len({(row.task, row.name) for row in rows}) == len(rows)
    by_name = {(row.task, row.name): row for row in rows}
    for (task, name), row in by_name.items():
        if task.startswith("document C") and "loops" not in name:
            assert row.error is not None
            assert row.error < 1e-10
        if task in ("places on a sphere", "places on a half-sphere"):
            assert row.error is None or row.error < 1e-3, "facets of 64 cells"
    still = {row.name for row in rows if row.task == "frame, the eye still"}
    assert any("texture in the plane" in name for name in still)
    assert any("texture in space" in name for name in still)
    assert "x rival" in table(SKIES, rows)
