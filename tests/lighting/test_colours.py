"""Names of rules, and the colours of balls before any eye (eq 26 and 29)."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_scenes import BALLS, DARK, EXTENDED, EYE, MEDIUM, PAPER, SUNS
from twins.lighting import clouds, looks, media, suns_of

from refcloud.camera import Camera, OrthographicCamera
from refcloud.conventions import WHOLE_SPHERE
from refcloud.lighting import MAN, Look, ball_colours, named, sunward
from refcloud.metaballs import Metaballs
from refcloud.optics import TAU_MAN2003, Medium, Sun, henyey_greenstein

ONE = Metaballs([[0, 0, 0]], [1.0], [1.0])


def test_names_of_rules() -> None:
    assert named("man") is MAN
    np.testing.assert_equal(
        dataclasses.asdict(named("cumulus")), dataclasses.asdict(Look())
    )
    own = Look(relief=0.1)
    assert named(own) is own


def test_the_papers_rules_have_every_extension_off() -> None:
    assert MAN.tau == TAU_MAN2003
    rules = (MAN.scattering, MAN.transmittance, MAN.footprint, MAN.readback)
    assert rules == ("man2003", "linear", "profile", "disc")
    assert MAN.solid_angle == 1.0
    assert MAN.erosion_depth == 1.0
    off = MAN.light_reach, MAN.erosion, MAN.relief, *MAN.sky_light, *MAN.ground_light
    assert not any(off)


@settings(max_examples=40)
@given(clouds(), suns_of(), media, looks)
def test_colours_are_finite_and_never_negative(balls, suns, medium, look) -> None:
    lit = sunward(balls, suns, medium=medium, look=look)
    colours = ball_colours(lit, EYE)
    assert colours.shape == (len(balls), len(suns) + 1, 3)
    assert np.isfinite(colours).all()
    assert (colours >= 0.0).all()
    np.testing.assert_array_equal(colours[:, -1], medium.albedo_rgb * lit.ambient)


@given(st.floats(-0.9, 0.9), st.sampled_from([1.0, -1.0]))
def test_light_goes_forward_to_an_eye_that_faces_the_sun(g, side) -> None:
    # The sun stands behind the ball (forward, cos 1) or behind the eye (cos -1).
    medium = Medium(1.0, g=g, phase="hg")
    rules = dataclasses.replace(EXTENDED, **DARK)
    sun = Sun([0, 0, -side])
    lit = sunward(ONE, (sun,), medium=medium, look=rules)
    colour = ball_colours(lit, Camera([0, 0, 9], [0, 0, 0]))[0, 0, 0]
    expected = WHOLE_SPHERE * henyey_greenstein([side], g)[0]
    assert colour == pytest.approx(expected, rel=1e-12)


def test_e20_eq_26_divides_by_4_pi_once() -> None:
    # g* = a tau p I / (4 pi) with a = .9, tau = 8, p = 1.5: 0.859 of the light.
    rules = dataclasses.replace(PAPER, **DARK)
    lit = sunward(ONE, (Sun([0, 0, 1]),), medium=MEDIUM, look=rules)
    colour = ball_colours(lit, Camera([0, 0, 9], [0, 0, 0]))[0, 0, 0]
    added = colour * -np.expm1(-TAU_MAN2003)
    assert added == pytest.approx(0.9 * 8.0 * 1.5 / WHOLE_SPHERE, rel=1e-12)


@pytest.mark.parametrize("solid_angle", [0.0, 0.09, 2.0])
def test_e22_the_solid_angle_scales_eq_26(solid_angle: float) -> None:
    rules = dataclasses.replace(PAPER, tau=0.5, **DARK)
    wide = dataclasses.replace(rules, solid_angle=solid_angle)
    one, other = (
        ball_colours(sunward(ONE, SUNS, medium=MEDIUM, look=look), EYE)
        for look in (rules, wide)
    )
    np.testing.assert_allclose(other, solid_angle * one, rtol=1e-12)


@pytest.mark.parametrize("tau", [0.0, 1e-300, 9.3, 9.4, 1e37])
def test_e23_what_goes_to_the_eye_is_held_as_well(tau: float) -> None:
    rules = dataclasses.replace(PAPER, tau=tau, **DARK)
    medium = Medium(1.0, 0.9)
    lit = sunward(ONE, (Sun([0, 0, 1]),), medium=medium, look=rules)
    colour = ball_colours(lit, Camera([0, 0, 9], [0, 0, 0]))[0, 0, 0]
    # Added light and what shines through together are no more than the light.
    assert colour * -np.expm1(-tau) + np.exp(-tau) <= 1.0 + 1e-12


def test_a_parallel_eye_sees_all_balls_along_one_direction() -> None:
    medium = Medium(1.0, g=0.5, phase="hg")
    rules = dataclasses.replace(EXTENDED, **DARK)
    lit = sunward(BALLS, (Sun([1, 1, 1], [1, 1, 1]),), medium=medium, look=rules)
    colours = ball_colours(lit, OrthographicCamera([0, 0, 9], [0, 0, 0]))[:, 0]
    ratio = colours / np.where(lit.light[0] > 0.0, lit.light[0], 1.0)
    np.testing.assert_allclose(ratio[lit.light[0] > 0.0], ratio.max(), rtol=1e-12)


def test_a_ball_on_the_eye_has_a_colour() -> None:
    lit = sunward(ONE, SUNS, medium=MEDIUM, look=EXTENDED)
    assert np.isfinite(ball_colours(lit, Camera([0, 0, 0], [0, 0, -1]))).all()
