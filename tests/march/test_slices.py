"""March by slices: near the exact integral for any camera that it serves."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
from small_marches import relative_error
from smooth_clouds import cloud

from refcloud.camera import Camera, OrthographicCamera, rays
from refcloud.cloudmap import VoxelGrid
from refcloud.march import integrate
from refcloud.march.slices import crossed, march_slices
from refcloud.march.view import view_of
from refcloud.optics import Medium, Sun
from refcloud.transport import sun_depths

SIZE = {"width": 24, "height": 18}
CLOUD, FILLED = cloud(40), cloud(40, (1.2, 0.6, 1.0), filled=True)
SUN = Sun([-0.5, 0.7, 0.4], [3.0, 2.0, 1.0])
GRAY = Medium(6.0, phase="isotropic")
CAMERAS = {
    "front": Camera([1.5, 1.0, 3.2], [0, 0, 0], fov_y=0.53, **SIZE),
    "above": Camera([0.2, 4.0, 0.3], [0, 0, 0], fov_y=0.5, **SIZE),
    "left": Camera([-3.0, -0.4, -0.6], [0, 0.1, 0], fov_y=0.6, **SIZE),
    "diagonal": Camera([2.5, 2.5, -2.5], [0, 0, 0], fov_y=0.4, **SIZE),
    "near": Camera([0.3, -0.3, 1.5], [0, 0, 0], fov_y=0.9, **SIZE),
    "within": Camera([0.1, 0.1, 0.4], [-0.2, 0.0, -1.0], fov_y=0.7, **SIZE),
    "parallel": OrthographicCamera([2, 1, 3], [0, 0, 0], height_of_view=2.2, **SIZE),
    "along an axis": OrthographicCamera(
        [0, 0, 4], [0, 0, 0], height_of_view=2.0, **SIZE
    ),
}
# Worst seen .0056 and .0049 of a picture (the diagonal, and along an axis), times 1.4.
# A voxel holds an optical depth of .3 here, and is 1.25 samples of the image wide.
NEAR, NEARER = 8e-3, 7e-3
EXACT: dict = {}  # pictures that several tests compare with


def both(grid, camera, *, suns=(SUN,), medium=GRAY, scale=1, side=None):
    """March by slices and exactly; the second transmittance by channel as well."""
    depths = [sun_depths(grid, sun.direction, scale=scale) for sun in suns]
    found = march_slices(
        grid, camera, suns=suns, medium=medium, side=side, depths=depths
    )
    assert found is not None
    key = id(grid), id(camera), id(medium), *map(id, suns)
    if key not in EXACT:
        radiance, through = integrate(grid, *rays(camera), suns=suns, medium=medium)
        through = through.reshape(*radiance.shape[:2], -1)
        through = np.broadcast_to(through, radiance.shape)
        # What the key names lives on, so that nothing else takes its place.
        EXACT[key] = radiance, through, (grid, camera, medium, suns)
    return found, EXACT[key][:2]


@pytest.mark.parametrize("name", CAMERAS)
@pytest.mark.parametrize(("scale", "most"), [(1, NEAR), (2, NEARER)])
def test_near_the_exact_integral(name: str, scale: int, most: float) -> None:
    (radiance, through), (expected, clear) = both(CLOUD, CAMERAS[name], scale=scale)
    assert relative_error(radiance, expected) < most
    assert np.abs(through - clear).max() < 0.02


@pytest.mark.slow
@pytest.mark.parametrize("name", ["front", "left", "parallel"])
def test_more_samples_come_nearer(name: str) -> None:
    errors = []
    for side in (24, 48, 96, 192):
        (radiance, _), (expected, _) = both(CLOUD, CAMERAS[name], scale=2, side=side)
        errors.append(relative_error(radiance, expected))
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 6e-4  # worst seen .00037


@pytest.mark.slow
@pytest.mark.parametrize("name", ["front", "left", "within"])
def test_boxes_that_are_filled_to_the_border(name: str) -> None:
    (radiance, through), (expected, clear) = both(FILLED, CAMERAS[name])
    # The picture has edges where the box has them, and the image's samples blur what is
    # left of them when each pixel has its own length in the box. Worst seen .012.
    assert relative_error(radiance, expected) < 0.017
    off = np.abs(through - clear).max(axis=-1)
    assert (off > 0.02).mean() < 0.04  # seen: 12 pixels of 588, along edges
    assert off.max() < 0.3


def test_each_channel_has_its_own_extinction_and_each_sun_its_own_light() -> None:
    suns = SUN, Sun([0.3, -0.2, 1.0], [0.0, 1.0, 4.0]), Sun([0, 1, 0], [0, 0, 0])
    medium = Medium([2.0, 5.0, 2.0], [1.0, 0.9, 0.5], 0.6, "hg")
    for scale in (1, 2):
        (radiance, through), (expected, clear) = both(
            CLOUD, CAMERAS["front"], suns=suns, medium=medium, scale=scale
        )
        for c in range(3):
            assert relative_error(radiance[..., c], expected[..., c]) < NEAR
        assert np.abs(through - clear).max() < 0.02
        assert (through[..., 0] == through[..., 2]).all()


@pytest.mark.parametrize("phase", ["hg", "rayleigh"])
def test_phase_functions_are_those_of_the_pixels(phase) -> None:
    medium = Medium(6.0, 0.9, -0.7, phase)
    for name in ("front", "within", "parallel"):
        (radiance, _), (expected, _) = both(CLOUD, CAMERAS[name], medium=medium)
        assert relative_error(radiance, expected) < NEAR


def test_two_suns_add_up() -> None:
    other = Sun([0.3, -0.2, 1.0], [0.0, 1.0, 4.0])
    one, two, sum_ = (
        march_slices(CLOUD, CAMERAS["front"], suns=suns, medium=GRAY)
        for suns in ((SUN,), (other,), (SUN, other))
    )
    assert one is not None
    assert two is not None
    assert sum_ is not None
    np.testing.assert_allclose(sum_[0], one[0] + two[0], rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("sigma_t", [1e-12, 1e-7, 1e-5])
def test_thin_haze_keeps_its_digits(sigma_t: float) -> None:
    medium = Medium(sigma_t, phase="isotropic")
    (radiance, _), (expected, _) = both(
        CLOUD, CAMERAS["front"], medium=medium, side=160
    )
    # What is left is the image's own error. Worst seen 5e-4.
    assert relative_error(radiance, expected) < 1.5e-3


def test_thick_clouds_stay_finite_and_make_no_light() -> None:
    for sigma_t in (1e3, 1e6, 1e12):
        medium = Medium(sigma_t, phase="isotropic")
        found = march_slices(CLOUD, CAMERAS["front"], suns=(SUN,), medium=medium)
        assert found is not None
        radiance, through = found
        assert (radiance >= 0.0).all()
        assert (radiance <= SUN.irradiance / (4.0 * np.pi) + 1e-6).all()
        assert ((through >= 0.0) & (through <= 1.0)).all()


def test_an_empty_grid_and_one_voxel() -> None:
    empty = VoxelGrid(np.zeros((4, 5, 6)), -np.ones(3), np.ones(3))
    found = march_slices(empty, CAMERAS["front"], suns=(SUN,), medium=GRAY)
    assert found is not None
    assert not found[0].any()
    assert (found[1] == 1.0).all()
    voxel = VoxelGrid(np.full((1, 1, 1), 0.4), -np.ones(3), np.ones(3))
    (_, through), (_, clear) = both(voxel, CAMERAS["front"], side=200)
    # Edges of a cube: one sample of the image is .012 of its width.
    assert np.abs(through - clear).mean() < 2e-3


def test_without_suns_there_is_transmittance() -> None:
    found = march_slices(CLOUD, CAMERAS["front"], suns=(), medium=GRAY)
    assert found is not None
    assert not found[0].any()
    _, clear = integrate(CLOUD, *rays(CAMERAS["front"]), suns=(), medium=GRAY)
    assert np.abs(found[1][..., 0] - clear).max() < 0.02


def test_a_cloud_far_away_and_one_behind_the_eye() -> None:
    far = VoxelGrid(CLOUD.density, CLOUD.lower + 1e6, CLOUD.upper + 1e6)
    camera = CAMERAS["front"]
    moved = Camera(camera.eye + 1e6, camera.target + 1e6, fov_y=0.53, **SIZE)
    here, there = (
        march_slices(grid, eye, suns=(SUN,), medium=GRAY)
        for grid, eye in ((CLOUD, camera), (far, moved))
    )
    assert here is not None
    assert there is not None
    assert relative_error(there[0], here[0]) < 1e-5
    back = Camera(camera.eye, 2.0 * camera.eye, fov_y=0.5, **SIZE)
    found = march_slices(CLOUD, back, suns=(SUN,), medium=GRAY)
    assert found is not None
    assert (found[1] == 1.0).all()


@pytest.mark.parametrize(
    "camera",
    [
        Camera([0, 0, 0.1], [0, 0, -1], fov_y=2.9, **SIZE),  # rays lead both ways
        Camera([0.2, 0.1, 0.9], [0.2, 0.1, 0.0], fov_y=2.6, **SIZE),  # too steep
        OrthographicCamera([0, 0, 0.2], [0.1, 0, -1], height_of_view=2.0, **SIZE),
    ],
)
def test_what_slices_cannot_serve_is_left_to_others(camera) -> None:
    assert march_slices(CLOUD, camera, suns=(SUN,), medium=GRAY) is None


def test_numbers_beyond_single_precision_are_left_to_others() -> None:
    for density, sigma_t in ((1e30, 1e-30), (1e-30, 1e30), (1.0, 1e20)):
        grid = VoxelGrid(density * CLOUD.density, CLOUD.lower, CLOUD.upper)
        medium = Medium(sigma_t)
        assert march_slices(grid, CAMERAS["front"], suns=(SUN,), medium=medium) is None


def literal(view, grid, depths, sigma_t):
    """Cross all slices whole, by tent matrices, in double precision."""
    shear, total, through = view.shear, 0.0, 1.0
    step = shear.step(view.q_v[:, None], view.q_u)
    slices = zip(shear.turned(grid.density), shear.turned(depths.density), strict=True)
    for w, (slab, depth) in enumerate(slices):
        offset, gain = shear.across(np.float64(w))
        B_v, B_u = (
            np.maximum(0.0, 1.0 - np.abs(o + gain * q - np.arange(n)[:, None]))
            for o, q, n in zip(offset, (view.q_v, view.q_u), slab.shape, strict=True)
        )
        alpha = -np.expm1(-sigma_t * (B_v.T @ slab @ B_u) * step)
        total = total + through * alpha * (B_v.T @ np.exp(-sigma_t * depth) @ B_u)
        through = through * (1.0 - alpha)
    return total, 1.0 - through


@pytest.mark.parametrize("name", ["front", "above", "left", "parallel"])
def test_the_quick_form_equals_the_literal_one(name: str) -> None:
    view = view_of(CLOUD, CAMERAS[name], 50)
    assert view is not None
    depths = sun_depths(CLOUD, SUN.direction)
    light, hidden = crossed(view, CLOUD, [depths], np.array([6.0]))
    expected = literal(view, CLOUD, depths, 6.0)
    # Single precision against double. Worst seen 3e-5: places 1e-5 of a cell apart.
    np.testing.assert_allclose(light[0, 0], expected[0], rtol=0.0, atol=1e-4)
    np.testing.assert_allclose(hidden[0], expected[1], rtol=0.0, atol=1e-4)


PRINT_BITS = """
import hashlib, sys
sys.path.insert(0, "tests")
sys.path.insert(0, "tests/march")
from test_slices import CAMERAS, CLOUD, GRAY, SUN, march_slices
L, T = march_slices(CLOUD, CAMERAS["front"], suns=(SUN,), medium=GRAY, side=200)
print(hashlib.sha256(L.tobytes() + T.tobytes()).hexdigest())
"""


@pytest.mark.slow
def test_the_same_bits_whatever_the_number_of_threads() -> None:
    bits = {
        subprocess.run(
            [sys.executable, "-c", PRINT_BITS],
            env={**os.environ, "OPENBLAS_NUM_THREADS": n, "OMP_NUM_THREADS": n},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for n in ("1", "2", "4")
    }
    assert len(bits) == 1
