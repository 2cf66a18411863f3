"""Balls that take their light from the solved field."""

from __future__ import annotations

import numpy as np
import pytest
from small_lights import BALL, FORWARD, SUN

from refcloud.camera import Camera, rays
from refcloud.lighting import Look, eyeward, lit_by_solution
from refcloud.march import integrate
from refcloud.metaballs import voxel_balls
from refcloud.optics import Medium
from refcloud.transport import scattered_light, source_toward

BALLS = voxel_balls(BALL)
EYE = Camera([0.8, 0.6, 4.0], [0.5, 0.5, 0.5], fov_y=0.35, width=12, height=12)
PLAIN = Look(erosion=0.0, relief=0.0, light_reach=0.0)


def test_in_a_white_furnace_every_ball_shines_white() -> None:
    white = np.ones(3)
    light = scattered_light(BALL, (), medium=FORWARD, sky=white, ground=white)
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
    np.testing.assert_allclose(lit.ambient[:, 0], expected, rtol=1e-3, atol=1e-6)


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
