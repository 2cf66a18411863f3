"""Rays through the quad are the camera's rays, wherever the quad stands."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from small_marches import BLOB, EYE, MEDIUM, SUN
from twins.camera import drawn_camera

from refcloud.camera import Camera, OrthographicCamera, rays
from refcloud.march import march_by_steps
from refcloud.raster import quad_points


@settings(max_examples=60)
@given(st.data(), st.floats(0.1, 50.0))
def test_r02_rays_through_the_quad_are_the_cameras(data, distance) -> None:
    camera = drawn_camera(data.draw)
    origins, directions = rays(camera)
    points = quad_points(camera, distance)
    if isinstance(camera, OrthographicCamera):  # parallel rays start on a quad
        expected = origins + distance * directions
        np.testing.assert_allclose(points, expected, rtol=0.0, atol=1e-11)
        return
    ways = points - camera.eye
    ways /= np.linalg.norm(ways, axis=-1, keepdims=True)
    # Far places and a near quad: the eye's last bits, over a distance of 0.1.
    np.testing.assert_allclose(ways, directions, rtol=0.0, atol=1e-12)


def test_r02_the_cloud_on_the_quad_is_the_cloud_along_the_rays() -> None:
    how = {"suns": SUN, "medium": MEDIUM, "sample_rate": 6, "sun_sample_rate": 2}
    along_rays = march_by_steps(BLOB, *rays(EYE), **how)
    for distance in (0.3, 4.0):  # before the box, and inside it
        ways = quad_points(EYE, distance) - EYE.eye
        on_quad = march_by_steps(BLOB, EYE.eye, ways, **how)
        for one, other in zip(along_rays, on_quad, strict=True):
            np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-9)


def test_a_quad_needs_a_distance() -> None:
    with pytest.raises(ValueError, match=r"^distance: expected a finite number"):
        quad_points(Camera([0, 0, 1], [0, 0, 0]), 0.0)
