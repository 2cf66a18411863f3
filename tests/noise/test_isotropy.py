"""No axis is preferred: slopes along all axes are alike, in every noise of a lattice.

Gradient and simplex noise have derivatives of their own: see their tests.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from refcloud import noise
from refcloud.noise import uniform

COUNT = 8_000  # places, each in cells of its own
STEP = 2.0**-10  # of a cell: slopes are differences over it

KINDS: dict[str, Callable[..., Any]] = {
    "value": lambda at: noise.value(at, seed=4, interpolant="quintic"),
    "value without taps": lambda at: noise.value(at, seed=4, smooth=False),
    "worley F1": lambda at: noise.worley(at, seed=4),
    "worley F2": lambda at: noise.worley(at, seed=4, feature="F2"),
    "smooth": lambda at: noise.smooth(at, seed=4),
    "worley and smooth": lambda at: noise.worley_smooth(at, seed=4),
    "the paper's sum": lambda at: noise.octave_sum(at, seed=4, absolute=False),
    "fbm": lambda at: noise.fbm(at, seed=4),
    "turbulence": lambda at: noise.turbulence(at, seed=4),
}


def unlike(work: Callable[..., Any]) -> float:
    """Say by how many standard errors an axis's mean squared slope leaves the mean."""
    at = 4000.0 * uniform(np.arange(COUNT)[:, None], np.arange(3), seed=9)
    here = work(at)
    ahead = np.array([work(at + STEP * unit) for unit in np.eye(3)])
    slopes = ((ahead - here) / STEP).T ** 2
    apart = slopes - slopes.mean(axis=1, keepdims=True)
    error = apart.std(axis=0) / math.sqrt(COUNT)
    return float((np.abs(apart.mean(axis=0)) / error).max())


@pytest.mark.parametrize("kind", KINDS)
def test_no_axis_is_preferred(kind: str) -> None:
    assert unlike(KINDS[kind]) < 6.0


def test_a_noise_stretched_by_a_quarter_is_found_out() -> None:
    assert unlike(lambda at: KINDS["value"](at * [1.0, 1.0, 1.25])) > 6.0
