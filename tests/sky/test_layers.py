"""Fog, cover and lit layers: the laws, the errata, and both ways to the same noise."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refcloud.noise import fbm
from refcloud.sky import (
    SAME_SIGN,
    Cover,
    FlatBase,
    cloud_cover,
    fog_factor,
    fogged,
    fractal_texture,
    light_from_above,
    looked_up,
)

lengths = st.floats(0.0, 30.0)
densities = st.floats(0.0, 2.0)
AT = np.stack(np.meshgrid(np.linspace(0, 3.9, 40), np.linspace(0, 3.9, 40)), axis=-1)
AT = AT.reshape(-1, 2)


@given(lengths, lengths, densities)
def test_fog_of_two_stretches_is_that_of_both(a: float, b: float, density: float):
    one, two, both = fog_factor([a, b, a + b], density=density)
    assert one * two == pytest.approx(both, rel=1e-12)


@given(densities)
def test_fog_hides_what_is_far_and_leaves_what_is_near(density: float) -> None:
    light, color = np.array([[0.9, 0.2, 0.1]] * 2), np.array([0.5, 0.6, 0.7])
    seen = fogged(light, [0.0, 1e6], density=density + 0.01, color=color)
    np.testing.assert_array_equal(seen[0], light[0])
    np.testing.assert_array_equal(seen[1], color)


def test_e29_the_printed_fog_is_thickest_before_the_eye() -> None:
    distance = np.linspace(0.0, 12.0, 60)
    printed = fog_factor(distance, density=6.0, form="printed")
    assert (np.diff(printed) >= 0.0).all()
    assert printed[0] < 0.003, "what is near drowns"
    assert (printed[distance >= 6.0] == 1.0).all(), "what is far is clear"
    mended = fog_factor(distance, density=0.3)
    assert (np.diff(mended) < 0.0).all()
    assert mended[0] == 1.0
    # As printed it passes 1, and would take away the fog's own colour.
    assert np.exp(-(6.0 - distance)).max() > 400.0


@given(st.floats(-0.5, 0.4), st.floats(0.01, 0.5))
def test_a_higher_threshold_leaves_more_open_sky(threshold: float, more: float):
    noise = fbm(AT, seed=3)
    shares = [
        cloud_cover(noise, Cover(threshold=t))[1] for t in (threshold, threshold + more)
    ]
    assert (shares[1] <= shares[0]).all()
    open_sky = [
        np.count_nonzero(cloud_cover(noise, Cover(threshold=t))[1] == 0.0)
        for t in (-0.4, -0.1, 0.1, 0.4)
    ]
    assert open_sky == sorted(set(open_sky)), "more with each"


def test_signs_make_edges_light_or_dark() -> None:
    noise = np.linspace(0.0, 0.5, 50)
    light, opacity = cloud_cover(noise, Cover())
    assert (np.diff(opacity) >= 0.0).all()
    assert (np.diff(light) < 0.0).all(), "opposite signs: light edges"
    light, _ = cloud_cover(noise, SAME_SIGN)
    assert (np.diff(light) > 0.0).all(), "the first try: dark edges"


def test_e37_transparency_read_as_printed_turns_clouds_into_holes() -> None:
    noise = np.array([-0.3, 0.6])  # open sky, and the middle of a cloud
    cover = Cover()
    assert cloud_cover(noise, cover)[1].tolist() == [0.0, 1.0]
    printed = dataclasses.replace(cover, reading="printed")
    assert cloud_cover(noise, printed)[1].tolist() == [1.0, 0.0]


@given(st.floats(0.05, 1.0), st.floats(0.0, 8.0), st.integers(1, 20))
def test_light_through_a_full_layer_has_a_closed_answer(sine, sigma_t, steps) -> None:
    layer = FlatBase(thickness=0.7, sigma_t=sigma_t, steps=steps, slope=3.0)
    sun = [np.sqrt(1.0 - sine * sine), sine, 0.0]
    found = light_from_above([[0.3, 2.0]], lambda p: np.ones(len(p)), layer, sun=sun)
    # Density falls from 1 to 0: the middles of steps add that up exactly.
    assert found[0] == pytest.approx(np.exp(-sigma_t * 0.7 / sine / 2.0), rel=1e-9)


def direct(at: np.ndarray) -> np.ndarray:
    return fbm(at, time=0.4, seed=5, octaves=3, period=4)


def test_clear_sky_takes_no_light_and_more_extinction_takes_more() -> None:
    sun = [0.5, 0.6, 0.2]
    clear = FlatBase(threshold=2.0)
    assert (light_from_above(AT, direct, clear, sun=sun) == 1.0).all()
    thin, thick = (
        light_from_above(AT, direct, FlatBase(sigma_t=s), sun=sun) for s in (2.0, 8.0)
    )
    assert (thick <= thin).all()
    assert thick.min() < 0.5


def test_more_steps_converge() -> None:
    sun = [0.5, 0.6, 0.2]
    found = [
        light_from_above(AT, direct, FlatBase(steps=n), sun=sun) for n in (8, 32, 256)
    ]
    errors = [np.abs(light - found[-1]).max() for light in found[:-1]]
    assert errors[1] < 0.5 * errors[0] < 0.05


def test_a_texture_drawn_before_gives_the_same_light_the_finer_the_nearer() -> None:
    sun, layer = [0.5, 0.6, 0.2], FlatBase()
    exact = light_from_above(AT, direct, layer, sun=sun)
    errors = []
    for size in (32, 64, 128):
        texture, left_out = fractal_texture(size, cells=4, time=0.4, seed=5, octaves=3)
        assert not left_out
        found = light_from_above(
            AT, lambda p, t=texture: looked_up(t, p / 4.0), layer, sun=sun
        )
        errors.append(np.abs(found - exact).max())
    # Linear between texels: the error falls with the square of their size.
    assert errors[2] < 0.4 * errors[1] < 0.16 * errors[0] < 0.16


@pytest.mark.parametrize("y", [0.0, -0.5, 0.01])
def test_a_sun_below_the_layer_is_refused(y: float) -> None:
    with pytest.raises(ValueError, match="sun: expected a direction above the horizon"):
        light_from_above(AT, direct, FlatBase(), sun=[1.0, y, 0.0])


def test_one_distance_for_each_colour() -> None:
    with pytest.raises(ValueError, match="distance: expected shape"):
        fogged(np.ones((2, 3)), [1.0], density=1.0, color=[1, 1, 1])
