"""A cloud map at the ends of float64 is refused by its name, and leaves no file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

import refcloud as rc
import refcloud.cli.approximate

from .conftest import contents

DENSITY = np.ones((2, 3, 4))
UPPER = np.array([4.0, 3.0, 2.0])
FAR = "expected places and lengths of at most 1e\\+50 scene units, got 4e\\+90"
SMALL = "expected sizes of at least 1e-50 scene units, got 1e-90"
SAME = "expected a box near enough to the origin for its cells to have places, got "
DENSE = "expected densities of at most .* in a box of this size, got 1e\\+308"
BAD = {
    FAR: {"upper": 1e90 * UPPER},
    SMALL: {"upper": 1e-90 * UPPER},
    SAME: {"lower": np.full(3, 1e17), "upper": np.full(3, 1e17 + 16.0)},
    DENSE: {"density": 1e308 * DENSITY},
}
ENDS = (
    {"density": 1.5e288 * DENSITY},
    {"upper": 1e48 * UPPER, "density": 1e140 * DENSITY},
    {"upper": 2e-50 * UPPER, "density": 1e289 * DENSITY},
    {"upper": 2e-50 * UPPER, "density": 1e-308 * DENSITY},
    {"lower": np.full(3, 1e17), "upper": 1e17 + 100.0 * UPPER},
)


def saved(name: str, changes: Mapping[str, np.ndarray]) -> None:
    whole = {"density": DENSITY, "lower": np.zeros(3), "upper": UPPER, **changes}
    rc.save_voxels(rc.VoxelGrid(**whole), name)


@pytest.mark.parametrize("line", ["--count 5", "--levels", "--count 5 --picture d.png"])
@pytest.mark.parametrize("expected", BAD, ids=["far", "small", "same", "dense"])
def test_it_is_refused_by_name_before_the_work(
    expected: str, line: str, run, here: Path, monkeypatch
) -> None:
    saved("end.npz", BAD[expected])
    before = contents(here)
    for name in ("approximate", "levels_of_detail"):
        monkeypatch.setattr(refcloud.cli.approximate, name, None)
    status, out, err = run("approximate", "end.npz", *line.split())
    assert (status, out) == (2, "")
    assert re.match(f"refcloud: end.npz: {expected}", err), err
    assert contents(here) == before


@pytest.mark.parametrize("line", ["--count 5", "--levels"])
@pytest.mark.parametrize("changes", ENDS, ids=range(len(ENDS)))
def test_what_is_not_refused_is_measured(changes, line, run, here: Path) -> None:
    saved("end.npz", changes)
    ended = run("approximate", "end.npz", *line.split(), "-o", "made.npz")
    assert (ended.status, ended.err) == (0, "")
    assert Path("made.npz").exists()


def test_what_cannot_be_measured_leaves_no_file(run, here, monkeypatch) -> None:
    def fails(*words: object, **options: object) -> None:
        raise ValueError("camera: expected a place")

    monkeypatch.setattr(refcloud.cli.approximate, "fit_pictures", fails)
    before = contents(here)
    for line in ("--count 5", "--levels"):
        ended = run("approximate", "voxels.npz", *line.split(), "--picture", "d.png")
        assert ended.status == 2
        assert ended.err == "refcloud: voxels.npz: camera: expected a place\n"
        assert contents(here) == before
