"""Through the door: pictures of generated scenes, sliced where they can be."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, event, given, settings
from hypothesis import strategies as st
from small_marches import blob
from twins.march import directions

from refcloud import render
from refcloud.camera import AnyCamera, Camera, OrthographicCamera
from refcloud.cloudmap import VoxelGrid
from refcloud.optics import Medium, Sun

SIZE = {"width": 32, "height": 24}


def _camera(data: st.DataObject) -> AnyCamera:
    """Draw an eye around the cloud, seldom within it, or parallel rays."""
    way = np.array(data.draw(directions(), label="way"))
    target = 0.2 * np.array(data.draw(directions(), label="target"))
    if data.draw(st.integers(0, 4), label="kind") == 0:
        height = data.draw(st.floats(1.0, 3.5), label="height of view")
        return OrthographicCamera(4.0 * way, target, height_of_view=height, **SIZE)
    eye = data.draw(st.floats(0.2, 6.0), label="distance") * way
    assume(np.linalg.norm(eye - target) > 0.05)
    fov_y = data.draw(st.floats(0.3, 1.6), label="fov_y")
    return Camera(eye, target, fov_y=fov_y, **SIZE)


def _drawn(data: st.DataObject) -> None:
    """Draw a scene with an empty layer around its cloud, and look at every pixel."""
    n = data.draw(st.tuples(*[st.integers(3, 12)] * 3), label="shape")
    density = np.pad(blob(n, data.draw(st.integers(0, 2**40), label="seed")).density, 1)
    assume(density.any())
    corner = np.array(data.draw(st.tuples(*[st.floats(0.6, 1.5)] * 3), label="corner"))
    cloud = VoxelGrid(density, -corner, corner)
    size = float((2.0 * corner / np.array(density.shape[::-1])).max())
    depth = data.draw(st.floats(0.01, 2.0), label="optical depth of a voxel")
    sigma_t = depth / (density.max() * size)
    if data.draw(st.booleans(), label="coloured"):
        sigma_t = sigma_t * np.array([0.3, 0.7, 1.0])
    how = {
        "camera": _camera(data),
        "suns": tuple(
            Sun(way) for way in data.draw(st.lists(directions(), max_size=2))
        ),
        "medium": Medium(sigma_t, 0.9, data.draw(st.floats(-0.6, 0.8), label="g")),
        "background": data.draw(st.none() | st.just([0.3, 0.6, 1.2])),
    }
    tolerance = data.draw(st.floats(1 / 255, 0.3), label="tolerance")
    exact = render(cloud, **how, tolerance=0.0)
    found = render(cloud, **how, tolerance=tolerance)
    event("slices" if any("slices" in note for note in found.notes) else "rays")
    assert np.abs(found.linear - exact.linear).max() <= tolerance
    if exact.alpha is not None and found.alpha is not None:
        assert np.abs(found.alpha - exact.alpha).max() <= tolerance


@settings(max_examples=4, suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_a_picture_is_within_the_tolerance(data) -> None:
    _drawn(data)


@pytest.mark.slow
@settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_many_pictures_are_within_the_tolerance(data) -> None:
    _drawn(data)
