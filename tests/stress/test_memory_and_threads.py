"""Renders again and again, side by side, and with more threads: the same bits."""

from __future__ import annotations

import gc
import tracemalloc
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from small_marches import BLOB, MEDIUM, SUN
from small_scenes import BALLS
from stress_processes import child

from refcloud.camera import Camera
from refcloud.image import Picture
from refcloud.metaballs import approximate
from refcloud.render import render

pytestmark = pytest.mark.stress

FRONT = Camera([2.2, 1.2, 3.0], [0, 0, 0], width=27, height=20)
MARCHED = {"camera": FRONT, "suns": SUN, "medium": MEDIUM}
SCENES: dict[str, Callable[[], Picture]] = {
    "splats": lambda: render(BALLS, camera=FRONT),
    "splats to a tolerance": lambda: render(BALLS, camera=FRONT, tolerance=0.01),
    "marched": lambda: render(BLOB, **MARCHED),
    "marched to a tolerance": lambda: render(BLOB, **MARCHED, tolerance=0.05),
    "multiple": lambda: render(BLOB, **MARCHED, scattering="multiple", tolerance=0.05),
    "a sky": lambda: render("shader-c", width=27, height=20),
    "a fit": lambda: render(approximate(BLOB, count=9), camera=FRONT),
}
every_scene = pytest.mark.parametrize("name", SCENES)
# What one more picture may leave beside arrays, bytes: Python's caches (of `typing`, of
# code) fill up for a while; worst seen 29 kB a picture, half of that ten later.
MOST_LEFT = 60_000
ROUNDS = 3


def arrays_held() -> int:
    """Count the bytes of all arrays that numpy made since memory is traced."""
    gc.collect()
    ours = tracemalloc.DomainFilter(True, np.lib.tracemalloc_domain)
    traces = tracemalloc.take_snapshot().filter_traces([ours])
    return sum(line.size for line in traces.statistics("lineno"))


@every_scene
def test_memory_stays_flat(name: str) -> None:
    draw = SCENES[name]
    draw()  # tables that are made once
    tracemalloc.start()
    arrays, held = [], []
    for _ in range(ROUNDS):
        draw()
        arrays.append(arrays_held())
        held.append(tracemalloc.get_traced_memory()[0])
    tracemalloc.stop()
    assert max(arrays) == arrays[0]
    assert (held[-1] - held[0]) / (ROUNDS - 1) < MOST_LEFT


@every_scene
def test_threads_draw_the_same_bits(name: str) -> None:
    alone = SCENES[name]()
    with ThreadPoolExecutor(2) as pool:
        together = list(pool.map(lambda _: SCENES[name](), range(2)))
    for picture in together:
        np.testing.assert_array_equal(picture.linear, alone.linear)
        assert picture.skipped == alone.skipped
        assert picture.notes == alone.notes


def test_scenes_of_all_kinds_at_once() -> None:
    """What one scene keeps for the next call is no other's."""
    alone = {name: draw() for name, draw in SCENES.items()}
    names = list(SCENES)
    with ThreadPoolExecutor(4) as pool:
        together = pool.map(lambda name: SCENES[name](), names)
        for name, picture in zip(names, together, strict=True):
            np.testing.assert_array_equal(picture.linear, alone[name].linear)


WRITE = """
import sys
import numpy as np
sys.path.insert(0, {tests!r})
from stress.test_memory_and_threads import SCENES
np.savez({name!r}, **{{name: draw().linear for name, draw in SCENES.items()}})
"""


def test_numbers_of_blas_threads_give_the_same_bits(tmp_path: Path) -> None:
    found = []
    for n in ("1", "2"):
        code = WRITE.format(tests=str(Path(__file__).parents[1]), name=f"{n}.npz")
        child(code, tmp_path, OPENBLAS_NUM_THREADS=n, OMP_NUM_THREADS=n)
        found.append(np.load(tmp_path / f"{n}.npz"))
    for name in SCENES:
        one, two = (pictures[name] for pictures in found)
        np.testing.assert_array_equal(one, two, err_msg=name)
