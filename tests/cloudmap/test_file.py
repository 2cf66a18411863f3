"""The cloud-map file: bit for bit, and refused in one line where it is damaged."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from twins.cloudmap import grids

from refcloud.cloudmap import VoxelGrid, generate, load_voxels, save_voxels
from refcloud.cloudmap.file import FORMAT, VERSION

GRID = VoxelGrid(np.arange(6.0).reshape(1, 2, 3), [0, 0, 0], [3, 2, 1])
ARRAYS = {
    "density": GRID.density,
    "lower": GRID.lower,
    "upper": GRID.upper,
    "format": FORMAT,
    "version": VERSION,
}


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(grids())
def test_what_is_written_is_read_bit_for_bit(tmp_path: Path, grid) -> None:
    read = load_voxels(save_voxels(grid, tmp_path / "cloud.npz"))
    for name in ("density", "lower", "upper"):
        assert getattr(read, name).tobytes() == getattr(grid, name).tobytes()


def test_a_generated_cloud_survives_the_file(tmp_path: Path) -> None:
    grid = generate("ellipsoid", diameters=[12, 7, 8], cell=4)
    read = load_voxels(save_voxels(grid, str(tmp_path / "cloud.npz")))
    np.testing.assert_array_equal(read.density, grid.density)


def refusal(path: Path) -> str:
    with pytest.raises(ValueError, match=r"cloud\.npz") as caught:
        load_voxels(path)
    text = str(caught.value)
    assert "\n" not in text
    return text


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"format": "refcloud.metaballs"}, "refcloud.voxels"),
        ({"version": VERSION + 1}, "version"),
        ({"density": -GRID.density}, "density"),
        ({"density": np.full((1, 2, 3), np.nan)}, "density"),
        ({"density": np.ones((2, 3))}, "density"),
        ({"density": np.ones((1, 2, 3), dtype=complex)}, "density"),
        ({"lower": np.zeros(2)}, "lower"),
        ({"upper": np.zeros(3)}, "upper"),
        ({"upper": None}, "upper"),
    ],
)
def test_a_wrong_file_is_refused_in_one_line(tmp_path, changes, word: str) -> None:
    path = tmp_path / "cloud.npz"
    arrays = {k: v for k, v in (ARRAYS | changes).items() if v is not None}
    np.savez(path, **arrays)
    assert word in refusal(path)


@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.9, 0.999])
def test_a_truncated_file_is_refused_in_one_line(tmp_path, share: float) -> None:
    path = save_voxels(GRID, tmp_path / "cloud.npz")
    whole = path.read_bytes()
    path.write_bytes(whole[: int(share * len(whole))])
    refusal(path)


def test_a_text_file_is_refused_in_one_line(tmp_path: Path) -> None:
    path = tmp_path / "cloud.npz"
    path.write_text("no cloud\n")
    refusal(path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"nowhere\.npz"):
        load_voxels(tmp_path / "nowhere.npz")


def test_nothing_half_written_is_left(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="missing"):
        save_voxels(GRID, tmp_path / "missing" / "cloud.npz")
    assert list(tmp_path.iterdir()) == []
