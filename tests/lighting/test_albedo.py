"""No light from nothing: what a cloud shows of its own carries the albedo."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_scenes import BALLS, EYE, LOOKS, MEDIUM, SUNS, drawn
from twins.lighting import clouds, colours, suns_of

from refcloud import render
from refcloud.lighting import eyeward, lit_by_solution, solved_light
from refcloud.lighting.octave_march import octave_march
from refcloud.lighting.octaves import Octaves
from refcloud.metaballs import Metaballs, sampled_map
from refcloud.optics import Medium

every_look = pytest.mark.parametrize("look", LOOKS)
BEHIND = np.array([0.25, 0.5, 1.0])
SKYLIT = {"sky_light": np.array([1, 2, 3.0]), "ground_light": np.array([2, 1, 0.5])}
some = settings(max_examples=25)


def rules_of(look: str):
    """Both looks with light from above and below: the paper's has none of its own."""
    return dataclasses.replace(LOOKS[look], **SKYLIT)


@every_look
@pytest.mark.parametrize("tolerance", [0.0, 1.0 / 255.0])
def test_albedo_zero_is_black_to_the_last_bit(look: str, tolerance: float) -> None:
    how = {"medium": Medium(1.5, 0.0), "look": rules_of(look), "tolerance": tolerance}
    assert not drawn(BALLS, SUNS, **how)[..., :3].any()


@every_look
@some
@given(clouds(4), suns_of(), st.floats(0.1, 5.0))
def test_albedo_zero_lets_the_background_through(look, balls, suns, sigma_t) -> None:
    how = {"medium": Medium(sigma_t, 0.0), "look": rules_of(look)}
    alpha = drawn(balls, suns, **how)[..., 3:]
    seen = drawn(balls, suns, background=np.broadcast_to(BEHIND, (9, 12, 3)), **how)
    # One product a ball against one sum a ball: a last bit each.
    np.testing.assert_allclose(seen[..., :3], (1.0 - alpha) * BEHIND, atol=1e-14)


@every_look
@some
@given(clouds(4), suns_of(), colours, colours)
def test_radiance_never_falls_with_the_albedo(look, balls, suns, one, other) -> None:
    low, high = np.minimum(one, other), np.maximum(one, other)
    dark, bright = (
        drawn(balls, suns, medium=Medium(1.5, albedo, g=0.4, phase="hg"), look=rules)
        for rules in (rules_of(look),)
        for albedo in (np.minimum(low, 1.0), np.minimum(high, 1.0))
    )
    assert (bright[..., :3] >= dark[..., :3] - 1e-12 * (1.0 + dark[..., :3])).all()
    np.testing.assert_array_equal(bright[..., 3], dark[..., 3])


@pytest.mark.parametrize("method", ["splat", "march"])
@pytest.mark.parametrize("scattering", ["single", "multiple"])
def test_black_balls_before_a_background(method: str, scattering: str) -> None:
    balls = Metaballs([[0, 0, 0], [0.8, 0.3, 0.1]], [1.0, 0.7], [1.0, 2.0])
    how = {"camera": EYE, "suns": SUNS, "medium": Medium(1.5, 0.0)}
    how |= {"method": method, "scattering": scattering}
    clear = render(balls, background="transparent", **how)
    assert clear.alpha is not None
    assert not clear.linear.any()
    seen = render(balls, background=BEHIND, **how).linear
    through = (1.0 - clear.alpha)[..., None]
    np.testing.assert_allclose(seen, through * BEHIND, rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("method", ["splat", "march"])
@pytest.mark.parametrize("scattering", ["single", "multiple"])
def test_balls_of_more_albedo_are_brighter(method: str, scattering: str) -> None:
    balls = Metaballs([[0, 0, 0], [0.8, 0.3, 0.1]], [1.0, 0.7], [1.0, 2.0])
    how = {"camera": EYE, "suns": SUNS, "background": [0, 0, 0]}
    how |= {"method": method, "scattering": scattering}
    seen = [
        render(balls, medium=Medium(1.5, albedo), **how).linear
        for albedo in (0.0, 1e-9, 0.3, 0.7, 0.97, 1.0)
    ]
    assert (np.diff(seen, axis=0) >= -1e-12).all()
    assert seen[-1].max() > seen[0].max()


def test_solved_light_has_the_albedo_once() -> None:
    # The scaled medium that lights the balls scatters all: the solver took the albedo.
    light = solved_light(BALLS, SUNS, medium=MEDIUM, look=LOOKS["cumulus"])
    lit = lit_by_solution(BALLS, light, eye=EYE.eye, look=LOOKS["cumulus"])
    assert lit.ambient.any()
    np.testing.assert_array_equal(lit.medium.albedo_rgb, 1.0)
    # Of a dark cloud what was scattered once is the albedo, not its square.
    shown = []
    for albedo in (1e-3, 1e-4):
        light = solved_light(BALLS, (), medium=Medium(1.5, albedo))
        lit = lit_by_solution(BALLS, light, eye=EYE.eye, look=LOOKS["cumulus"])
        shown.append(eyeward(lit, EYE)[0][..., :3].sum())
    assert shown[0] / shown[1] == pytest.approx(10.0, rel=0.01)


def test_octaves_of_albedo_zero_are_black() -> None:
    grid = sampled_map(BALLS)
    how = {"suns": SUNS, "medium": Medium(1.5, 0.0, 0.4, "hg"), "step": 0.3}
    light, through, _ = octave_march(grid, EYE, octaves=Octaves(), **how)
    assert not light.any()
    assert (through < 1.0).any()
