"""One way to run a command in this process, and small files to run it on."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

import refcloud as rc
from refcloud.cli import main
from refcloud.files import write_arrays


class Ended(NamedTuple):
    """How a command ended."""

    status: int
    out: str
    err: str


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Callable[..., Ended]:
    def run(*words: object) -> Ended:
        status = main([str(word) for word in words])
        return Ended(status, *capsys.readouterr())

    return run


BALLS = {
    "centers": np.array([[0.0, 0.0, 0.0], [1.5, 0.5, 0.0]]),
    "radii": np.array([2.0, 1.0]),
    "densities": np.array([1.0, 0.5]),
    "kernel": "wyvill",
}


def balls_file(path: Path, version: int = 1, **changes: object) -> None:
    write_arrays(path, "refcloud.metaballs", version, {**BALLS, **changes})


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Stand in a folder with good files and with one of each kind of bad file."""
    monkeypatch.chdir(tmp_path)
    density = np.ones((2, 3, 4))
    rc.save_voxels(rc.VoxelGrid(density, [0, 0, 0], [4, 3, 2]), "voxels.npz")
    balls_file(Path("balls.npz"))
    balls_file(Path("future.npz"), version=2)
    balls_file(Path("shape.npz"), radii=np.ones((2, 2)))
    balls_file(Path("uneven.npz"), radii=np.ones(3))
    balls_file(Path("negative.npz"), radii=np.array([2.0, -1.0]))
    balls_file(Path("nan.npz"), centers=np.full((2, 3), np.nan))
    balls_file(Path("kernel.npz"), kernel="cone")
    grid = {"lower": np.zeros(3), "upper": np.ones(3)}
    write_arrays("flat.npz", "refcloud.voxels", 1, {"density": np.ones((2, 3)), **grid})
    write_arrays("other.npz", "demo", 1, {"x": np.zeros(3)})
    np.savez("formless.npz", density=np.ones((2, 3, 4)), **grid, version=1)
    form = {"format": "refcloud.voxels", "density": np.ones((2, 3, 4))}
    np.savez("versionless.npz", **form, **grid)
    whole = Path("voxels.npz").read_bytes()
    Path("truncated.npz").write_bytes(whole[:-50])
    Path("text.npz").write_text("a cloud")
    Path("folder.npz").mkdir()
    grey = np.full((4, 6, 3), 0.5)
    rc.Picture(grey).save("a.png")
    rc.Picture(grey[:3]).save("small.png")
    Path("broken.png").write_bytes(Path("a.png").read_bytes()[:-20])
    return tmp_path


def contents(folder: Path) -> dict[str, bytes]:
    """Give every file of a folder with its bytes."""
    return {p.name: p.read_bytes() for p in sorted(folder.iterdir()) if p.is_file()}
