"""Sweeps find the literal loop's light, and end with an error below their bound."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_scenes import BALLS, DARK, EXTENDED, EYE, LOOKS, MEDIUM, SUNS
from twins.lighting import clouds, looks, media, scattered_balls, seeds, suns_of

from refcloud.lighting import ball_colours, fragments, sunward
from refcloud.lighting.depths import ball_depths
from refcloud.lighting.fragments import Fragments
from refcloud.lighting.in_turn import carried_in_turn
from refcloud.lighting.lightview import light_view
from refcloud.lighting.literal_light import carried_literally
from refcloud.lighting.sweeps import carried
from refcloud.metaballs import Metaballs
from refcloud.noise import uniform
from refcloud.optics import Sun

CLOSE = 1e-12  # worst seen 3e-15 in 2000 scenes
directions = seeds.map(lambda seed: Sun(uniform(np.arange(3), seed=seed) - 0.5))
readbacks = ["footprint", "disc", "square", "antialiased"]


def both(balls, sun, look, side, most=0.0, dtype=np.float64):
    """Carry by sweeps and literally."""
    view = light_view(balls, sun.direction, side)
    tau = ball_depths(balls, 1.5, look)
    found = fragments.fragments(view, look, dtype)
    assert isinstance(found, Fragments)
    swept = carried(found, tau, 0.9, look, look.forward, most)
    literal, buffer = carried_literally(view, tau, 0.9, look, look.forward)
    return swept, literal, found, buffer


@pytest.mark.parametrize("readback", readbacks)
@settings(max_examples=12)
@given(clouds(30), directions, looks, st.sampled_from([1, 7, 40]))
def test_sweeps_are_the_literal_loop(readback, balls, sun, look, side) -> None:
    if not len(balls):
        return
    rules = dataclasses.replace(look, readback=readback)
    swept, literal, found, buffer = both(balls, sun, rules, side)
    np.testing.assert_allclose(swept.reached, literal, rtol=0.0, atol=CLOSE)
    pixels = buffer.pixels[..., 0].ravel()
    np.testing.assert_allclose(swept.buffer, pixels[found.pixel], rtol=0, atol=CLOSE)
    untouched = np.delete(pixels, found.pixel)
    assert (untouched == 1.0).all()


@settings(max_examples=25)
@given(
    seeds,
    st.integers(2, 60),
    looks,
    st.floats(-2.0, 1.0),
    st.floats(-6.0, -1.0).map(lambda power: 10.0**power),
    st.sampled_from([np.float64, np.float32]),
)
def test_the_bound_holds_whenever_the_sweeps_end(
    seed, count, look, power, most, dtype
) -> None:
    balls = scattered_balls(seed, count)
    balls = dataclasses.replace(balls, densities=10.0**power * balls.densities)
    swept, literal, _, _ = both(balls, SUNS[0], look, 24, most, dtype)
    error = np.abs(swept.reached - literal).max()
    assert error <= swept.bound + CLOSE
    if dtype is np.float64:
        assert swept.bound <= max(most, 1e-11)


def test_each_sweep_takes_most_of_the_error() -> None:
    # The Neumann series: with kappa = k = 0.7 a sweep leaves at most 0.7 of the error;
    # since light comes from a few balls back only, it leaves much less.
    balls = scattered_balls(8, 200)
    swept, _, _, _ = both(balls, SUNS[0], EXTENDED, 64)
    changes = np.array([c for c in swept.changes if c > 1e-12])
    assert len(changes) > 4
    assert (changes[1:] < 0.7 * changes[:-1]).all()
    few, _, _, _ = both(balls, SUNS[0], EXTENDED, 64, most=1e-3)
    assert 0 < len(few.changes) < len(swept.changes)


def test_a_chain_longer_than_any_list_is_carried_to_its_end() -> None:
    # Each ball overlaps the next one's projection alone: light goes from ball to ball.
    count = 40
    k = np.arange(count)
    balls = Metaballs(
        np.stack([0.9 * k, -1.0 * k, 0.0 * k], axis=1), np.ones(count), np.ones(count)
    )
    look = dataclasses.replace(EXTENDED, forward=1.0, **DARK)
    swept, literal, found, _ = both(balls, Sun([0, 1, 0]), look, 200)
    assert len(found.counts) < count
    np.testing.assert_allclose(swept.reached, literal, rtol=0.0, atol=CLOSE)


@settings(max_examples=25)
@given(clouds(20), suns_of(), media, looks, st.floats(-4, -0.5).map(lambda p: 10.0**p))
def test_a_tolerance_of_light_holds_for_every_colour(
    balls, suns, medium, look, tolerance
) -> None:
    exact, found = (
        sunward(balls, suns, medium=medium, look=look, tolerance=t)
        for t in (0.0, tolerance)
    )
    colours = [ball_colours(lit, EYE).sum(axis=1) for lit in (exact, found)]
    assert np.abs(colours[0] - colours[1]).max(initial=0.0) <= tolerance
    assert not exact.skipped
    assert all(row.bound <= tolerance for row in found.skipped)


@pytest.mark.parametrize("readback", readbacks)
@settings(max_examples=8)
@given(clouds(20), directions, looks, st.sampled_from([1, 7, 40]))
def test_one_channel_in_turn_is_the_literal_loop(
    readback, balls, sun, look, side
) -> None:
    if not len(balls):
        return
    rules = dataclasses.replace(look, readback=readback)
    view = light_view(balls, sun.direction, side)
    how = ball_depths(balls, 1.5, rules), 0.9, rules, rules.forward
    reached, buffer = carried_in_turn(view, *how)
    literal, drawn = carried_literally(view, *how)
    np.testing.assert_allclose(reached, literal, rtol=0.0, atol=CLOSE)
    np.testing.assert_allclose(buffer, drawn.pixels[..., 0], rtol=0.0, atol=CLOSE)


def test_a_view_of_too_many_fragments_is_carried_ball_after_ball(monkeypatch) -> None:
    for look in LOOKS.values():
        few = sunward(BALLS, SUNS, medium=MEDIUM, look=look)
        with monkeypatch.context() as patch:
            patch.setattr(fragments, "MOST_FRAGMENTS", 3)
            many = sunward(BALLS, SUNS, medium=MEDIUM, look=look)
        np.testing.assert_allclose(many.light, few.light, rtol=0.0, atol=1e-11)
        np.testing.assert_allclose(many.ambient, few.ambient, rtol=0.0, atol=1e-11)


def test_antialiased_means_converge_sooner_than_hard_discs() -> None:
    balls = scattered_balls(3, 30)
    error = {}
    for readback in ("disc", "antialiased"):
        look = dataclasses.replace(EXTENDED, readback=readback)
        fine = both(balls, SUNS[0], look, 512)[0].reached
        coarse = both(balls, SUNS[0], look, 48)[0].reached
        error[readback] = np.sqrt(np.mean((coarse - fine) ** 2))
    assert error["antialiased"] < 0.5 * error["disc"]
