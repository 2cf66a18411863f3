"""Light as a field: means of the balls' values, whatever the values are."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.lighting import scattered_balls, seeds

from refcloud.lighting import field_value, light_field
from refcloud.lighting.lightfield import MOST_NODES, OWN
from refcloud.metaballs import Metaballs

some = settings(max_examples=25)
counts = st.integers(1, 6)
ROUNDED = 1e-12


def scene(seed: int, count: int, width: int = 2):
    balls = scattered_balls(seed, count)
    share = scattered_balls(seed ^ 1, count)
    values = np.abs(share.centers[:, :width])
    points = np.vstack([balls.centers, 4.0 * share.centers])
    return balls, values, points


@some
@given(seeds, counts)
def test_no_place_is_brighter_or_darker_than_all_balls(seed, count) -> None:
    balls, values, points = scene(seed, count)
    found = field_value(light_field(balls, values), points, own=values[0])
    assert (found >= values.min(axis=0) * (1.0 - ROUNDED)).all()
    assert (found <= values.max(axis=0) * (1.0 + ROUNDED)).all()


@some
@given(seeds, counts)
def test_one_value_everywhere_is_kept(seed, count) -> None:
    balls, values, points = scene(seed, count)
    same = np.broadcast_to([0.3, 7.0], values.shape)
    found = field_value(light_field(balls, same), points, own=[0.3, 7.0])
    np.testing.assert_allclose(
        found, np.broadcast_to(same[0], found.shape), rtol=ROUNDED
    )


@some
@given(seeds, counts, st.floats(0.0, 5.0))
def test_values_add_up(seed, count, factor) -> None:
    balls, values, points = scene(seed, count)
    one, other = values, values[::-1]
    read = [
        field_value(light_field(balls, v), points, own=v[0])
        for v in (one, other, one + factor * other)
    ]
    np.testing.assert_allclose(read[2], read[0] + factor * read[1], rtol=ROUNDED)


@some
@given(seeds, counts)
def test_far_from_all_balls_a_balls_own_value_counts(seed, count) -> None:
    balls, values, _ = scene(seed, count)
    far = np.array([[50.0, 0.0, 0.0], [0.0, -50.0, 9.0]])
    own = np.array([0.25, 4.0])
    found = field_value(light_field(balls, values), far, own=own)
    np.testing.assert_allclose(found, np.broadcast_to(own, found.shape), rtol=ROUNDED)


@some
@given(seeds, counts, st.randoms())
def test_the_order_of_the_input_never_shows(seed, count, chance) -> None:
    balls, values, _ = scene(seed, count)
    order = list(range(count))
    chance.shuffle(order)
    mixed = Metaballs(balls.centers[order], balls.radii[order], balls.densities[order])
    one, two = light_field(balls, values), light_field(mixed, values[order])
    np.testing.assert_array_equal(one.sums, two.sums)


def test_a_ball_alone_shows_its_value_to_its_rim() -> None:
    ball = Metaballs([[0, 0, 0]], [1.0], [1.0])
    field = light_field(ball, [[5.0]])
    found = field_value(field, [[0, 0, 0], [0.9, 0, 0]], own=[0.0])
    assert found[0, 0] > 5.0 * (1.0 - 2.0 * OWN)
    assert found[1, 0] > 4.5


def test_balls_far_apart_share_a_coarse_table() -> None:
    balls = Metaballs([[0, 0, 0], [1e6, 0, 0]], [1e-6, 1.0], [1.0, 1.0])
    field = light_field(balls, [[1.0], [2.0]])
    assert field.sums[..., 0].size <= MOST_NODES
    assert np.isfinite(field_value(field, [[5e5, 0, 0]], own=[1.0])).all()


def test_without_density_there_is_no_field() -> None:
    for balls in (
        Metaballs(np.zeros((0, 3)), [], []),
        Metaballs([[0, 0, 0]], [1.0], [0.0]),
    ):
        field = light_field(balls, np.ones((len(balls), 3)))
        found = field_value(field, [[0, 0, 0]], own=[1.0, 2.0, 3.0])
        np.testing.assert_allclose(found, [[1.0, 2.0, 3.0]], rtol=ROUNDED)


def test_one_place_alone_can_be_read() -> None:
    ball = Metaballs([[0, 0, 0]], [1.0], [1.0])
    assert field_value(light_field(ball, [[5.0]]), [0, 0, 0], own=[5.0]).shape == (1,)
