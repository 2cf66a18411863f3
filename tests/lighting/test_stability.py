"""Extreme scenes: no overflow, no underflow that shows, no popping, one order."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_scenes import BACKDROP, DARK, EYE, LOOKS, MEDIUM, SUNS, drawn
from twins.lighting import scattered_balls, seeds

from refcloud.camera import Camera, OrthographicCamera, project
from refcloud.lighting import eyeward, eyeward_literal, sunward
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun

BEER = dataclasses.replace(
    LOOKS["man"], transmittance="beer", scattering="split", tau=None
)
WHITE = np.ones((9, 12, 3))
every_look = pytest.mark.parametrize(
    "look", [*LOOKS.values(), BEER], ids=[*LOOKS, "beer"]
)


@pytest.mark.parametrize("tolerance", [0.0, 1e-5, 1e-2])
@pytest.mark.parametrize("tau", [1e-6, 1e-3, 1.0, 100.0])
def test_ten_thousand_balls_in_a_row(tau: float, tolerance: float) -> None:
    # Running products of exp(-1) are 0 after 745 balls; what is behind is black, and
    # no quotient of two such products is ever taken.
    count = 10_000
    centers = np.stack([np.zeros(count), np.zeros(count), -1e-3 * np.arange(count)], 1)
    row = Metaballs(centers, np.ones(count), np.ones(count))
    look = dataclasses.replace(BEER, tau=tau, **DARK)
    eye = OrthographicCamera(
        [0, 0, 5], [0, 0, 0], height_of_view=2.0, width=5, height=5
    )
    lit = sunward(row, (Sun([0, 0, 1]),), medium=MEDIUM, look=look)
    light = lit.light[0, :, 0]
    assert light[0] == pytest.approx(4.0 * np.pi, rel=1e-12)
    assert (np.diff(light) <= 1e-12).all()
    picture, _ = eyeward(lit, eye, tolerance=tolerance)
    assert np.isfinite(picture).all()
    alpha = -np.expm1(-tau * count)
    assert picture[2, 2, 3] == pytest.approx(alpha, abs=max(tolerance, 1e-12))


@every_look
@settings(max_examples=8)
@given(seeds, st.floats(-12.0, 37.0), st.sampled_from([0.0, 1e-4]))
def test_any_depth_is_the_literal_loops(look, seed, power, tolerance) -> None:
    balls = scattered_balls(seed, 8)
    rules = dataclasses.replace(look, tau=10.0**power)
    lit = sunward(balls, SUNS, medium=MEDIUM, look=rules)
    found, _ = eyeward(lit, EYE, background=BACKDROP, tolerance=tolerance)
    expected = eyeward_literal(lit, EYE, background=BACKDROP)
    scale = max(1.0, float(np.abs(expected).max()))
    assert np.abs(found - expected).max() <= tolerance + 1e-12 * scale


@every_look
@settings(max_examples=8)
@given(seeds, st.floats(-2.0, 8.0), st.sampled_from([0.0, 1e-4]))
def test_any_radius_is_the_literal_loops(look, seed, power, tolerance) -> None:
    # In pixels, from 0.01 to 1e8; wide ones also stand beside the picture.
    balls = scattered_balls(seed, 6)
    _, _, _, scale = project(EYE, balls.centers)
    radii = 10.0**power * (0.5 + np.arange(6) / 6.0) / scale
    centers = balls.centers + np.array([1.0, 0.0, 0.0]) * np.where(
        np.arange(6) < 3, 0.0, radii
    ).reshape(-1, 1)
    sized = dataclasses.replace(balls, radii=radii, centers=centers)
    rules = dataclasses.replace(look, tau=1.5)
    lit = sunward(sized, SUNS, medium=MEDIUM, look=rules)
    found, _ = eyeward(lit, EYE, background=BACKDROP, tolerance=tolerance)
    expected = eyeward_literal(lit, EYE, background=BACKDROP)
    scale = max(1.0, float(np.abs(expected).max()))
    assert np.abs(found - expected).max() <= tolerance + 1e-12 * scale


@every_look
@pytest.mark.parametrize("tolerance", [0.0, 1e-4])
def test_no_ball_pops_at_the_near_plane(look, tolerance: float) -> None:
    # An eye that flies through a ball: each step of a 60th of its radius changes the
    # picture by no more than the share of its depth that such a step fades.
    ball = Metaballs([[0, 0, 0]], [1.0], [1.0])
    rules = dataclasses.replace(look, tau=2.0, erosion=0.0, relief=0.0, **DARK)
    lit = sunward(ball, (Sun([0, 1, 0], [0, 0, 0]),), medium=MEDIUM, look=rules)
    white = np.ones((3, 4, 3))
    steps = np.linspace(1.4, -0.1, 91)
    means = []
    for z in steps:
        eye = Camera([0.01, 0.0, z], [0.01, 0.0, z - 1.0], width=4, height=3)
        picture, _ = eyeward(lit, eye, background=white, tolerance=tolerance)
        means.append(picture[..., 0].mean())
    jumps = np.abs(np.diff(means))
    # The fade's slope is 1.5 per radius at most; depth 2 (1.6 times that in cumulus).
    depth = 2.0 * look.erosion_depth
    assert jumps.max() <= 1.5 * depth / 60.0 * 1.2 + 2.0 * tolerance
    assert means[-1] == 1.0
    assert means[0] < 0.8


@every_look
@settings(max_examples=6)
@given(st.permutations(range(12)), st.sampled_from([0.0, 1e-5, 1e-2]))
def test_equal_depths_and_any_order_of_the_input_give_the_same_bits(
    look, order, tolerance
) -> None:
    # Three layers of four balls each, all of a layer at one depth from eye and sun.
    spots = [[x, y, z] for z in (-1.0, 0.0, 1.0) for x in (-0.7, 0.7) for y in (0, 1)]
    balls = Metaballs(spots, np.full(12, 0.9), np.ones(12))
    eye = OrthographicCamera(
        [0, 0, 5], [0, 0, 0], height_of_view=4, width=40, height=30
    )
    how = {"look": look, "camera": eye, "tolerance": tolerance}
    mixed = dataclasses.replace(balls, centers=balls.centers[list(order)])
    suns = (Sun([0, 0, 1], [3, 2, 1]),)
    np.testing.assert_array_equal(drawn(mixed, suns, **how), drawn(balls, suns, **how))


@pytest.mark.parametrize("tau", [9.3, 9.4, 20.0, 1e3, 1e37])
@pytest.mark.parametrize("tolerance", [0.0, 0.01])
def test_e23_gain_above_one_never_lights_a_row_up(tau: float, tolerance: float) -> None:
    # Where eq 26 would make light, 2.7 times in a hundred balls at 9.4: held at 1.
    centers = np.stack([np.zeros(100), np.arange(100.0), np.zeros(100)], axis=1)
    row = Metaballs(centers, np.ones(100), np.ones(100))
    look = dataclasses.replace(LOOKS["man"], tau=tau)
    sun = (Sun([0, 1, 0], [1, 1, 1]),)
    lit = sunward(row, sun, medium=Medium(1.0, 0.9), look=look, tolerance=tolerance)
    assert lit.light.min() >= 0.0
    assert lit.light.max() <= 1.0 + 1e-12
    picture, _ = eyeward(lit, EYE, background=WHITE, tolerance=tolerance)
    assert np.isfinite(picture).all()
