"""Every scene that says that it repeats itself does; its animation closes."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from refcloud import Moves, animate
from refcloud.image import read_png
from refcloud.scene import View
from refcloud.scenes import SCENES

VIEW = View(32, 24)
# Noise is sampled at places that a whole period has rounded: coordinates up to 100 of
# last bits 1.4e-14, times slopes of a few per cell, exposed.
CLOSE = 1e-9
PERIODIC = [
    name
    for name, scene in SCENES.items()
    if math.isfinite(scene.motion.period or math.inf)
]
REPEATED = [
    (name, axis)
    for name, scene in SCENES.items()
    for axis, length in enumerate(scene.motion.repeats or ())
    if length and math.isfinite(length)
]


def drawn(name: str, **changes: object) -> np.ndarray:
    scene = SCENES[name]
    view = dataclasses.replace(VIEW, **changes)  # pyright: ignore[reportArgumentType]
    return scene.draw(scene.model(), view).linear


def test_there_are_scenes_that_repeat() -> None:
    assert {"simple-sky", "shader-dome", "shader-b"} <= set(PERIODIC)
    assert len(REPEATED) > 5


@pytest.mark.parametrize("name", PERIODIC)
def test_a_period_later_the_scene_is_the_same(name: str) -> None:
    period = SCENES[name].motion.period
    assert period is not None
    start = drawn(name)
    np.testing.assert_allclose(drawn(name, time=period), start, rtol=0.0, atol=CLOSE)


@pytest.mark.parametrize(("name", "axis"), REPEATED)
def test_wind_brings_the_same_again(name: str, axis: int) -> None:
    repeats = SCENES[name].motion.repeats
    assert repeats is not None
    offset = np.zeros(3)
    still = drawn(name, offset=offset.copy())
    offset[axis] = repeats[axis]
    np.testing.assert_allclose(drawn(name, offset=offset), still, rtol=0.0, atol=CLOSE)


@pytest.mark.parametrize("name", ["simple-sky", "shader-dome", "shader-b"])
def test_a_periodic_scene_closes_without_a_jump(name: str, tmp_path: Path) -> None:
    made = animate(
        name, tmp_path / "a", frames=24, width=32, height=24, dither=False, tone="none"
    )
    assert made.closed
    frames = [
        read_png(path).astype(int) for path in sorted((tmp_path / "a").glob("frame-*"))
    ]
    steps = [
        float(np.sqrt(np.square(b - a).mean()))
        for a, b in zip(frames, [*frames[1:], frames[0]], strict=True)
    ]
    assert min(steps) > 0.0
    assert steps[-1] <= 1.5 * max(steps[:-1])


@pytest.mark.parametrize("name", ["man-10", "demand-lit", "shader-c"])
def test_a_turn_of_the_eye_closes(name: str, tmp_path: Path) -> None:
    """Half of a closed turn is the end of half a turn, to the bit."""
    size = {"width": 24, "height": 18}
    turn = Moves(turn_eye=360.0)
    made = animate(name, tmp_path / "a", frames=2, moves=turn, **size)
    assert made.closed
    open_way = animate(
        name, tmp_path / "b", frames=2, moves=Moves(turn_eye=180.0), **size
    )
    assert not open_way.closed
    half = [read_png(tmp_path / folder / "frame-0001.png") for folder in "ab"]
    np.testing.assert_array_equal(*half)
