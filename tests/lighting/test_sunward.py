"""Pass 1: no light is made, lights add up, splitting and order change nothing."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_scenes import BALLS, DARK, EXTENDED, LOOKS, MEDIUM, PAPER, SUNS
from twins.lighting import clouds, looks, media, scattered_balls, seeds, suns_of

from refcloud.lighting import LitMetaballs, Look, sunward
from refcloud.metaballs import Metaballs
from refcloud.optics import (
    Medium,
    Sun,
    coupling_man2003,
    scattered_man2003,
    scattered_split,
)

some = settings(max_examples=25)
ROUNDED = 1e-12  # of the largest light: chains of up to ten sums and products
WHITE = Sun([0.3, 1.0, 0.2], [1, 1, 1])
balls_in_any_order = st.permutations(range(len(BALLS)))


def listed_as(balls: Metaballs, order: list[int]) -> Metaballs:
    k = np.array(order, dtype=int)
    return dataclasses.replace(
        balls,
        centers=balls.centers[k],
        radii=balls.radii[k],
        densities=balls.densities[k],
    )


@some
@given(clouds(6), media, looks, seeds)
def test_e23_no_ball_gets_more_than_the_sun_sends(balls, medium, look, seed) -> None:
    way = np.array([seed % 7, 3.0, seed % 5]) - 1.5
    lit = sunward(balls, (Sun(way, [1, 1, 1]),), medium=medium, look=look)
    assert lit.light.min(initial=0.0) >= 0.0
    assert lit.light.max(initial=0.0) <= 1.0 + ROUNDED
    sky = look.sky_light + look.ground_light
    assert (lit.ambient >= 0.0).all()
    assert (lit.ambient <= sky * (1.0 + ROUNDED)).all()


@pytest.mark.parametrize("look", LOOKS.values(), ids=LOOKS)
@pytest.mark.parametrize("tau", [0.0, 1e-9, 1.0, 9.3, 9.4, 20.0, 1e37])
def test_e23_a_long_row_of_balls_makes_no_light(look: Look, tau: float) -> None:
    # A hundred balls in line with the sun: where g + T were 1.01, 2.7 times the light.
    centers = np.stack([np.zeros(100), np.arange(100.0), np.zeros(100)], axis=1)
    row = Metaballs(centers, np.ones(100), np.ones(100))
    rules = dataclasses.replace(look, tau=tau, buffer=5)
    lit = sunward(row, (Sun([0, 1, 0], [1, 1, 1]),), medium=MEDIUM, look=rules)
    share = lit.light[0, ::-1, 0]
    assert share[0] == 1.0
    assert (np.diff(share) <= ROUNDED).all(), (
        "each ball gets no more than the one before"
    )


def test_e23_refusing_is_one_line_before_anything_is_drawn() -> None:
    rules = dataclasses.replace(PAPER, tau=9.4, gain="refuse")
    with pytest.raises(ValueError, match=r"^tau: expected at most 9\.308[^\n]*$"):
        sunward(BALLS, (WHITE,), medium=MEDIUM, look=rules)
    held = dataclasses.replace(rules, gain="hold")
    assert sunward(BALLS, (WHITE,), medium=MEDIUM, look=held).light.max() <= 1.0


def test_e23_a_coupling_over_1_is_refused_by_name() -> None:
    rules = dataclasses.replace(PAPER, solid_angle=4.0 * math.pi)
    with pytest.raises(ValueError, match=r"^solid_angle: expected [^\n]* got 1\.35"):
        sunward(BALLS, (WHITE,), medium=MEDIUM, look=rules)


def test_e22_the_solid_angle_scales_what_is_handed_on() -> None:
    pair = Metaballs([[0, 1, 0], [0, -1, 0]], [1, 1], [1, 1])
    for solid_angle in (0.0, 0.09, 1.0, 2.0):
        rules = dataclasses.replace(
            PAPER, tau=0.5, solid_angle=solid_angle, buffer=1, footprint="chord"
        )
        lit = sunward(pair, (Sun([0, 1, 0], [1, 1, 1]),), medium=MEDIUM, look=rules)
        kappa = coupling_man2003(0.9, solid_angle=solid_angle)
        expected = kappa * 0.5 + math.exp(-0.5)
        assert lit.light[0, 1, 0] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("parts", [2, 3, 8])
@pytest.mark.parametrize("transmittance", ["beer", "linear"])
def test_a_ball_split_into_thinner_ones_hands_on_the_same(parts, transmittance) -> None:
    # On the axis: one pixel, whose centre is that of every ball.
    rules = dataclasses.replace(EXTENDED, transmittance=transmittance, buffer=1, **DARK)
    light = []
    for n in (1, parts):
        centers = [[0, 2, 0]] * n + [[0, -2, 0]]
        balls = Metaballs(centers, np.ones(n + 1), [1.7 / n] * n + [1.0])
        lit = sunward(balls, (Sun([0, 1, 0], [1, 1, 1]),), medium=MEDIUM, look=rules)
        light.append(lit.light[0, -1, 0])
    assert light[1] == pytest.approx(light[0], rel=1e-13)
    tau = 1.5 * 1.7 * 944.0 / 945.0
    shares = scattered_split([tau], 0.9 * rules.forward)[0] + math.exp(-tau)
    assert light[0] == pytest.approx(shares, rel=1e-13)


def test_in_the_papers_rule_a_split_ball_hands_on_less() -> None:
    rules = dataclasses.replace(PAPER, tau=8.0, buffer=1)
    kappa = coupling_man2003(0.9)
    for n in (1, 2, 8):
        centers = [[0, 2, 0]] * n + [[0, -2, 0]]
        balls = Metaballs(centers, np.ones(n + 1), np.ones(n + 1))
        thin = dataclasses.replace(rules, tau=8.0 / n)
        lit = sunward(balls, (Sun([0, 1, 0], [1, 1, 1]),), medium=MEDIUM, look=thin)
        each = scattered_man2003([8.0 / n], kappa)[0] + math.exp(-8.0 / n)
        assert lit.light[0, -1, 0] == pytest.approx(each**n, rel=1e-12)


@some
@given(clouds(5), suns_of(3), media, looks)
def test_each_sun_is_carried_by_itself(balls, suns, medium, look) -> None:
    together = sunward(balls, suns, medium=medium, look=look)
    assert together.light.shape == (len(suns), len(balls), 3)
    for s, sun in enumerate(suns):
        alone = sunward(balls, (sun,), medium=medium, look=look)
        np.testing.assert_array_equal(alone.light[0], together.light[s])
        np.testing.assert_array_equal(alone.ambient, together.ambient)


@some
@given(clouds(5), media, looks, st.floats(0.0, 4.0))
def test_light_is_proportional_to_the_sun(balls, medium, look, factor) -> None:
    once, more = (
        sunward(
            balls, (Sun([1, 2, 3], f * np.array([1, 2, 3])),), medium=medium, look=look
        )
        for f in (1.0, factor)
    )
    np.testing.assert_allclose(more.light, factor * once.light, rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("look", LOOKS.values(), ids=LOOKS)
@given(balls_in_any_order)
@settings(max_examples=20)
def test_the_order_of_the_input_never_shows(look: Look, order) -> None:
    straight = sunward(BALLS, SUNS, medium=MEDIUM, look=look)
    mixed = sunward(listed_as(BALLS, order), SUNS, medium=MEDIUM, look=look)
    np.testing.assert_array_equal(mixed.light, straight.light[:, order])
    np.testing.assert_array_equal(mixed.ambient, straight.ambient[order])


def test_balls_at_one_depth_have_one_order() -> None:
    spots = [[i, 0.0, j] for i in range(3) for j in range(3)]
    balls = Metaballs(spots, np.ones(9), np.ones(9))
    orders = []
    for order in ([*range(9)], [*range(8, -1, -1)]):
        mixed, seen = listed_as(balls, order), {}
        sun = (Sun([0, 1, 0]),)
        sunward(mixed, sun, medium=MEDIUM, look=PAPER, observe=seen.__setitem__)
        orders.append(mixed.centers[seen["sun 0 order"]].tolist())
    assert orders[0] == orders[1]


def test_e26_balls_are_lit_from_the_nearest_on() -> None:
    seen: list = []
    rules = dataclasses.replace(EXTENDED, **DARK)
    sun = Sun([1, 1, 0])
    sunward(
        BALLS,
        (sun,),
        medium=MEDIUM,
        look=rules,
        observe=lambda name, value: seen.append((name, value)),
    )
    (name, order), (last, buffer) = seen
    assert (name, last) == ("sun 0 order", "sun 0 buffer")
    toward = BALLS.centers[order] @ sun.direction
    assert (np.diff(toward) <= 0.0).all()
    assert buffer.pixels.shape == (16, 16, 4)


@some
@given(clouds(5), looks, st.floats(-0.9, 0.9))
def test_e26_light_is_stored_before_the_phase_function(balls, look, g) -> None:
    plain, lobed = (
        sunward(balls, SUNS, medium=Medium(1.2, 0.8, g, name), look=look)
        for name in ("isotropic", "hg")
    )
    np.testing.assert_array_equal(plain.light, lobed.light)


@some
@given(seeds, st.lists(st.floats(0.0, 4.0), min_size=3, max_size=3), looks)
def test_a_coloured_medium_is_three_grey_ones(seed, sigma_t, look) -> None:
    balls = scattered_balls(seed, 4)
    coloured = sunward(balls, SUNS, medium=Medium(sigma_t, 0.9), look=look)
    for channel, sigma in enumerate(sigma_t):
        grey = sunward(balls, SUNS, medium=Medium(sigma, 0.9), look=look)
        np.testing.assert_array_equal(
            coloured.light[..., channel], grey.light[..., channel]
        )
        np.testing.assert_array_equal(
            coloured.ambient[:, channel], grey.ambient[:, channel]
        )


@some
@given(clouds(5), media, looks)
def test_dark_lights_give_nothing(balls, medium, look) -> None:
    rules = dataclasses.replace(look, **DARK)
    lit = sunward(balls, (Sun([1, 2, 3], [0, 0, 0]),), medium=medium, look=rules)
    assert not lit.light.any()
    assert not lit.ambient.any()


@given(st.floats(0.6, 2.0), st.floats(0.01, 5.0))
def test_the_first_ball_gets_all_and_a_hidden_one_less(radius, thick) -> None:
    row = Metaballs([[0, 3, 0], [0, -3, 0]], [radius, radius], [thick, 1.0])
    lit = sunward(row, (Sun([0, 1, 0], [1, 1, 1]),), medium=MEDIUM, look=EXTENDED)
    assert lit.light[0, 0, 0] == pytest.approx(1.0, abs=1e-15)
    assert lit.light[0, 1, 0] < 1.0 - 1e-6


@pytest.mark.parametrize("look", LOOKS.values(), ids=LOOKS)
@pytest.mark.parametrize("size", [1.0, 1e-12])
def test_a_cloud_far_out_is_lit_as_one_at_home(look: Look, size: float) -> None:
    # Places that 1e6 and the cloud's own numbers both hold exactly.
    centers = np.round(BALLS.centers * 64.0) / 64.0
    home = dataclasses.replace(BALLS, centers=centers, radii=size * BALLS.radii)
    away = dataclasses.replace(home, centers=centers + 2.0**20)
    near, far = (sunward(b, SUNS, medium=MEDIUM, look=look) for b in (home, away))
    # Only the rounding of lower + upper may differ, by 1e-10 where radii are not whole.
    np.testing.assert_allclose(far.light, near.light, rtol=0.0, atol=1e-6)


def test_one_tiny_ball_far_out_is_lit() -> None:
    ball = Metaballs([[1e6, 1e6, 1e6]], [1e-12], [1.0])
    lit = sunward(ball, SUNS, medium=MEDIUM, look=EXTENDED)
    full = [sun.irradiance for sun in SUNS]
    np.testing.assert_allclose(lit.light[:, 0], full, rtol=1e-15)


@pytest.mark.parametrize("look", LOOKS.values(), ids=LOOKS)
def test_no_balls_and_no_suns_are_no_special_case(look: Look) -> None:
    nothing = Metaballs(np.zeros((0, 3)), [], [])
    lit = sunward(nothing, SUNS, medium=MEDIUM, look=look)
    assert (lit.light.shape, lit.ambient.shape) == ((2, 0, 3), (0, 3))
    assert sunward(BALLS, (), medium=MEDIUM, look=look).light.shape == (0, 6, 3)


@settings(max_examples=30)
@given(seeds, st.floats(-6.0, 6.0))
def test_balls_of_any_size_beside_each_other_stay_finite(seed, power) -> None:
    balls = scattered_balls(seed, 4)
    radii = balls.radii * np.array([1.0, 10.0**power, 1.0, 10.0**-power])
    mixed = dataclasses.replace(balls, radii=radii)
    lit = sunward(mixed, SUNS, medium=MEDIUM, look=EXTENDED)
    assert np.isfinite(lit.light).all()
    assert lit.light.max() <= max(s.irradiance.max() for s in SUNS) * (1.0 + ROUNDED)


@given(seeds)
def test_moving_the_sun_only_along_its_rays_changes_nothing(seed: int) -> None:
    balls = scattered_balls(seed, 4)
    one, two = (
        sunward(balls, (Sun(f * np.array([1.0, 2.0, 3.0])),), medium=MEDIUM, look=PAPER)
        for f in (1.0, 1024.0)
    )
    np.testing.assert_array_equal(one.light, two.light)


def test_lit_balls_refuse_light_of_another_shape() -> None:
    with pytest.raises(ValueError, match=r"^light: expected shape \(2, 6, 3\)[^\n]*$"):
        LitMetaballs(BALLS, SUNS, np.zeros((1, 5, 3)), np.zeros((5, 3)), MEDIUM, PAPER)
