"""The benchmark of fits: every method takes part, and its error is what it says."""

from __future__ import annotations

import numpy as np
import pytest

from refcloud.bench import SUBJECTS, plot, table
from refcloud.bench.approximate import APPROXIMATE, MOST, Fitted, _padded, fits
from refcloud.bench.timing import Row, Timing, timed
from refcloud.cloudmap.voxels import VoxelGrid
from refcloud.image import load_picture
from refcloud.metaballs import Metaballs, approximate, errors_of_fit
from refcloud.metaballs.approximate import METHODS


def test_every_method_takes_part_at_every_count() -> None:
    contenders = fits(0)
    for count in (30, 100):
        names = {c.name for c in contenders if int(c.task.split()[0]) == count}
        assert {f"refcloud {method}" for method in METHODS} <= names
        assert "refcloud direct" in names
    large = {(c.task, c.name) for c in fits(1)}
    assert ("3000 balls", "refcloud full") in large
    assert ("3000 balls", "refcloud orthogonal") not in large
    assert MOST["orthogonal"] == 1000


@pytest.mark.slow
def test_the_errors_in_the_table_are_those_of_the_fits() -> None:
    contenders = [c for c in fits(0) if c.task == "  30 balls"]
    rows = {row.name: row for row in timed(contenders, rounds=1)}
    errors = {name: row.error for name, row in rows.items()}
    assert all(error is not None and 0.0 < error < 1.0 for error in errors.values())
    for method in ("quick", "standard"):
        work = next(c for c in contenders if c.name == f"refcloud {method}").work()
        assert errors[f"refcloud {method}"] == pytest.approx(
            errors_of_fit(work.grid, work.balls[0]).density, rel=1e-12
        )
    assert errors["refcloud full"] < errors["refcloud random"]
    text = table(APPROXIMATE, list(rows.values()))
    assert f"{errors['refcloud full']:.3g}" in text
    if "sklearn KMeans + Ridge" in rows:
        assert rows["sklearn KMeans + Ridge"].ratio == 1.0
        assert errors["refcloud standard"] < errors["sklearn KMeans + Ridge"]


def test_balls_below_0_are_taken_away_and_the_rim_counts() -> None:
    grid = VoxelGrid(np.ones((1, 1, 1)), [0, 0, 0], [1, 1, 1])
    ball, less = (Metaballs([[0.5] * 3], [0.9], [d]) for d in (1.25, 0.5))
    assert float(np.asarray(Fitted(grid, (ball, less)))) == pytest.approx(0.25)
    wide = _padded(grid)
    assert wide.density.shape == (5, 5, 5)
    assert wide.lower.tolist() == [-2.0, -2.0, -2.0]
    balls = approximate(grid, count=1, least_radius=2.0)
    inside, outside = (errors_of_fit(g, balls).density for g in (grid, wide))
    assert outside > inside


@pytest.mark.slow  # the stage that has matplotlib
def test_a_figure_has_a_line_for_each_contender(tmp_path) -> None:
    pytest.importorskip("matplotlib", reason="needs matplotlib (extra: bench)")
    rows = [
        Row(f"{n} balls", name, Timing(t, t, t), None, error)
        for name, error in (("refcloud a", 0.1), ("other", 0.2), ("exact", 0.0))
        for n, t in ((30, 1e6), (100, 5e6))
    ]
    path = plot(APPROXIMATE, rows, tmp_path / "figure.png")
    linear = load_picture(path).linear
    # Two lines of the legend, and one free above them.
    assert linear.shape == (480 + 3 * 13, 640, 3)
    assert len(np.unique(linear.reshape(-1, 3), axis=0)) > 10
    with pytest.raises(ValueError, match="approximate: expected rows with an error"):
        plot(APPROXIMATE, rows[4:], tmp_path / "none.png")


def test_it_is_a_subject() -> None:
    assert SUBJECTS["approximate"] is APPROXIMATE
