"""The splat benchmark: its scene is the evidence's, its contenders what they say."""

from __future__ import annotations

import numpy as np
import pytest

from refcloud.bench import splat, splat_scene
from refcloud.bench.splat import SPLAT
from refcloud.bench.subject import run, table
from refcloud.camera import project
from refcloud.metaballs import axis_depth


@pytest.mark.parametrize("count", [100, 1200, 10_000])
def test_footprints_and_depths_are_the_scenes(count: int) -> None:
    balls = splat_scene.balls(count)
    _, _, depth, scale = project(splat_scene.eye(), balls.centers)
    assert depth.min() > 0.0
    radius = balls.radii * scale
    assert np.median(radius) == pytest.approx(splat_scene.FOOTPRINTS[count], rel=0.02)
    tau = axis_depth(1.0, balls.densities, balls.radii, balls.kernel)
    assert 0.5 <= tau.min() < 0.6 < 1.4 < tau.max() <= 1.5


def test_no_list_is_timed_twice_be_it_quick_or_not() -> None:
    for quick in (False, True):
        listed = [(make, small if quick else full) for make, full, small in SPLAT.lists]
        assert len(set(listed)) == len(listed)


@pytest.mark.slow
def test_every_contender_stays_within_its_error() -> None:
    rows = run(SPLAT, quick=True)
    assert len({(row.task, row.name) for row in rows}) == len(rows)
    named = [row.name for row in rows if "tolerance=" in row.name]
    assert {float(name.split("=")[1]) for name in named} == set(splat.TOLERANCES)
    for row in rows:
        if "tolerance=" in row.name:
            assert row.error is not None
            assert row.rms is not None
            assert row.rms <= row.error <= float(row.name.split("=")[1])
        if "float64, exact" in row.name:
            assert row.error is not None
            assert row.error <= 1e-12
    assert any(row.task.endswith("cumulus") for row in rows)
    assert "rms" in table(SPLAT, rows)
