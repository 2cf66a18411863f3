"""From the worst checked rays to worse ones beside them: where a march errs most."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from refcloud.bench.certificates import drawn
from refcloud.conventions import Array
from refcloud.march.certificate import NEAR_MARGIN, Certificate, Found
from refcloud.march.sampling import CHECKED, rays_around, strides
from refcloud.noise import uniform

ROWS = (60, 80)


@dataclass(frozen=True)
class Rays:
    """Rays that see nothing, and count how often they are asked what they see."""

    which: NDArray[np.intp]
    asked: list[int]
    rows: tuple[int, int] = ROWS

    def taken(self, which: NDArray[np.intp]) -> Rays:
        return Rays(which, self.asked)

    def errors(self, found: Found, expected: Found) -> Array:
        return np.abs(found[0] - expected[0]).max(axis=1)

    def of(self, rays: Rays) -> Found:
        self.asked.append(len(rays.which))
        return np.zeros((len(rays.which), 3)), np.ones(len(rays.which))


def worst_found(off: Array, seed: int) -> tuple[float, float, int]:
    """Give the largest error of a sample, that around it, and how many rays it took."""
    every = Rays(np.arange(off.size), [])
    order = np.argsort(uniform(np.arange(off.size), seed=seed))
    sample = np.sort(order[:CHECKED])
    some = every.taken(sample)
    rays: list[Any] = [every, 1.0, sample, some, every, every.of(some)]
    every.asked.clear()
    certificate = Certificate(*rays)
    found = np.repeat(off.reshape(-1, 1), 3, axis=1), np.ones(off.size)
    near = certificate.near_error(cast(Found, found))
    return float(off.ravel()[sample].max()), near, sum(every.asked)


@settings(max_examples=25)
@given(st.floats(9.0, 50.0), st.floats(9.0, 70.0), st.integers(0, 2**40))
def test_the_way_leads_up_a_hill(top: float, left: float, seed: int) -> None:
    """It is halved within eight pixels; rays are checked every four, but for holes."""
    row, column = np.indices(ROWS)
    off = np.exp(-np.hypot(row - top, column - left) / 12.0)
    sampled, near, asked = worst_found(off, seed)
    assert sampled <= near <= off.max() <= NEAR_MARGIN * near
    assert asked <= 8 * 64


def test_strides_halve_the_distance_between_checked_rays() -> None:
    assert strides(CHECKED, CHECKED) == strides(0, CHECKED) == [1, 1]
    assert strides(16 * CHECKED, CHECKED) == [2, 1, 1]
    assert strides(400 * CHECKED, CHECKED) == [10, 5, 3, 2, 1, 1]


@given(st.sets(st.integers(0, 4799), min_size=1, max_size=9), st.integers(1, 90))
def test_rays_around_some_are_their_eight_neighbours(which, stride: int) -> None:
    found = {divmod(int(k), 80) for k in rays_around(np.array([*which]), ROWS, stride)}
    centres = {divmod(k, 80) for k in which}
    steps = [(a, b) for a in (-stride, 0, stride) for b in (-stride, 0, stride)]
    around = {(r + a, c + b) for r, c in centres for a, b in steps} - centres
    assert found == {(r, c) for r, c in around if 0 <= r < 60 and 0 <= c < 80}


def test_scenes_that_a_sample_alone_lets_through() -> None:
    """The largest error was 3 to 6 times that of the sample: an edge of a shadow."""
    for number in (319, 669, 1043):
        off, tolerance, _ = drawn("march", number)
        assert NEAR_MARGIN * off <= tolerance, number
