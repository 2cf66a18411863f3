"""Balls that take their light from the solved field."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_lights import BALL, FORWARD, SUN

import refcloud as rc
from refcloud.camera import Camera, OrthographicCamera, rays
from refcloud.lighting import (
    Look,
    ball_colours,
    eyeward,
    lit_by_solution,
    solved_light,
    sunward,
)
from refcloud.march import integrate
from refcloud.metaballs import Metaballs, sampled_map, voxel_balls
from refcloud.optics import Medium, Sun
from refcloud.scene import SCENES, Model, View
from refcloud.transport import Plan, Stage, scattered_light, source_toward

BALLS = voxel_balls(BALL)
EYE = Camera([0.8, 0.6, 4.0], [0.5, 0.5, 0.5], fov_y=0.35, width=12, height=12)
FEW = Metaballs([[0.3, 0.5, 0.5], [0.6, 0.4, 0.5]], [0.25, 0.3], [2.0, 3.0])
TIGHT = Plan((Stage(26, 0, 500, 1e-7),), double=True)
PLAIN = Look(erosion=0.0, relief=0.0, light_reach=0.0)


def test_in_a_white_furnace_every_ball_shines_white() -> None:
    white = np.ones(3)
    light = scattered_light(
        BALL, (), medium=FORWARD, sky=white, ground=white, plan=TIGHT
    )
    for eye in (None, EYE.eye):
        lit = lit_by_solution(BALLS, light, eye=eye)
        np.testing.assert_allclose(lit.ambient, 1.0, atol=1e-5)


def test_each_ball_has_the_voxels_own_light() -> None:
    light = scattered_light(BALL, SUN, medium=FORWARD, plan="standard")
    far = 1e6 * np.array([0.0, 0.6, 0.8])
    lit = lit_by_solution(BALLS, light, eye=far)
    J = source_toward(light, far)
    # One ball stands at the centre of each occupied voxel.
    inside = np.zeros(light.grid.density.shape)
    low = np.rint((light.lower - BALL.lower) * 16).astype(int)[::-1]
    room = inside[tuple(slice(a, None) for a in low)].shape
    part = J[tuple(slice(0, n) for n in room)][..., 0]
    inside[tuple(slice(a, a + n) for a, n in zip(low, part.shape, strict=True))] = part
    expected = inside[BALL.density > 0.0]
    assert lit.glow is not None
    assert not lit.ambient.any()
    np.testing.assert_allclose(lit.glow[0, :, 0], expected, rtol=1e-3, atol=1e-6)


def test_splats_show_what_the_march_shows() -> None:
    """One ball per voxel is not the map, but its picture is as bright."""
    medium = Medium(9.0, g=0.6, phase="hg")
    light = scattered_light(BALL, SUN, medium=medium, plan="standard")
    lit = lit_by_solution(BALLS, light, eye=EYE.eye, look=PLAIN)
    drawn, _ = eyeward(lit, EYE, background=np.zeros((12, 12, 3)))
    marched, _ = integrate(
        BALL, *rays(EYE), suns=SUN, medium=medium, scattering=light, tolerance=0.01
    )
    sums = drawn[..., 0].sum(), marched[..., 0].sum()
    assert sums[0] == pytest.approx(sums[1], rel=0.3)  # seen .17: balls overlap


def test_what_it_does_not_model_is_refused() -> None:
    coloured = Medium([1.0, 2.0, 3.0])
    light = scattered_light(BALL, SUN, medium=coloured, plan="quick")
    with pytest.raises(ValueError, match=r"^light: expected light in a medium"):
        lit_by_solution(BALLS, light)
    light = scattered_light(BALL, SUN, medium=FORWARD, plan="quick")
    with pytest.raises(ValueError, match=r"^look: expected a look whose depths"):
        lit_by_solution(BALLS, light, look="man")


def test_every_eye_sees_light_that_was_solved_once() -> None:
    how = {"suns": SUN, "medium": FORWARD, "width": 16, "tolerance": 0.05}
    kept = {}
    first = rc.render(FEW, scattering="multiple", observe=kept.__setitem__, **how)
    assert any(note.startswith("scattered light: 2 solutions") for note in first.notes)
    lights = kept["scattered light"]
    again = rc.render(FEW, scattering=lights, width=16, tolerance=0.05)
    np.testing.assert_array_equal(again.linear, first.linear)
    above = Camera([0.5, 6.0, 0.6], [0.5, 0.5, 0.5], width=8, height=8)
    picture = rc.render(FEW, scattering=lights, camera=above)
    assert picture.linear.min() >= 0.0
    for part in ({"suns": Sun([1, 0, 0])}, {"medium": Medium(5.0)}):
        with pytest.raises(ValueError, match=r"^scattering: expected light that was"):
            rc.render(FEW, scattering=lights, width=8, **part)
    with pytest.raises(ValueError, match=r"^scattering: expected at least one"):
        rc.render(FEW, scattering=(), width=8)


def test_suns_solved_apart_add_up_to_suns_solved_together() -> None:
    other = Sun([-0.4, 0.2, 0.9], [0.5, 2.0, 1.0])
    look = replace(PLAIN, sky_light=np.zeros(3), ground_light=np.zeros(3))
    how = {"medium": FORWARD, "plan": TIGHT}
    apart = solved_light(FEW, (SUN, other), look=look, **how)
    assert len(apart) == 2
    together = scattered_light(sampled_map(FEW), (SUN, other), **how)
    one, two = (
        ball_colours(lit_by_solution(FEW, light, eye=EYE.eye, look=look), EYE)
        for light in (apart, together)
    )
    np.testing.assert_allclose(
        one.sum(axis=1), two.sum(axis=1), atol=1e-5 * one.max(), rtol=0
    )


def test_light_that_was_solved_is_not_taken_for_light_that_was_carried() -> None:
    medium = Medium(9.0)
    lit = lit_by_solution(FEW, solved_light(FEW, SUN, medium=medium, plan="quick"))
    anew = sunward(FEW, (SUN,), medium=medium)
    again = sunward(FEW, (SUN,), medium=medium, earlier=lit)
    np.testing.assert_array_equal(again.light, anew.light)


@pytest.mark.parametrize("name", ["man-13", "cumulus"])
def test_scenes_take_their_light_from_the_solution_or_from_the_balls(name) -> None:
    clouds = {k: FEW for k in ("cloud", *(f"field {n}" for n in range(5)))}
    scene, model = SCENES[name], Model(clouds)
    eye = View(8, 6, camera=EYE, look="cumulus", tolerance=0.1)
    single, many = (
        scene.draw(model, replace(eye, scattering=how))
        for how in ("single", "multiple")
    )
    assert any(note.startswith("scattered light: ") for note in many.notes)
    assert not any(note.startswith("scattered light: ") for note in single.notes)


def test_no_balls_are_lit() -> None:
    none = Metaballs(np.zeros((0, 3)), [], [])
    for camera in (EYE, OrthographicCamera([0, 0, 9], [0, 0, 0], width=4, height=4)):
        picture = rc.render(none, camera=camera, scattering="multiple")
        assert np.isfinite(picture.linear).all()
