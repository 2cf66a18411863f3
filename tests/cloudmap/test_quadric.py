"""Ellipsoids and the density mapped into them (eq 8 to 10)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from twins.cloudmap import axes, places, turns

from refcloud.cloudmap import evaluate_quadric, modulate, quadric
from refcloud.plain.cloudmap import rotation

unit = st.floats(0.0, 1.0)
ways = st.tuples(*[st.floats(-1.0, 1.0)] * 3)
many = st.lists(st.tuples(st.floats(-1.0, 1.5), unit), min_size=1, max_size=9)
# Coefficients of up to 2000 (5^2 / 0.3^2 and cross terms) cancel to 1.
CANCELLED = 1e-11


@given(places, axes, turns, turns, turns, ways)
def test_1_at_the_centre_and_0_on_the_surface(center, radii, turn, tilt, roll, way):
    assume(math.hypot(*way) > 0.1)
    q = quadric(center, radii, turn=turn, tilt=tilt, roll=roll)
    out = np.divide(way, math.hypot(*way))
    rim = center + np.array(rotation(turn, tilt, roll)) @ (radii * out)
    middle = 0.5 * (center + rim)
    found = evaluate_quadric(q, np.array([center, rim, middle, 2.0 * rim - center]))
    assert found == pytest.approx([1.0, 0.0, 0.75, -3.0], abs=CANCELLED)


@given(places, axes, turns, turns, turns, places)
def test_nowhere_is_it_above_1(center, radii, turn, tilt, roll, point) -> None:
    q = quadric(center, radii, turn=turn, tilt=tilt, roll=roll)
    assert evaluate_quadric(q, np.array(point)) <= 1.0 + CANCELLED


@given(places, st.floats(0.3, 4.0), turns, turns, turns)
def test_turning_a_sphere_changes_nothing(center, radius, turn, tilt, roll) -> None:
    turned = quadric(center, [radius] * 3, turn=turn, tilt=tilt, roll=roll)
    np.testing.assert_allclose(turned, quadric(center, [radius] * 3), atol=CANCELLED)


@given(places, axes, turns)
def test_a_whole_turn_is_none(center, radii, turn) -> None:
    away = turn - math.copysign(math.tau, turn)
    once = quadric(center, radii, turn=turn), quadric(center, radii, turn=away)
    np.testing.assert_allclose(*once, atol=1e-10)


@given(many, st.floats(0.0, 1.0, exclude_max=True), st.floats(0.01, 1.0))
def test_density_is_0_or_between_threshold_and_dynamics(pairs, t, d) -> None:
    Q, noise = np.array(pairs).T
    density = modulate(Q, noise, threshold=t, dynamics=d)
    full = density > 0.0
    assert ((Q[full] >= 0.0) & (Q[full] <= 1.0)).all()
    assert (density <= d).all()
    assert (density[full] >= d * t * (1.0 - 1e-15)).all()


@given(many, st.floats(0.0, 0.99), st.integers(0, 8), unit)
def test_a_union_is_no_thinner_than_its_parts(pairs, t, which, more) -> None:
    Q, noise = np.array(pairs).T
    assume((Q <= 1.0).all())
    wider = Q.copy()
    wider[which % len(Q)] = max(wider[which % len(Q)], more)
    apart = modulate(Q, noise, threshold=t)
    assert (modulate(wider, noise, threshold=t) >= apart).all()


def test_e15_without_noise_a_threshold_only_shrinks_the_ellipsoid() -> None:
    t, line = 0.36, np.linspace(-1.2, 1.2, 241)
    points = np.stack([line, 0.0 * line, 0.0 * line], axis=-1)
    Q = evaluate_quadric(quadric([0, 0, 0], [1, 1, 1]), points)
    printed = modulate(Q, np.ones_like(Q), threshold=t)  # D = d Q as eq 10 has it
    inside = np.abs(line) < math.sqrt(1.0 - t) - 1e-9
    assert (printed[inside] > 0.0).all()
    assert (printed[np.abs(line) > math.sqrt(1.0 - t) + 1e-9] == 0.0).all()


def test_e15_noise_opens_empty_spaces_where_the_quadric_is_the_same() -> None:
    noise = [0.0, 0.19, 0.2, 0.9]
    assert modulate([0.5] * 4, noise, threshold=0.1).tolist() == [0, 0, 0.1, 0.45]


@pytest.mark.parametrize(
    ("given_", "name"),
    [
        ({"radii": [1, 0, 1]}, "radii"),
        ({"radii": [1, 1e-200, 1]}, "radii"),
        ({"center": [0, math.inf, 0]}, "center"),
        ({"turn": 7.0}, "turn"),
    ],
)
def test_ellipsoids_refuse_by_name(given_, name: str) -> None:
    with pytest.raises(ValueError, match=rf"^{name}: expected [^\n]*$"):
        quadric(**({"center": [0, 0, 0], "radii": [1, 1, 1]} | given_))


@pytest.mark.parametrize(
    ("given_", "name"),
    [
        ({"threshold": 1.0}, "threshold"),
        ({"threshold": -0.1}, "threshold"),
        ({"dynamics": 0.0}, "dynamics"),
        ({"noise": [-0.1]}, "noise"),
        ({"Q": [math.nan]}, "Q"),
    ],
)
def test_modulation_refuses_by_name(given_, name: str) -> None:
    with pytest.raises(ValueError, match=rf"^{name}: expected [^\n]*$"):
        modulate(**({"Q": [0.5], "noise": [0.5]} | given_))


def test_places_beyond_numbers_are_refused() -> None:
    ball = quadric([0, 0, 0], [1, 1, 1])
    assert evaluate_quadric(ball, [[1e150, 0, 0]])[0] == pytest.approx(-1e300)
    with pytest.raises(ValueError, match=r"^points: expected places at which the"):
        evaluate_quadric(ball, [[0, 0, 0], [1e300, 0, 0]])
    with pytest.raises(ValueError, match=r"^center: expected a place .* got 1e"):
        quadric([1e300, 0, 0], [1, 1, 1])
