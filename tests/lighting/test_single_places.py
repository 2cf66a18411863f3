"""Balls shaded place by place in single precision: off by no more than is told."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_scenes import EXTENDED, EYE, LOOKS, MEDIUM, SUNS
from twins.lighting import colours, media, scattered_balls, seeds, suns_of

from refcloud.camera import Camera
from refcloud.lighting import Haze, LitMetaballs, Look, eyeward, sunward
from refcloud.lighting.exact_places import ExactPlaces
from refcloud.lighting.flat_tiles import Drawn, flat_balls
from refcloud.lighting.fronts import fill, half_width, hull_of
from refcloud.lighting.seen import seen_by, shading_of
from refcloud.lighting.shaded_tiles import shaded_tiles
from refcloud.lighting.shading import FRONT
from refcloud.lighting.single_places import (
    COLOR,
    ROUNDING,
    SinglePlaces,
    weight_doubt,
)
from refcloud.raster.tile_lists import parts

WIDE = Camera(EYE.eye, EYE.target, width=40, height=30)
LAST = 1e-13  # bits of the order in which exact and single places are summed
# Every way to shade: with noise or without, with the light as a field or without.
shaded_looks = st.builds(
    lambda law, name, erosion, relief, reach: dataclasses.replace(
        EXTENDED,
        transmittance=law,
        footprint=name,
        erosion=erosion,
        relief=relief,
        light_reach=reach,
    ),
    st.sampled_from(["beer", "linear"]),
    st.sampled_from(["chord", "profile"]),
    st.sampled_from([0.0, 0.2, 0.42, 0.9, 0.999]),
    st.sampled_from([0.0, 0.57, 1.0]),
    st.sampled_from([0.0, 1.15]),
)
hazes = st.none() | st.builds(Haze, colours, st.floats(1.0, 50.0))


def both(
    lit: LitMetaballs, haze: Haze | None, least: float = 0.0
) -> tuple[Drawn, Drawn, float]:
    """Draw in double and in single precision; give the brightest colour too."""
    seen, _ = seen_by(lit, WIDE, haze)
    tables = [shading_of(seen, 0, None, single=single)[0] for single in (False, True)]
    drawn = seen.order[seen.shown[seen.order]]
    flat = flat_balls(seen, drawn)
    (lists,) = parts(flat.discs, WIDE.width, WIDE.height)
    exact, single = (
        shaded_tiles(lists, drawn, flat.groups, kind(seen, shading), least)
        for kind, shading in zip((ExactPlaces, SinglePlaces), tables, strict=True)
    )
    return exact, single, max(1.0, seen.brightest())


@settings(max_examples=40)
@given(
    seeds,
    st.integers(1, 40),
    st.sampled_from(["wyvill", "gaussian"]),
    st.floats(-2.0, 2.0),
    suns_of(2),
    media,
    shaded_looks,
    hazes,
)
def test_rounding_changes_no_more_than_is_summed(
    seed, count, kernel, depth, suns, medium, look, haze
) -> None:
    balls = scattered_balls(seed, count)
    balls = dataclasses.replace(
        balls, kernel=kernel, densities=10.0**depth * balls.densities
    )
    lit = sunward(balls, suns, medium=medium, look=look)
    exact, single, brightest = both(lit, haze)
    most = brightest * (single.doubt + COLOR * ROUNDING)
    assert np.abs(exact.light - single.light).max() <= most + LAST * brightest
    assert np.abs(exact.clear - single.clear).max() <= single.doubt + LAST
    assert exact.doubt == 0.0


def test_the_bound_is_no_idle_one() -> None:
    """It is small enough to serve, and errors are of its order, not of float64's."""
    lit = sunward(scattered_balls(3, 60), SUNS, medium=MEDIUM, look=EXTENDED)
    exact, single, brightest = both(lit, None)
    off = np.abs(exact.light - single.light).max()
    most = brightest * (single.doubt + COLOR * ROUNDING)
    assert 1e-9 < off < most < 1e-3
    assert weight_doubt(0.0) < weight_doubt(0.42) < weight_doubt(0.9) < 1e-4


@pytest.mark.parametrize("over", [False, True])
def test_a_complete_pixel_gets_the_middle_of_what_can_be_behind(over: bool) -> None:
    clear = np.array([[[0.5, 1e-3, 4e-4]]])
    found = Drawn(np.zeros((1, 3, 3)), clear.copy(), np.zeros(1, np.intp))
    low, high = np.array([0.1, 0.2, 0.3]), np.array([1.1, 0.6, 0.9])
    fill(found, [[0, 1, 2]], 1e-3, low, high, over)
    assert half_width(low, high, over) == pytest.approx(0.5)
    # Whatever stands behind, from the lowest to the highest, none is off by more.
    complete = clear[0, :, 1:]
    for behind in (low, high):
        left = found.clear[0, :, 1:] * (behind[:, None] if over else 0.0)
        off = np.abs(found.light[0, :, 1:] + left - complete * behind[:, None])
        assert (off <= 0.5 * complete * (1.0 + 1e-12)).all()
    assert found.clear[0, 0, 0] == 0.5, "an open pixel stays as it is"
    np.testing.assert_allclose(
        found.clear[0, 0, 1:], 0.0 if over else 0.5 * clear[0, 0, 1:]
    )


@settings(max_examples=25)
@given(seeds, suns_of(2), shaded_looks, hazes, st.floats(-4.0, -0.5))
def test_no_place_shows_a_colour_outside_the_hull(
    seed, suns, look, haze, power
) -> None:
    lit = sunward(scattered_balls(seed, 12), suns, medium=MEDIUM, look=look)
    seen, _ = seen_by(lit, WIDE, haze)
    background = np.full((30, 40, 3), 10.0**power)
    low, high = hull_of(seen, background)
    picture, _ = eyeward(lit, WIDE, background=background, haze=haze)
    scale = 1e-12 * (1.0 + high)
    assert (picture[..., :3] >= low - scale).all()
    assert (picture[..., :3] <= high + scale).all()


@pytest.mark.parametrize("look", LOOKS.values(), ids=LOOKS)
def test_an_empty_cloud_has_a_hull(look: Look) -> None:
    nothing = dataclasses.replace(
        scattered_balls(1, 1), centers=np.zeros((0, 3)), radii=[], densities=[]
    )
    seen, _ = seen_by(sunward(nothing, SUNS, medium=MEDIUM, look=look), WIDE, None)
    low, high = hull_of(seen, None)
    assert not low.any()
    assert not high.any()


@settings(max_examples=25)
@given(seeds, st.integers(1, 12), suns_of(2), st.floats(-1.0, 1.0))
def test_the_table_is_made_wherever_a_ball_looks(seed, count, suns, size) -> None:
    """Cubes of the box that are left out hold 0: a look there would show."""
    balls = scattered_balls(seed, count)
    balls = dataclasses.replace(balls, radii=10.0 ** (0.3 * size) * balls.radii)
    lit = sunward(balls, suns, medium=MEDIUM, look=EXTENDED)
    seen, _ = seen_by(lit, WIDE, None)
    if not seen.shown.any():
        return
    exact, rows = shading_of(seen, seed, None)
    single, same = shading_of(seen, seed, None, single=True)
    assert exact.detail is not None
    assert single.single is not None
    assert rows == same
    values = single.single.values
    np.testing.assert_array_equal(single.single.lower, exact.detail.lower)
    assert values.shape == exact.detail.density.shape
    made = values != 0.0
    off = np.abs(values - exact.detail.density)[made]
    assert off.max() <= 0.5 * ROUNDING + 1e-12, "the same noise, rounded once"
    # Places of pixels, and a step toward each sun: all cells around them are made.
    angle = np.linspace(0.0, 2.0 * np.pi, 24)[:, None]
    q = np.linspace(0.0, 1.0, 9)
    right, up = np.sqrt(q) * np.cos(angle), np.sqrt(q) * np.sin(angle)
    back = np.broadcast_to(FRONT * np.sqrt(1.0 - q), right.shape)
    ways = np.stack([right, up, back], axis=-1).reshape(-1, 3) @ exact.frame
    for k in np.flatnonzero(seen.shown):
        for step in (np.zeros(3), *exact.toward):
            places = balls.centers[k] + balls.radii[k] * ways + step
            cells = (places - single.single.lower) / single.single.spacing - 0.5
            first = np.maximum(np.floor(cells), 0).astype(int)
            for more in np.ndindex(2, 2, 2):
                i, j, m = np.minimum(first + more, np.array(values.shape[::-1]) - 1).T
                assert (made[m, j, i] | (exact.detail.density[m, j, i] < 1e-9)).all()
