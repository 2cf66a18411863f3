"""Rays and boxes: hits, misses, rays along faces, the eye inside; never 0 times inf."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refcloud.march import ray_box

UNIT = {"lower": [-1.0, -1.0, -1.0], "upper": [1.0, 1.0, 1.0]}
numbers = st.sampled_from([-1.0, 0.0, 1.0, -0.0, 1e-320, -1e300]) | st.floats(-3.0, 3.0)
triples = st.tuples(numbers, numbers, numbers)


@pytest.mark.parametrize(
    ("origin", "direction", "expected"),
    [
        ((-3, 0, 0), (1, 0, 0), (2, 4)),
        ((-3, 0, 0), (2, 0, 0), (1, 2)),  # t counts lengths of the direction
        ((0, 0, 0), (0, 0, -1), (0, 1)),  # the eye inside
        ((1, 0, 0), (-1, 0, 0), (0, 2)),  # on a face, inward
        ((1, 0, 0), (1, 0, 0), (0, 0)),  # and outward: a point is no part
        ((3, 0, 0), (1, 0, 0), (0, 0)),  # behind the eye
        ((-3, 2, 0), (1, 0, 0), (0, 0)),  # beside, in parallel
        ((-3, 1, 0), (1, 0, 0), (2, 4)),  # in a face's plane
        ((-3, 1, 1), (1, 0, 0), (2, 4)),  # along an edge
        ((-2, -2, 0), (1, 1, 0), (1, 3)),
        ((-3, 0, 0), (1, 1, 0), (0, 0)),
    ],
)
def test_known_rays(origin, direction, expected) -> None:
    t0, t1 = ray_box(origin, [direction], **UNIT)
    assert (float(t0[0]), float(t1[0])) == expected


@given(triples, triples)
def test_every_ray_gives_two_ordered_numbers(origin, direction) -> None:
    if not any(direction):
        direction = (0.0, 0.0, 1.0)
    t0, t1 = (float(t[0]) for t in ray_box(origin, [direction], **UNIT))
    # A direction of 1e-320 may leave the box at infinity, but never at NaN.
    assert 0.0 <= t0 <= t1
    assert t0 == t1 == 0.0 or t0 < t1


@given(st.tuples(*[st.floats(-1, 1)] * 3), st.tuples(*[st.floats(-1, 1)] * 3))
def test_the_middle_of_a_hit_lies_inside(origin, direction) -> None:
    d = np.array([direction])
    if np.abs(d).max() < 0.1:
        d += 1.0
    o = np.array(origin) - 2.0 * d
    t0, t1 = ray_box(o, d, **UNIT)
    if t1[0] > t0[0]:
        middle = o[0] + 0.5 * (t0 + t1) * d[0]
        assert np.abs(middle).max() <= 1.0 + 1e-12


def test_arrays_broadcast() -> None:
    t0, t1 = ray_box(np.zeros(3), np.eye(3)[:, None] * np.ones((3, 4, 1)), **UNIT)
    assert t0.shape == t1.shape == (3, 4)
    assert (t1 == 1.0).all()


def test_a_ray_that_goes_nowhere_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^directions: expected [^\n]* 1 zero of 2$"):
        ray_box([0.0, 0, 0], [[0.0, 0, 0], [1.0, 0, 0]], **UNIT)
