"""E28: what the code behind paper M does by mistake, and refcloud does not."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from small_scenes import DARK, LOOKS, MEDIUM, drawn

from refcloud.camera import OrthographicCamera, axes
from refcloud.metaballs import Metaballs, chord, profile
from refcloud.noise import hermite
from refcloud.optics import Sun

share = st.floats(-1.0, 1.0)
UP = np.array([0.0, 1.0, 0.0])


@given(share, share, share)
def test_e28_up_gives_way_only_where_the_view_runs_along_it(x, y, z) -> None:
    way = np.array([x, y, z])
    assume(np.hypot(x, z) > 1e-3)
    found = axes(OrthographicCamera(way, np.zeros(3)))
    # Up leans as little from y as a picture that looks along `way` allows.
    view = way / np.linalg.norm(way)
    best = UP - (UP @ view) * view
    np.testing.assert_allclose(found[1], best / np.linalg.norm(best), atol=1e-9)
    # fabs(dot) - 1 < 1e-6, the printed test for a view along y, holds for every view.
    assert abs(view @ UP) - 1.0 < 1e-6


def test_e28_along_up_another_axis_serves() -> None:
    for y in (2.0, -2.0):
        found = axes(OrthographicCamera(np.array([0.0, y, 0.0]), np.zeros(3)))
        np.testing.assert_allclose(found @ found.T, np.eye(3), atol=1e-15)
        assert found[2] @ UP == np.sign(y)


def test_e28_a_ball_has_the_colour_of_its_light_and_none_of_its_own() -> None:
    ball = Metaballs([[0, 0, 0]], [1.5], [1.0])
    for look in LOOKS.values():
        rules = dataclasses.replace(look, **DARK)
        red = drawn(ball, (Sun([1, 2, 3], [5.0, 0.0, 0.0]),), look=rules, medium=MEDIUM)
        assert red[..., 0].max() > 0.0
        # One copy of SkyWorks sets (.5, .6, .7) here, whatever the light.
        assert not red[..., 1:3].any()


def test_e28_the_map_is_the_kernels_and_not_a_cubics() -> None:
    u = np.linspace(0.0, 1.0, 1001)
    cubic = 0.4 * (2.0 * u**3 - 3.0 * u**2 + 1.0)
    np.testing.assert_allclose(cubic, 0.4 * hermite(1.0, 0.0, u), atol=1e-15)
    for footprint, gap in (
        (profile(u**2), 0.0128),
        (chord(u**2) / chord(0.0), 0.073),
    ):
        assert footprint[0] == 1.0, "a ball on its axis is as opaque as its depth says"
        off = np.abs(footprint - cubic / 0.4).max()
        assert off == pytest.approx(gap, abs=5e-4)
    # The term of the tangent: u^3 - u^2 starts flat, the printed u^3 - u does not.
    right, printed = np.diff(u**3 - u**2)[0], np.diff(u**3 - u)[0]
    assert abs(right / u[1]) < 2e-3
    assert abs(printed / u[1] + 1.0) < 2e-3
