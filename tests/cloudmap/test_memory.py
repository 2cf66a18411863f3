"""What making a cloud map takes: some bytes a cell, however large its steps are."""

from __future__ import annotations

import sys
import tracemalloc
from collections.abc import Callable

import numpy as np
import pytest

from refcloud.cloudmap import (
    VoxelGrid,
    billows,
    box_cloud,
    generate,
    voxels,
    worley_smooth_texture,
)
from refcloud.cloudmap.voxels import MOST_MADE, steps_of
from refcloud.noise import worley_smooth

GIBIBYTE = 1 << 30
SMALL = 1 << 16  # cells in a step
# Whoever steps through layers, and the name of the step's size there.
STEPPING = {
    "STEP": (voxels.__name__, worley_smooth.__module__),
    "ROOM": (billows.__module__,),
}
# Each makes about n^3 cells.
MAKERS: dict[str, Callable[[int], VoxelGrid]] = {
    "cumulus": lambda n: generate(voxel=56.0 / n),
    "wide edge": lambda n: generate(voxel=200.0 / n, edge=60.0),
    "ellipsoids": lambda n: generate(
        "ellipsoid", voxel=48.0 / n, threshold=0.0, ellipsoids=3
    ),
    "billows": lambda n: billows(voxel=46.0 / n),
    "texture": worley_smooth_texture,
    "box": lambda n: box_cloud([0, 0, 0], [1, 1, 1], voxel=1.0 / n, cell=0.3),
}
every_maker = pytest.mark.parametrize("name", MAKERS)


@pytest.fixture
def laid(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Take small steps, and list the cells of the grids that clouds are cut from."""
    counts: list[int] = []
    for name, modules in STEPPING.items():
        for module in modules:
            monkeypatch.setattr(sys.modules[module], name, SMALL)
    own = sys.modules[generate.__module__]._lattice

    def counted(*bounds):
        axes, first = own(*bounds)
        counts.append(int(np.prod([len(axis) for axis in axes])))
        return axes, first

    for module in (generate.__module__, billows.__module__):
        monkeypatch.setattr(sys.modules[module], "_lattice", counted)
    return counts


def held(make: Callable[[int], VoxelGrid], n: int, laid: list[int]) -> tuple[int, int]:
    """Give the cells of a grid, and the most bytes that were held as it was made."""
    tracemalloc.start()
    laid.clear()
    grid = make(n)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return laid[0] if laid else grid.density.size, peak


@every_maker
def test_the_largest_grid_that_is_made_takes_a_gibibyte(name: str, laid) -> None:
    """The law is taken from small grids: so many bytes for every further cell."""
    few, some = held(MAKERS[name], 45, laid)
    many, most = held(MAKERS[name], 70, laid)
    assert many > 3 * few > 100_000
    # Worst seen 28.4, of a wide edge.
    assert (most - some) / (many - few) * MOST_MADE <= GIBIBYTE


@every_maker
def test_steps_change_no_bit(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = MAKERS[name](40)
    for key, modules in STEPPING.items():
        for module in modules:
            monkeypatch.setattr(sys.modules[module], key, SMALL)
    stepped = MAKERS[name](40)
    np.testing.assert_array_equal(stepped.density, whole.density)
    np.testing.assert_array_equal(stepped.lower, whole.lower)
    assert stepped.skipped == whole.skipped


def test_steps_cover_all_layers_once() -> None:
    for layers, layer in (
        (1, 1),
        (7, voxels.STEP),
        (100, voxels.STEP // 7),
        (3, 10**9),
    ):
        steps = list(steps_of(layers, layer))
        covered = np.concatenate([np.arange(layers)[step] for step in steps])
        np.testing.assert_array_equal(covered, np.arange(layers))
        thick = max(step.stop - step.start for step in steps)
        assert thick == 1 or thick * layer <= voxels.STEP


def test_what_is_watched_is_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[dict] = [{}, {}]
    for step, found in zip((voxels.STEP, SMALL), seen, strict=True):
        monkeypatch.setattr(voxels, "STEP", step)
        generate(seed=3, observe=found.__setitem__)
    for name, value in seen[0].items():
        np.testing.assert_array_equal(seen[1][name], value)
