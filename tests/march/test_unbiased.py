"""Light of slices without the bias of linear interpolation."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from small_marches import BLOB, relative_error

from refcloud.camera import Camera, rays
from refcloud.cloudmap import VoxelGrid
from refcloud.march import integrate
from refcloud.march.resample import without_bias
from refcloud.march.slices import march_slices
from refcloud.optics import Medium, Sun

INNER = VoxelGrid(np.pad(BLOB.density, 2), [-1.4, -1.3, -1.4], [1.4, 1.3, 1.4])


@given(st.integers(1, 6), st.integers(1, 6), st.integers(1, 3))
def test_light_that_is_linear_stays_and_none_leaves_its_range(v, u, slices) -> None:
    y, x = np.meshgrid(np.arange(v), np.arange(u), indexing="ij")
    level = np.broadcast_to(0.05 * (x + y), (slices, v, u)).astype(np.float32)
    np.testing.assert_allclose(without_bias(level), level, atol=1e-6)
    edges = np.broadcast_to((x + y) % 2, (slices, v, u)).astype(np.float32)
    found = without_bias(edges)
    assert found.min() >= 0.0
    assert found.max() <= 1.0


def test_the_mean_of_interpolated_light_is_that_of_the_curve() -> None:
    x = np.linspace(0.0, 1.0, 12)
    lit = np.broadcast_to(np.square(x), (1, 12, 12)).astype(np.float32)
    for light, share in ((lit, 1.0), (without_bias(lit), 0.0)):
        row = light[0, 5, 1:-1].astype(float)
        mean = np.trapezoid(row, x[1:-1]) / (x[-2] - x[1])
        truth = (x[-2] ** 3 - x[1] ** 3) / (3.0 * (x[-2] - x[1]))
        # f'' / 12 = 2 h^2 / 12.
        np.testing.assert_allclose(mean - truth, share * x[1] ** 2 / 6.0, atol=1e-6)


def test_a_cloud_before_the_sun_is_nearer_without_the_bias() -> None:
    eye = Camera([1.5, 1.0, 3.2], [0, 0, 0], width=40, height=30)
    sun, medium = Sun([-0.4, -0.1, -1.0]), Medium(2.5, phase="isotropic")
    exact, _ = integrate(INNER, *rays(eye), suns=sun, medium=medium)
    errors = []
    for unbiased in (False, True):
        found = march_slices(
            INNER, eye, suns=(sun,), medium=medium, side=60, unbiased=unbiased
        )
        assert found is not None
        errors.append(relative_error(found[0], exact))
    assert errors[1] < 0.85 * errors[0]
