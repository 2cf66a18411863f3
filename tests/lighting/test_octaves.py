"""Octaves of scattering: laws that hold of the guess, and the march of what shines."""

from __future__ import annotations

import dataclasses
import importlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_marches import BLOB, EYE, SUN, relative_error
from twins.camera import drawn_camera
from twins.cloudmap import grids
from twins.noise import seeds
from twins.octaves import cosines, means, models

from refcloud.camera import Camera, rays
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Skipped
from refcloud.lighting import (
    SINGLE,
    Octaves,
    march_shining,
    octave_lobe,
    octave_march,
    octave_source,
    sky_source,
)
from refcloud.march import integrate
from refcloud.optics import Medium, Sun, henyey_greenstein

MEDIUM = Medium(4.0, 0.9, 0.5, "hg")
HOW = {"medium": MEDIUM, "octaves": Octaves(), "step": 0.1}
depths = st.floats(0.0, 100.0)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(400)


@settings(max_examples=40)
@given(models(), means, st.integers(0, 15))
def test_lobes_of_every_octave_send_what_they_get(octaves, g, n) -> None:
    whole = 2.0 * np.pi * (WEIGHTS * octave_lobe(NODES, n, g=g, octaves=octaves)).sum()
    assert whole == pytest.approx(1.0, abs=1e-9)


@settings(max_examples=40)
@given(cosines, means, st.floats(0.0, 1.0), depths)
def test_one_octave_is_single_scattering(cosine, g, albedo, tau) -> None:
    found = octave_source([cosine], [tau], g=g, albedo=albedo, octaves=SINGLE)
    expected = albedo * henyey_greenstein([cosine], g) * np.exp(-tau)
    np.testing.assert_allclose(found, expected, rtol=1e-13)


@settings(max_examples=40)
@given(models(), cosines, means, st.floats(0.0, 1.0), depths, st.floats(0.0, 5.0))
def test_light_falls_with_depth_and_grows_with_octaves(
    octaves, cosine, g, albedo, tau, more
) -> None:
    how = {"g": g, "albedo": albedo, "octaves": octaves}
    here, deeper = octave_source([cosine], [tau, tau + more], **how)
    assert 0.0 <= deeper <= here * (1.0 + 1e-12)
    another = dataclasses.replace(octaves, orders=octaves.orders + 1)
    assert octave_source([cosine], [tau], **(how | {"octaves": another}))[0] >= here


@settings(max_examples=40)
@given(models(), means)
def test_thin_media_send_the_sum_of_all_octaves(octaves, g) -> None:
    # Over the sphere every lobe sends 1: together 1 + b + b^2 + ..., as stated.
    source = octave_source(NODES, [0.0], g=g, albedo=1.0, octaves=octaves)
    whole = 2.0 * np.pi * (WEIGHTS * source).sum()
    expected = (octaves.contribution ** np.arange(octaves.orders)).sum()
    assert whole == pytest.approx(expected, rel=1e-9)


@settings(max_examples=40)
@given(models(), depths, depths)
def test_sky_and_ground_light_each_their_side(octaves, above, below) -> None:
    both = sky_source([above], [below], octaves=octaves)
    dark = np.zeros(3)
    sky, ground = (
        sky_source([above], [below], octaves=dataclasses.replace(octaves, **off))
        for off in ({"ground_light": dark}, {"sky_light": dark})
    )
    np.testing.assert_allclose(both, sky + ground, rtol=1e-14)
    assert (both <= octaves.sky_light + octaves.ground_light).all()


# Two ways to draw it. The light volume of 14^3 voxels and straight lines between its
# values are what they differ by: worst seen .025 and .0008, times 1.5.
@pytest.mark.parametrize("g", [0.0, 0.5])
@pytest.mark.parametrize(("sigma_t", "most"), [(1.0, 0.015), (4.0, 0.04)])
def test_one_octave_marched_is_the_exact_integral(g, sigma_t, most) -> None:
    medium = Medium(sigma_t, 0.9, g, "hg")
    camera = dataclasses.replace(EYE, width=24, height=18)
    L, T = integrate(BLOB, *rays(camera), suns=SUN, medium=medium)
    found, through, _ = octave_march(
        BLOB, camera, suns=(SUN,), medium=medium, octaves=SINGLE, step=0.05
    )
    assert relative_error(found, L) <= most
    assert relative_error(through, T) <= 0.0012


def test_suns_add_up_and_none_leaves_the_sky() -> None:
    other = Sun([0.3, 0.2, -1.0], [3.0, 2.0, 1.0])
    both, one, two, none = (
        octave_march(BLOB, EYE, suns=suns, **HOW)[0]
        for suns in ((SUN, other), (SUN,), (other,), ())
    )
    np.testing.assert_allclose(both + none, one + two, rtol=0.0, atol=1e-13)
    black = dataclasses.replace(
        Octaves(), sky_light=np.zeros(3), ground_light=np.zeros(3)
    )
    assert not octave_march(BLOB, EYE, suns=(), **(HOW | {"octaves": black}))[0].any()
    dark = dataclasses.replace(MEDIUM, albedo=0.0)
    assert not octave_march(BLOB, EYE, suns=(SUN,), **(HOW | {"medium": dark}))[0].any()


def test_albedo_by_channel_is_three_albedos() -> None:
    whole = octave_march(
        BLOB,
        EYE,
        suns=(SUN,),
        **(HOW | {"medium": Medium(4, [0.9, 0.5, 0.1], 0.5, "hg")}),
    )[0]
    for channel, albedo in enumerate((0.9, 0.5, 0.1)):
        medium = Medium(4.0, albedo, 0.5, "hg")
        one = octave_march(BLOB, EYE, suns=(SUN,), **(HOW | {"medium": medium}))[0]
        np.testing.assert_array_equal(whole[..., channel], one[..., channel])


@settings(max_examples=30)
@given(st.data(), grids(), st.floats(0.1, 3.0), st.floats(0.1, 1.0), seeds)
def test_white_places_before_white_are_white(data, grid, sigma_t, step, seed) -> None:
    camera = drawn_camera(data.draw)
    white = np.ones((*grid.density.shape, 3))
    how = {"sigma_t": sigma_t, "step": step, "seed": seed}
    light, T = march_shining(grid, white, camera, **how)
    np.testing.assert_allclose(light + T[..., None], 1.0, rtol=0.0, atol=1e-12)
    assert T.min() >= 0.0
    assert light.min() >= 0.0


@settings(max_examples=20)
@given(st.floats(0.01, 0.9))
def test_what_lies_behind_an_opaque_front_is_bounded(least) -> None:
    colors = np.full((*BLOB.density.shape, 3), 2.0)
    how = {"sigma_t": 9.0, "step": 0.1}
    whole, T = march_shining(BLOB, colors, EYE, **how)
    cut, through = march_shining(BLOB, colors, EYE, least=least, **how)
    assert 0.0 <= (whole - cut).min() + 1e-13
    assert np.abs(whole - cut).max() <= 2.0 * least + 1e-13
    assert np.abs(through - T).max() <= least + 1e-13


@settings(max_examples=10)
@given(st.floats(1e-4, 0.5), seeds)
def test_savings_stay_within_the_tolerance(tolerance, seed) -> None:
    behind = np.linspace(0.0, 1.0, 9 * 12 * 3).reshape(9, 12, 3)
    pictures = []
    for allowed in (0.0, tolerance):
        L, T, _ = octave_march(
            BLOB, EYE, suns=(SUN,), tolerance=allowed, seed=seed, **HOW
        )
        pictures.append(L + T[..., None] * behind)
    assert np.abs(pictures[0] - pictures[1]).max() <= tolerance


def test_single_precision_is_a_saving_that_is_close() -> None:
    colors = np.ones((*BLOB.density.shape, 3)) * np.linspace(0.0, 1.0, 13)[:, None]
    exact, close = (
        march_shining(BLOB, colors, EYE, sigma_t=4.0, step=0.05, dtype=dtype)
        for dtype in ("float64", "float32")
    )
    for one, other in zip(exact, close, strict=True):
        # Worst seen 1.5e-6, times 4.
        np.testing.assert_allclose(other, one, rtol=0.0, atol=6e-6)
        assert (other != one).any()


def test_skipped_rows_say_what_was_left_out() -> None:
    rows = octave_march(BLOB, EYE, suns=(SUN,), tolerance=0.5, **HOW)[2]
    empty, ended, rounded = rows
    assert isinstance(empty, Skipped)
    assert (ended.how, rounded.how) == ("proved", "measured")
    assert 0 < empty.skipped < empty.of
    assert 0 < ended.skipped < ended.of
    # No ray that goes on behind an opaque front can find more than that.
    L = octave_march(BLOB, EYE, suns=(SUN,), **HOW)[0]
    M = octave_march(BLOB, EYE, suns=(SUN,), tolerance=0.5, **HOW)[0]
    assert np.abs(L - M).max() <= ended.bound


def test_chunks_do_not_show(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = octave_march(BLOB, EYE, suns=(SUN,), **HOW)[0]
    for name in ("shining", "octave_march"):
        module = importlib.import_module(f"refcloud.lighting.{name}")
        monkeypatch.setattr(module, "CHUNK", 7)
    parts = octave_march(BLOB, EYE, suns=(SUN,), **HOW)[0]
    np.testing.assert_array_equal(parts, whole)


def test_an_eye_inside_sees_what_is_before_it_alone() -> None:
    inside = Camera([0.1, 0.2, 0.15], [1, 0, 0], fov_y=2.0, width=8, height=6)
    exact = integrate(BLOB, *rays(inside), suns=SUN, medium=MEDIUM)[1]
    found = octave_march(BLOB, inside, suns=(SUN,), **HOW)[1]
    np.testing.assert_allclose(found, exact, rtol=0.0, atol=0.08)
    away = Camera([3, 0, 0], [9, 0, 0], width=4, height=3)
    L, T, _ = octave_march(BLOB, away, suns=(SUN,), **HOW)
    assert not L.any()
    assert (T == 1.0).all()


def test_an_empty_grid_and_one_voxel() -> None:
    nothing = VoxelGrid(np.zeros((1, 1, 1)), [-1, -1, -1], [1, 1, 1])
    L, T, _ = octave_march(nothing, EYE, suns=(SUN,), **HOW)
    assert not L.any()
    assert (T == 1.0).all()
    block = VoxelGrid(np.ones((1, 1, 1)), [-1, -1, -1], [1, 1, 1])
    front = Camera([0, 0, 1e6], [0, 0, 0], fov_y=1e-6, width=1, height=1)
    T = octave_march(block, front, suns=(), **(HOW | {"step": 0.01}))[1]
    assert T[0, 0] == pytest.approx(np.exp(-8.0), rel=0.05)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"medium": Medium([1, 2, 3], phase="hg")}, "sigma_t: expected one number"),
        ({"medium": Medium(1.0)}, "phase: expected 'hg' or 'isotropic'"),
        ({"step": 0.0}, "step: expected a finite number"),
        ({"step": 1e-9}, "step: expected at least"),
        ({"tolerance": 2.0}, "tolerance: expected a finite number"),
    ],
)
def test_refusals_name_the_argument_in_one_line(change, message: str) -> None:
    with pytest.raises(ValueError, match=rf"^{message}[^\n]*$"):
        octave_march(BLOB, EYE, suns=(SUN,), **(HOW | change))


def test_a_grid_of_too_many_cells_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    module = importlib.import_module("refcloud.lighting.shining")
    monkeypatch.setattr(module, "MOST_CELLS", 100)
    with pytest.raises(
        ValueError, match=r"^grid: expected at most 100 cells, got 2184"
    ):
        octave_march(BLOB, EYE, suns=(SUN,), **HOW)


def test_far_away_boxes_look_the_same() -> None:
    move = np.array([1e6, -2e6, 5e5])
    away = VoxelGrid(BLOB.density, BLOB.lower + move, BLOB.upper + move)
    eye = Camera(EYE.eye + move, EYE.target + move, width=12, height=9)
    here, there = (
        octave_march(*c, suns=(SUN,), **HOW)[0] for c in ((BLOB, EYE), (away, eye))
    )
    # A place knows itself to 2e-10 there, and a cell is 0.15.
    np.testing.assert_allclose(there, here, rtol=0.0, atol=1e-7)


def test_refusals_of_the_model() -> None:
    with pytest.raises(ValueError, match=r"^orders: expected a whole number"):
        Octaves(0)
    with pytest.raises(ValueError, match=r"^contribution: expected a finite"):
        Octaves(contribution=1.5)
