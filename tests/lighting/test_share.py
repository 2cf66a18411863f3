"""Sweeps or turns: the choice goes by pixels and gain, and never shows in the light."""

from __future__ import annotations

import numpy as np
import pytest
from small_scenes import BALLS, MEDIUM, PAPER, SUNS

from refcloud.lighting import share, sunward
from refcloud.lighting.share import in_turn_is_sooner


def test_turns_are_sooner_where_balls_are_large_or_sweeps_many() -> None:
    assert not in_turn_is_sooner(150.0, 0.2, 1e-2)  # a sweep or two
    assert in_turn_is_sooner(150.0, 0.86, 1e-4)  # dozens
    assert in_turn_is_sooner(600.0, 0.2, 1e-2)
    assert not in_turn_is_sooner(10.0, 0.86, 0.0)
    assert not in_turn_is_sooner(0.0, 1.0, 0.0)
    # A gain of 1 promises no end: it counts as the most that is counted.
    assert in_turn_is_sooner(200.0, 1.0, 1e-3) == in_turn_is_sooner(200.0, 0.9, 1e-3)


@pytest.mark.parametrize("turns", [True, False])
def test_both_give_the_same_light(monkeypatch, turns: bool) -> None:
    monkeypatch.setattr(share, "in_turn_is_sooner", lambda *args: turns)
    found = sunward(BALLS, SUNS, medium=MEDIUM, look=PAPER)
    monkeypatch.undo()
    usual = sunward(BALLS, SUNS, medium=MEDIUM, look=PAPER)
    scale = np.abs(usual.light).max()
    np.testing.assert_allclose(found.light, usual.light, rtol=0, atol=1e-12 * scale)
