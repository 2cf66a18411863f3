"""Skies: never negative, without a step at the horizon, aglow around the suns alone."""

from __future__ import annotations

import dataclasses
import tracemalloc

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.sky import colours, drawn_sky, drawn_suns, sides

from refcloud.camera import Camera, rays
from refcloud.optics import Sun
from refcloud.sky import Sky, clear_sky, printed_gradient, sky_gradient

skies = st.composite(drawn_sky)()
suns = st.composite(drawn_suns)()
AHEAD = Camera([0, 0, 0], [0, 0.1, -1], width=16, height=12)


@given(skies, suns)
def test_a_sky_is_finite_and_never_negative(sky, lights) -> None:
    picture = clear_sky(AHEAD, sky, suns=lights)
    assert picture.shape == (12, 16, 3)
    assert np.isfinite(picture).all()
    assert picture.min() >= 0.0


@given(skies)
def test_without_glow_a_sky_stays_between_its_colours(sky) -> None:
    quiet = dataclasses.replace(sky, glow=0.0)
    palette = np.array([sky.zenith, sky.horizon, sky.haze])
    picture = clear_sky(AHEAD, quiet)
    assert (picture >= palette.min(axis=0) - 1e-15).all()
    assert (picture <= palette.max(axis=0) + 1e-15).all()


@given(skies, st.floats(-0.5, 0.5))
def test_a_sky_has_no_step_anywhere(sky, slope: float) -> None:
    height = 64
    camera = Camera([0, 0, 0], [0, slope, -1], fov_y=1e-4, width=1, height=height)
    quiet = dataclasses.replace(sky, glow=0.0)
    _, directions = rays(camera)
    y = directions[:, 0, 1]
    change = np.abs(np.diff(clear_sky(camera, quiet)[:, 0], axis=0)).max()
    # The haze hides the steep start of y^bend; from there on the slope is bounded by
    # the colours' range (2) over the haze's height, plus bend y^(bend - 1) (1 - low).
    steepest = 2.0 / sky.haze_height + 2.0 * max(sky.bend, 1.0) / sky.haze_height
    assert change <= steepest * np.abs(np.diff(y)).max() + 1e-15


def test_ends_of_the_default_sky() -> None:
    sky = Sky()
    up = Camera([0, 0, 0], [0, 1, 0], fov_y=1e-6, width=1, height=1)
    down = Camera([0, 0, 0], [0, -1, 0], fov_y=1.0, width=2, height=2)
    np.testing.assert_allclose(clear_sky(up)[0, 0], sky.zenith, rtol=1e-4)
    assert (clear_sky(down) == sky.haze).all(), "below the horizon all is haze"


def test_the_default_sky_looks_like_one() -> None:
    camera = Camera([0, 0, 0], [0, 0.5, -1], fov_y=1.0, width=1, height=32)
    red, green, blue = clear_sky(camera)[:, 0].T
    assert (red < green).all()
    assert (green < blue).all()
    assert (np.diff(red) > 0.0).all(), "paler toward the horizon"


@given(skies, suns)
def test_glow_only_adds_and_most_near_its_sun(sky, lights) -> None:
    quiet = clear_sky(AHEAD, dataclasses.replace(sky, glow=0.0))
    added = clear_sky(AHEAD, dataclasses.replace(sky, glow=0.1), suns=lights) - quiet
    assert added.min() >= 0.0
    if len(lights) != 1 or not lights[0].irradiance.any() or sky.glow_g < 0.01:
        return
    _, directions = rays(AHEAD)
    near = (directions @ lights[0].direction).ravel()
    brightness = added.sum(axis=-1).ravel()
    order = np.argsort(near)
    # Subtracting the quiet sky leaves its last bits.
    assert (np.diff(brightness[order]) >= -1e-14).all()


def test_a_narrow_glow_is_gone_ten_degrees_away() -> None:
    sky = Sky(glow=0.01, glow_g=0.99)
    camera = Camera([0, 0, 0], [0, 0.5, -1], fov_y=0.6, width=1, height=61)
    _, directions = rays(camera)
    sun = Sun(directions[30, 0])
    added = (clear_sky(camera, sky, suns=(sun,)) - clear_sky(camera, Sky()))[:, 0, 0]
    away = np.degrees(np.arccos(np.clip(directions[:, 0] @ sun.direction, -1, 1)))
    assert np.argmax(added) == 30
    assert added[away > 10.0].max() < 1e-3 * added[30]


def test_dark_suns_and_glow_0_add_nothing() -> None:
    dark, bright = Sun([0, 0, -1], np.zeros(3)), Sun([0, 0, -1])
    quiet = clear_sky(AHEAD)
    assert (clear_sky(AHEAD, Sky(glow=1.0), suns=(dark,)) == quiet).all()
    assert (clear_sky(AHEAD, Sky(glow=0.0), suns=(bright,)) == quiet).all()


@given(colours, colours, sides, sides)
def test_a_gradient_is_even_and_ends_half_a_row_inside(top, bottom, width, height):
    picture = sky_gradient(top, bottom, width=width, height=height)
    assert picture.shape == (height, width, 3)
    assert (picture == picture[:, :1]).all()
    step = np.subtract(bottom, top) / height
    np.testing.assert_allclose(picture[0, 0], top + 0.5 * step, atol=1e-15)
    np.testing.assert_allclose(picture[-1, 0], bottom - 0.5 * step, atol=1e-15)
    np.testing.assert_allclose(
        np.diff(picture, axis=0), step + 0 * picture[1:], atol=1e-15
    )


def test_e34_the_printed_sky_is_nearly_black() -> None:
    picture = printed_gradient(width=2, height=1000)
    assert (picture[..., :2] == 0.0).all(), "red and green are below 0 everywhere"
    blue = picture[:, 0, 2]
    assert blue[0] == pytest.approx(0.05, abs=2e-4)
    assert blue[-1] == pytest.approx(0.25, abs=2e-4)
    assert (np.diff(blue) > 0.0).all()


@pytest.mark.parametrize(
    "paint",
    [
        lambda **size: sky_gradient([1, 1, 1], [0, 0, 0], **size),
        printed_gradient,
    ],
)
def test_a_picture_too_large_is_refused_before_memory_is_taken(paint) -> None:
    tracemalloc.start()
    with pytest.raises(
        ValueError,
        match=r"^width: expected at most 8.3 megapixels with the height, got",
    ):
        paint(width=10**6, height=10**6)
    assert tracemalloc.get_traced_memory()[1] < 1e7
    tracemalloc.stop()


@pytest.mark.parametrize(
    ("given_", "name"),
    [
        ({"zenith": [-1, 0, 0]}, "zenith"),
        ({"bend": 0.0}, "bend"),
        ({"haze_height": 0.0}, "haze_height"),
        ({"glow": -1.0}, "glow"),
        ({"glow_g": 1.0}, "glow_g"),
    ],
)
def test_skies_refuse_by_name(given_, name: str) -> None:
    with pytest.raises(ValueError, match=rf"^{name}: expected [^\n]*$"):
        Sky(**given_)
