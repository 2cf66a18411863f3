"""Balls under one light are drawn by their brightness; others by every channel."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refcloud.lighting import LitMetaballs, eyeward, eyeward_literal, sunward
from refcloud.lighting.flat_tiles import flat_balls
from refcloud.lighting.seen import seen_by
from refcloud.lighting.tints import ROUNDED, tinted
from refcloud.noise import uniform
from refcloud.optics import Medium, Sun
from tests.lighting.test_tolerance import MEDIUM, SMOOTH, SUNS, WIDE, scattered_balls

COLOURED = Sun(np.array([0.3, 0.8, 0.5]), np.array([9.0, 6.0, 0.7]))
SKY = dataclasses.replace(SMOOTH, sky_light=np.array([0.2, 0.3, 0.5]))


@given(
    st.lists(st.just(0.0) | st.floats(1e-6, 1e3), min_size=3, max_size=3).filter(any),
    st.integers(0, 2**63 - 1),
)
def test_multiples_of_one_colour_are_one_light(color, seed) -> None:
    brightness = 0.01 + uniform(np.arange(20), seed=seed)
    colours = np.array(color)[:, None] * brightness
    found = tinted(colours)
    assert len(found.lights) == 1
    for (number, share), channel in zip(found.shown, colours, strict=True):
        assert number == 0 <= share <= 1.0
        off = np.abs(found.lights[0] * share - channel)
        assert (off <= ROUNDED * channel).all()


@given(st.integers(0, 2**63 - 1), st.integers(0, 19), st.integers(0, 2))
def test_one_ball_of_another_colour_and_every_channel_is_drawn(seed, ball, channel):
    colours = np.ones((3, 20)) * (0.1 + uniform(np.arange(20), seed=seed))
    colours[channel, ball] *= 1.0 + 1e-9
    found = tinted(colours)
    assert found.lights is colours
    assert found.shown == ((0, 1.0), (1, 1.0), (2, 1.0))


def test_black_balls_show_black() -> None:
    for colours in (np.zeros((3, 4)), np.zeros((3, 0))):
        found = tinted(colours)
        for number, share in found.shown:
            np.testing.assert_array_equal(found.lights[number] * share, 0.0)


def lights_of(lit: LitMetaballs) -> list[int]:
    """Count the lights that are drawn, by group of channels."""
    seen, _ = seen_by(lit, WIDE, None)
    flat = flat_balls(seen, seen.order[seen.shown[seen.order]])
    return [len(lights) for lights in flat.lights]


@pytest.mark.parametrize("tolerance", [0.0, 1e-5, 0.02])
@pytest.mark.parametrize(
    ("suns", "medium", "look", "lights"),
    [
        ((COLOURED,), MEDIUM, SMOOTH, [1]),
        ((COLOURED,), MEDIUM, SKY, [3]),
        (SUNS, MEDIUM, SMOOTH, None),
        ((COLOURED,), Medium([1.0, 1.0, 0.5], 0.9), SMOOTH, None),
        ((COLOURED,), Medium([1.0, 0.8, 0.5], 0.9), SMOOTH, [1, 1, 1]),
    ],
)
def test_pictures_are_those_of_the_literal_loop(suns, medium, look, lights, tolerance):
    balls = scattered_balls(2, 40)
    balls = dataclasses.replace(balls, radii=2.0 * balls.radii)
    lit = sunward(balls, suns, medium=medium, look=look)
    assert lights is None or lights_of(lit) == lights
    background = np.full((WIDE.height, WIDE.width, 3), 0.3)
    for behind in (None, background):
        found, _ = eyeward(lit, WIDE, background=behind, tolerance=tolerance)
        exact = eyeward_literal(lit, WIDE, background=behind)
        assert np.abs(found - exact).max() <= max(tolerance, 1e-12 * exact.max())
