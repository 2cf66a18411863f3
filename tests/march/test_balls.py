"""Metaballs marched: chords in closed form, and the same optical depth as splats."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twins.lighting import scattered_balls, seeds
from twins.march import directions

from refcloud.camera import Camera, OrthographicCamera, rays
from refcloud.cloudmap import VoxelGrid
from refcloud.lighting import Look
from refcloud.march import ball_columns, integrate
from refcloud.march.across import LEAST, MOST_CELLS, across
from refcloud.march.chords import columns_of
from refcloud.march.marched import marched
from refcloud.march.mixing import Mixing
from refcloud.metaballs import Metaballs, axis_depth, field
from refcloud.metaballs.field import field_grid
from refcloud.metaballs.kernels import chord
from refcloud.optics import Medium, Sun
from refcloud.render import render

KERNELS = ["wyvill", "gaussian"]
SUN = Sun([0.3, 0.8, 0.5])
EYE = Camera([0.5, 1.0, 7.0], [0, 0, 0], width=12, height=9)
HAZE = Medium(1.0, phase="isotropic")
SMOOTH = Look(
    erosion=0.0, erosion_depth=1.0, relief=0.0, light_reach=0.0, buffer=8, sky_buffer=8
)


@pytest.mark.parametrize("kernel", KERNELS)
@given(st.floats(0.0, 1.2), st.floats(0.1, 5.0), st.floats(0.01, 3.0))
def test_a_ray_through_a_ball_has_the_splats_optical_depth(kernel, b, R, rho) -> None:
    ball = Metaballs([[1.0, 2.0, 3.0]], [R], [rho], kernel)
    origin = np.array([[1.0 - 7.0 * R, 2.0 + b * R, 3.0]])
    found = ball_columns(ball, origin, [[2.0, 0.0, 0.0]])[0]
    axis = axis_depth(1.0, [rho], [R], kernel)[0]
    expected = axis * chord([b * b], kernel)[0] / chord([0.0], kernel)[0]
    # q is known to 1e-15; a Gaussian's chord ends as its square root, steeply.
    assert found == pytest.approx(expected, rel=1e-9, abs=2e-7 * axis)


@pytest.mark.parametrize("kernel", KERNELS)
@given(st.floats(-0.99, 0.99), st.floats(0.0, 0.9))
def test_a_chord_from_within_is_the_integral_of_the_kernel(kernel, u, b) -> None:
    ball = Metaballs([[0.0, 0.0, 0.0]], [2.0], [1.5], kernel)
    found = ball_columns(ball, [[2.0 * u, 2.0 * b, 0.0]], [[1.0, 0.0, 0.0]])[0]
    ends = np.linspace(2.0 * u, 2.0, 20001)
    middles = 0.5 * (ends[1:] + ends[:-1])
    points = np.stack([middles, np.full(20000, 2.0 * b), np.zeros(20000)], axis=1)
    expected = field(ball, points).sum() * (ends[1] - ends[0])
    assert found == pytest.approx(expected, rel=1e-4, abs=1e-5)


@settings(max_examples=20)
@given(seeds, directions(), st.sampled_from(KERNELS))
def test_radiance_is_the_integral_of_field_and_chords(seed, way, kernel) -> None:
    balls = dataclasses.replace(scattered_balls(seed, 6), kernel=kernel)
    d = np.array(way) / np.linalg.norm(way)
    o = -12.0 * d + np.array([0.3, -0.2, 0.1])
    L, T = integrate(balls, o, d[None], suns=SUN, medium=HAZE)
    steps = 48000
    t = (np.arange(steps) + 0.5) * (24.0 / steps)
    points = o + t[:, None] * d
    rho = field(balls, points) * (24.0 / steps)
    near = np.cumsum(rho) - 0.5 * rho
    far = ball_columns(balls, points, np.broadcast_to(SUN.direction, (steps, 3)))
    expected = (rho * np.exp(-near - far)).sum()
    # Steps of 0.0005 against the jump at a Gaussian ball's rim, exp(-4) of its centre:
    # half a step at both ends of six chords is 6e-5.
    assert L[0, 0] == pytest.approx(expected, rel=2e-3, abs=1e-4)
    assert T[0] == pytest.approx(math.exp(-rho.sum()), rel=2e-3, abs=1e-4)


@settings(max_examples=10)
@given(seeds)
def test_splats_and_march_draw_the_same_optical_depth(seed) -> None:
    """Parallel rays: a splat's footprint is then the chord itself."""
    balls = scattered_balls(seed, 5)
    camera = OrthographicCamera(
        [0, 0, 40], [0, 0, 0], height_of_view=8.0, width=20, height=16
    )
    how = {"camera": camera, "suns": SUN, "medium": Medium(0.7, 0.9)}
    drawn = [
        render(balls, background="transparent", **how, **more).alpha
        for more in ({"look": SMOOTH}, {"method": "march"})
    ]
    np.testing.assert_allclose(drawn[0], drawn[1], rtol=0.0, atol=1e-9)


def test_finer_voxels_of_the_same_balls_look_more_alike() -> None:
    balls = Metaballs([[0, 0, 0], [0.8, 0.3, 0.1]], [1.0, 0.7], [1.0, 2.0])
    camera = Camera([2, 1, 5], [0, 0, 0], width=16, height=12)
    how = {"suns": SUN, "medium": Medium(3.0, 0.9, 0.4, "hg"), "ambient": [0.1] * 3}
    one, _ = integrate(balls, *rays(camera), **how)
    errors = []
    for n in (20, 40):
        x = (np.arange(n) + 0.5) / n * 3.2 - 1.6
        density = field_grid(balls, x, y=x, z=x)
        grid = VoxelGrid(density, np.full(3, -1.6), np.full(3, 1.6))
        two, _ = integrate(grid, *rays(camera), **how)
        errors.append(np.abs(one - two).max())
    # Interpolation rounds tops and rims: measured .026 and .009.
    assert errors[1] < errors[0] / 2.0
    assert errors[1] < 0.02


@pytest.mark.parametrize("kernel", KERNELS)
def test_thick_balls_and_far_eyes_stay_finite(kernel) -> None:
    ball = Metaballs([[0.0, 0.0, 0.0]], [1.0], [1.0], kernel)
    way = [[0.0, 0.0, -1.0]]
    for sigma_t in (1e-7, 1.0, 1e3, 1e6):
        medium = Medium(sigma_t, phase="isotropic")
        L, T = integrate(ball, [0, 0, 9.0], way, suns=Sun([0, 0, 1]), medium=medium)
        tau = axis_depth(sigma_t, [1.0], [1.0], kernel)[0]
        assert T[0] == pytest.approx(math.exp(-tau), rel=1e-9, abs=1e-300)
        if sigma_t <= 10.0:  # light from the eye's side: the integral is known
            assert L[0, 0] == pytest.approx(-math.expm1(-2.0 * tau) / 2.0, rel=1e-6)
        assert 0.0 < L[0, 0] <= 1.0
    near, far = (
        integrate(ball, [0.3, 0, z], way, suns=SUN, medium=HAZE) for z in (5.0, 1e8)
    )
    assert near[0] == pytest.approx(far[0], abs=1e-6)


def sunlit(balls: Metaballs, tolerance: float = 0.0, medium: Medium = HAZE, **light):
    """March a camera's rays by the inner form, which tells what it left out."""
    origins, ways = (part.reshape(-1, 3) for part in rays(EYE))
    how = {"suns": (SUN,), "ambient": None, "mixing": Mixing()} | light
    return marched(balls, origins, ways, medium=medium, tolerance=tolerance, **how)


@settings(max_examples=15)
@given(seeds, directions(), st.sampled_from(KERNELS), st.sampled_from([0.0, 1e6]))
def test_cells_across_a_direction_miss_no_ball(seed, way, kernel, offset) -> None:
    # Radii from a hundredth to twice: cells are of one size, discs are not.
    some = scattered_balls(seed, 40)
    radii = some.radii * np.geomspace(0.01, 2.0, 40)
    balls = Metaballs(some.centers + offset, radii, some.densities, kernel)
    places = np.concatenate(
        [balls.centers, balls.centers + 0.7 * radii[:, None] * np.array([1, -1, 0])]
    )
    d = np.array(way) / np.linalg.norm(way)
    found, pairs = across(balls, d).columns(places)
    assert np.array_equal(found, columns_of(balls, places, d))
    assert 0 < pairs < len(places) * len(balls)


def test_cells_stay_few_however_balls_lie() -> None:
    ends = Metaballs(np.diag([1e9, 1e9, 1e9]), np.array([1e-3, 1.0, 1e3]), np.ones(3))
    huge = Metaballs(np.zeros((9, 3)), np.geomspace(1e-6, 1e6, 9), np.ones(9))
    for balls in (ends, huge):
        cells = across(balls, np.array([0.0, 0.0, 1.0]))
        assert len(cells.first) <= MOST_CELLS * (LEAST + len(balls)) + 1
        assert len(cells.numbers) <= MOST_CELLS * len(balls)
        found, _ = cells.columns(balls.centers)
        assert np.array_equal(found, columns_of(balls, balls.centers, cells.direction))


def test_few_chords_toward_a_sun_are_looked_at() -> None:
    found = sunlit(scattered_balls(3, 120))
    (row,) = found.skipped
    assert (row.what, row.bound) == ("chords toward suns", 0.0)
    assert 2 * row.skipped > row.of
    assert found.notes == ()


@settings(max_examples=15)
@given(
    seeds,
    st.floats(-4.0, -1.0),
    st.floats(0.3, 2.0),
    st.sampled_from([3.0, np.array([9.0, 3.0, 20.0])]),
)
def test_a_tolerance_hides_what_opaque_fronts_hide(seed, digits, k, sigma) -> None:
    balls, tolerance = scattered_balls(seed, 30), 10.0**digits
    medium = Medium(sigma, 0.9, 0.5, "hg")
    mixing = Mixing(light_absorption_through_cloud=k)
    how = {"suns": (SUN, Sun([0, 0, 1])), "medium": medium, "mixing": mixing}
    exact, found = sunlit(balls, **how), sunlit(balls, tolerance, **how)
    assert np.abs(found.radiance - exact.radiance).max() <= tolerance
    assert np.array_equal(found.transmittance, exact.transmittance)
    assert found.notes == (
        "marched balls are exact but for what opaque fronts hide: 30 balls x 108 rays",
    )
    hidden = [row for row in found.skipped if row.bound > 0.0]
    assert all(row.bound == tolerance for row in hidden)


def test_what_opaque_fronts_hide_is_counted() -> None:
    balls = scattered_balls(3, 30)
    for tolerance in (1e-4, 1e-2):
        row, _ = sunlit(balls, tolerance, Medium(30.0)).skipped
        assert row.what == "pieces of rays behind an opaque front"
        assert 0 < row.skipped < row.of
        assert row.bound == tolerance


def test_no_balls_show_what_lies_behind() -> None:
    nothing = Metaballs(np.zeros((0, 3)), [], [])
    L, T = integrate(
        nothing, [0, 0, 1], [[0, 0, 1]], suns=SUN, medium=HAZE, background=[1, 2, 3]
    )
    assert L.tolist() == [[1.0, 2.0, 3.0]]
    assert T.tolist() == [1.0]
    huge = Metaballs([[0.0, 0, 0]], [1e200], [1e200])
    with pytest.raises(ValueError, match=r"^sigma_t: expected an optical depth"):
        integrate(huge, [0, 0, 1], [[0, 0, 1]], suns=SUN, medium=HAZE)
