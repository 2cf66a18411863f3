"""A tolerance is kept: the measured error of generated scenes never exceeds it."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_scenes import BACKDROP, EYE, LOOKS, MEDIUM, SUNS, drawn
from twins.lighting import (
    clouds,
    colours,
    looks,
    media,
    scattered_balls,
    seeds,
    suns_of,
)

from refcloud.camera import Camera
from refcloud.lighting import Haze, Look, eyeward, sunward
from refcloud.metaballs import Metaballs

tolerances = st.floats(-4.0, np.log10(0.3)).map(lambda power: 10.0**power)
ROUNDED = 1e-12  # the two orders of drawing differ by last bits of a few dozen sums
backdrops = st.sampled_from([None, BACKDROP, np.zeros_like(BACKDROP)])
hazes = st.none() | st.builds(Haze, colours, st.floats(1.0, 50.0))


def error_and_rows(balls, suns, medium, look, tolerance, background, haze):
    """Measure what a tolerance changes: the largest error, and the report."""
    lit = sunward(balls, suns, medium=medium, look=look)
    how = {"background": background, "haze": haze}
    exact, _ = eyeward(lit, EYE, **how)
    found, rows = eyeward(lit, EYE, tolerance=tolerance, **how)
    scale = max(1.0, float(np.abs(exact).max()))
    return np.abs(found - exact).max() - ROUNDED * scale, rows


@settings(max_examples=100)
@given(clouds(8), suns_of(), media, looks, tolerances, backdrops, hazes)
def test_the_error_never_exceeds_the_tolerance(
    balls, suns, medium, look, tolerance, background, haze
) -> None:
    error, rows = error_and_rows(balls, suns, medium, look, tolerance, background, haze)
    assert error <= tolerance
    dropped = [row for row in rows if row.stage == "eye" and row.bound > 0.0]
    assert sum(row.bound for row in dropped) <= tolerance


@pytest.mark.parametrize("look", LOOKS.values(), ids=LOOKS)
@settings(max_examples=20)
@given(seeds, tolerances)
def test_nor_in_thick_clouds_of_many_balls(look: Look, seed: int, tolerance) -> None:
    rules = dataclasses.replace(look, tau=None)
    balls = scattered_balls(seed, 24)
    thick = dataclasses.replace(balls, densities=6.0 * balls.densities)
    error, _ = error_and_rows(thick, SUNS, MEDIUM, rules, tolerance, BACKDROP, None)
    assert error <= tolerance


def test_faint_balls_are_left_out_counted_and_bounded() -> None:
    faint = scattered_balls(3, 8)
    densities = np.where(np.arange(8) < 5, 1e-6, 1.0)
    balls = dataclasses.replace(faint, densities=densities)
    lit = sunward(balls, SUNS, medium=MEDIUM, look="cumulus")
    _, rows = eyeward(lit, EYE, background=BACKDROP, tolerance=0.01)
    (row,) = [row for row in rows if "faint" in row.what]
    assert (row.stage, row.skipped, row.of) == ("eye", 5, 8)
    assert 0.0 < row.bound <= 0.01
    _, none = eyeward(lit, EYE, background=BACKDROP)
    assert not [row for row in none if "faint" in row.what]


def test_balls_behind_an_opaque_front_are_left_out_and_counted() -> None:
    # One thick ball before forty small ones; tiles in its middle see it alone.
    small = scattered_balls(3, 40)
    behind = small.centers * 0.2 - [0.0, 0.0, 3.0]
    balls = Metaballs(
        np.vstack([[0, 0, 2], behind]),
        np.append(2.0, np.full(40, 0.3)),
        np.append(1e3, np.ones(40)),
    )
    eye = Camera(EYE.eye, EYE.target, width=96, height=72)
    for look in LOOKS.values():
        rules = dataclasses.replace(look, tau=None, transmittance="beer")
        lit = sunward(balls, SUNS, medium=MEDIUM, look=rules)
        _, rows = eyeward(lit, eye, tolerance=0.01)
        (row,) = [row for row in rows if "opaque" in row.what]
        assert 40 <= row.skipped < row.of
        assert 0.0 < row.bound <= 0.01


def test_the_exact_picture_reports_what_cannot_show() -> None:
    spots = [[0, 0, 0], [99, 0, 0], [0, 0, 50]]  # seen, beside, behind the eye
    balls = Metaballs(spots, np.ones(3), np.ones(3))
    dark = dataclasses.replace(SUNS[0], irradiance=np.zeros(3))
    lit = sunward(balls, (dark, SUNS[1]), medium=MEDIUM, look="man")
    _, rows = eyeward(lit, EYE)
    reported = {(row.stage, row.what): (row.skipped, row.of, row.bound) for row in rows}
    assert reported == {
        ("eye", "balls off the picture"): (2, 3, 0.0),
        ("light", "suns without light"): (1, 2, 0.0),
    }


def test_the_noise_of_footprints_does_not_change_with_the_tolerance() -> None:
    # A faint ball right before the eye has the finest pixels of all: the table of the
    # noise follows them, whether the ball is drawn or not.
    balls = scattered_balls(5, 6)
    near = Metaballs(
        np.vstack([balls.centers, [0.45, 0.9, 6.4]]),
        np.append(balls.radii, 0.2),
        np.append(balls.densities, 1e-9),
    )
    eye = Camera(EYE.eye, EYE.target, width=60, height=45)
    exact = drawn(near, SUNS, camera=eye)
    assert np.abs(drawn(near, SUNS, camera=eye, tolerance=0.01) - exact).max() <= 0.01


WIDE = Camera([0.5, 1.0, 7.0], [0, 0, 0], width=120, height=90)
SMOOTH = dataclasses.replace(
    LOOKS["man"], transmittance="beer", scattering="split", tau=None
)
# Where float32 and nodes serve: balls of one colour each, before a picture of tiles.
smooth_looks = st.builds(
    lambda law, name: dataclasses.replace(SMOOTH, transmittance=law, footprint=name),
    st.sampled_from(["beer", "linear"]),
    st.sampled_from(["chord", "profile"]),
)


@settings(max_examples=20)
@given(
    seeds,
    st.integers(1, 150),
    st.floats(-1.5, 1.0),
    st.floats(-2.0, 2.0),
    smooth_looks,
    media,
    st.floats(-5.3, -0.5).map(lambda power: 10.0**power),
    st.sampled_from([0.0, 1.0, 20.0]),
)
def test_nor_do_float32_and_nodes(
    seed, count, size, depth, look, medium, tolerance, behind
) -> None:
    balls = scattered_balls(seed, count)
    balls = dataclasses.replace(
        balls,
        radii=10.0**size * balls.radii,
        densities=10.0 ** (depth - size) * balls.densities,
    )
    lit = sunward(balls, SUNS, medium=medium, look=look)
    background = np.full((90, 120, 3), behind) if behind else None
    exact, _ = eyeward(lit, WIDE, background=background)
    found, rows = eyeward(lit, WIDE, background=background, tolerance=tolerance)
    assert np.abs(found - exact).max() <= tolerance
    bounds = [row.bound for row in rows if row.stage == "eye"]
    assert sum(bounds) <= tolerance * (1.0 + 1e-9)


def test_each_saving_is_counted_with_its_bound() -> None:
    balls = scattered_balls(2, 60)
    wide = dataclasses.replace(balls, radii=3.0 * balls.radii)
    lit = sunward(wide, SUNS, medium=MEDIUM, look=SMOOTH)
    eye = dataclasses.replace(WIDE, width=240, height=180)
    _, none = eyeward(lit, eye)
    assert not any(row.bound > 1e-12 for row in none)
    rows = {row.what: row for row in eyeward(lit, eye, tolerance=0.02)[1]}
    double = rows["tiles in double precision"]
    assert 0 < double.skipped == double.of
    nodes = rows["pixels between nodes of smooth tiles"]
    samples = rows["pixels between samples of smooth tiles"]
    for row in nodes, samples:
        assert 0 < row.skipped < row.of == double.of * 256
    assert nodes.skipped + samples.skipped < nodes.of
    assert double.bound + nodes.bound + samples.bound < 0.02


def test_pixels_closed_one_by_one_are_told() -> None:
    """Where no tile is hidden whole, its complete pixels still change the picture."""
    balls = Metaballs([[0.0, 0.0, 0.0], [0.0, 0.0, -2.0]], [1.0, 1.0], [9.0, 9.0])
    camera = Camera([0, 0, 9], [0, 0, 0], width=24, height=18)
    lit = sunward(balls, SUNS, medium=MEDIUM, look="cumulus")
    _, rows = eyeward(lit, camera, tolerance=0.1)
    told = [row for row in rows if "behind opaque" in row.what]
    assert len(told) == 1
    assert 0 < told[0].skipped < told[0].of
    assert 0.0 < told[0].bound <= 0.1
