"""To a tolerance: never beyond it, from any eye, and every saving told."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from small_marches import BLOB, MEDIUM, SUN, blob, relative_error
from twins.march import directions

from refcloud.camera import AnyCamera, Camera, OrthographicCamera, rays
from refcloud.cloudmap import VoxelGrid, trilinear
from refcloud.march import Mixing, certified, gather, integrate
from refcloud.march.cells import cropped, lattice
from refcloud.march.certified import SETTINGS
from refcloud.march.fast import Setting, fast, light_volumes
from refcloud.march.gather import Counts
from refcloud.march.light import sources
from refcloud.march.lines import Frame, by_frame, frame_numbers
from refcloud.march.planes import RIM, looked_up, planes, tent_means
from refcloud.optics import Medium, Sun

SIZE = {"width": 27, "height": 20}
FRONT = Camera([2.2, 1.2, 3.0], [0, 0, 0], **SIZE)
THIN = Medium(0.8, 0.9, 0.3, "hg")
FULL = VoxelGrid(0.5 + BLOB.density, [-1, -1, -1], [1, 1, 1])
EYES: dict[str, AnyCamera] = {
    "front": FRONT,
    "side": Camera([-3.0, 0.1, 0.2], [0, 0, 0], **SIZE),
    "diagonal": Camera([2.0, 2.0, 2.0], [0, 0, 0], **SIZE),
    "inside": Camera([0.1, 0.2, 0.3], [0.4, 0.1, -1], fov_y=2.6, **SIZE),
    "near a face": Camera([0.2, 0.1, 1.05], [0, 0.3, 0], fov_y=2.0, **SIZE),
    "parallel": OrthographicCamera([0, 0, 5], [0, 0, 0], **SIZE),
    "below": OrthographicCamera([1, -4, 2], [0, 0, 0], **SIZE),
    "far away": Camera([1e6, 2e6, -1e6], [0, 0, 0], fov_y=1.2e-6, **SIZE),
}


def through(cloud: VoxelGrid, camera: AnyCamera, setting: Setting, **how):
    """March all pixels by one setting; radiance, column and counts."""
    origins, ways = (a.reshape(-1, 3) for a in rays(camera))
    medium, suns = how.get("medium", MEDIUM), how.get("suns", (SUN,))
    mixing, counts = how.get("mixing", Mixing()), Counts()
    inner = cropped(cloud)
    found = fast(
        inner,
        lattice(inner),
        np.ascontiguousarray(origins),
        ways,
        suns=suns,
        lit=sources(suns, medium, directions=ways),
        medium=medium,
        mixing=mixing,
        setting=setting,
        least=how.get("least", 1e-7),
        counts=counts,
        frames=frame_numbers(lattice(inner), ways),
        lights=light_volumes(inner, suns, medium, mixing, setting.scale),
    )
    return *found, counts


@pytest.mark.parametrize("camera", EYES.values(), ids=EYES)
@pytest.mark.parametrize(
    ("cloud", "medium"), [(BLOB, MEDIUM), (FULL, THIN)], ids=["cloud", "full box"]
)
def test_finer_slabs_come_nearer_from_any_eye(cloud, medium, camera) -> None:
    exact, T = integrate(cloud, *rays(camera), suns=SUN, medium=medium)
    errors = []
    for setting in (Setting(1.0, 1), Setting(0.25, 2)):
        L, column, _ = through(cloud, camera, setting, medium=medium)
        errors.append(relative_error(L, exact.reshape(-1, 3)))
        depth = np.exp(-medium.sigma_t * column) - T.reshape(-1)
        errors.append(float(np.sqrt(np.square(depth).mean())))
    # 14 voxels across, optical depth 1 in a voxel. Worst seen .071, .011, .021, .0006.
    assert errors[0] < 0.1
    assert errors[1] < 0.016
    assert errors[2] < 0.03
    assert errors[3] < 0.001


def test_checked_rays_are_marched_as_among_all_others() -> None:
    """Seen from near, rays take several frames; a sample of them keeps those."""
    camera = Camera([2.0, 0.0, 4.0], [0, 0, 0], fov_y=1.5, **SIZE)
    cloud = blob((4, 6, 7), 2)
    exact, T = integrate(cloud, *rays(camera), suns=(), medium=Medium(1.0))
    found, seen = integrate(
        cloud, *rays(camera), suns=(), medium=Medium(1.0), tolerance=0.25
    )
    assert np.abs(seen - T).max() <= 0.25
    assert np.abs(found - exact).max() <= 0.25


@settings(max_examples=6, suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_no_channel_is_off_by_more_than_the_tolerance(data) -> None:
    _generated(data)


@pytest.mark.slow
@settings(max_examples=100, suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_many_scenes_stay_within_the_tolerance(data) -> None:
    _generated(data)


def _generated(data: st.DataObject) -> None:
    """Draw a scene, an eye and a tolerance, and compare with the quadrature."""
    n = data.draw(st.tuples(*[st.integers(2, 10)] * 3), label="shape")
    cloud = blob(n, data.draw(st.integers(0, 2**40), label="seed"))
    assume(cloud.density.any())
    eye = 4.0 * np.array(data.draw(directions(), label="eye"))
    camera = Camera(eye, [0, 0, 0], fov_y=data.draw(st.floats(0.3, 1.5)), **SIZE)
    sigma_t = data.draw(st.floats(0.1, 40.0) | st.just([2.0, 4.0, 9.0]), label="s")
    medium = Medium(sigma_t, 0.9, data.draw(st.floats(-0.6, 0.6)), "hg")
    lights = tuple(
        Sun(way) for way in data.draw(st.lists(directions(), max_size=2), label="suns")
    )
    tolerance = data.draw(st.floats(1 / 255, 0.3), label="tolerance")
    how = {
        "suns": lights,
        "medium": medium,
        "background": data.draw(st.none() | st.just([0.3, 0.6, 1.2])),
        "ambient": [0.1, 0.2, 0.3],
    }
    exact, T = integrate(cloud, *rays(camera), **how)
    found, seen = integrate(cloud, *rays(camera), **how, tolerance=tolerance)
    assert np.abs(found - exact).max() <= tolerance
    if how["background"] is None:
        assert np.abs(seen - T).max() <= tolerance


def test_what_is_left_out_is_told(monkeypatch) -> None:
    monkeypatch.setattr(gather, "STRETCH", 1)  # few slabs, and still several stretches
    seen: dict = {}
    thick = dataclasses.replace(MEDIUM, sigma_t=60.0)
    how = {"suns": SUN, "medium": thick, "observe": seen.__setitem__}
    integrate(BLOB, *rays(FRONT), **how, tolerance=0.2)
    exact, empty, hidden = seen["skipped"]
    assert (exact.skipped, exact.of) == (540, 540)
    assert exact.bound <= 0.2
    assert 0 < empty.skipped < empty.of
    assert 0 < hidden.skipped < hidden.of
    assert hidden.bound == pytest.approx(0.05 * 0.2)
    assert len(seen["checked rays"]) == len(set(seen["checked rays"].tolist()))
    errors = list(seen["errors of settings"].values())
    assert 2.0 * errors[-1] <= 0.2
    assert all(2.0 * error > 0.2 for error in errors[:-1])


def test_where_no_setting_serves_every_ray_is_exact(monkeypatch) -> None:
    seen: dict = {}
    how = {"suns": SUN, "medium": MEDIUM}
    monkeypatch.setattr(certified, "SETTINGS", SETTINGS[:1])
    found, _ = integrate(
        BLOB, *rays(FRONT), **how, tolerance=2e-5, observe=seen.__setitem__
    )
    exact, _ = integrate(BLOB, *rays(FRONT), **how)
    np.testing.assert_allclose(found, exact, rtol=0.0, atol=1e-6)
    assert seen["skipped"] == ()


def test_tolerances_below_single_precision_and_few_rays_are_exact() -> None:
    origins, ways = rays(FRONT)
    for tolerance, rows in ((1e-6, 22), (0.1, 4)):
        how = {"suns": SUN, "medium": MEDIUM}
        part = origins[:rows], ways[:rows]
        found, _ = integrate(BLOB, *part, **how, tolerance=tolerance)
        exact, _ = integrate(BLOB, *part, **how)
        np.testing.assert_allclose(found, exact, rtol=0.0, atol=0.06 * tolerance)


@given(st.integers(1, 6), st.floats(0.2, 3.0), st.integers(1, 5))
def test_means_over_slabs_integrate_the_interpolation(count, thickness, slabs) -> None:
    edges = np.minimum(-0.5 + thickness * np.arange(slabs + 1), count - 0.5)
    weights = tent_means(edges, count)
    np.testing.assert_allclose(weights.sum(axis=1), np.diff(edges), atol=1e-14)
    values = np.cos(np.arange(count))
    fine = np.linspace(-0.5, count - 0.5, 4001)
    middles = 0.5 * (fine[1:] + fine[:-1])
    height = np.interp(middles, np.arange(count), values)
    for row, low, high in zip(weights, edges, edges[1:], strict=False):
        inside = np.clip(np.minimum(fine[1:], high) - np.maximum(fine[:-1], low), 0, 9)
        assert row @ values == pytest.approx(inside @ height, abs=1e-3)


def test_a_look_up_between_samples_is_trilinear_where_w_is_level() -> None:
    level = np.broadcast_to(BLOB.density[5], (4, 12, 13))
    cloud = VoxelGrid(level, [0, 0, 0], [13, 12, 4])
    volume = planes([level, 2.0 * level], np.arange(-0.5, 4.0), scale=1, thickness=1.0)
    u, v = np.array([0.3, 5.7, 11.99]), np.array([10.2, 3.0, 0.4])
    slab = np.array([0, 2, 3], np.int32)
    one, two = looked_up(
        volume, slab, (u + RIM).astype(np.float32), (v + RIM).astype(np.float32)
    )
    points = np.stack([u + 0.5, v + 0.5, np.full(3, 2.0)], axis=1)
    np.testing.assert_allclose(one, trilinear(cloud, points), atol=1e-5)
    np.testing.assert_allclose(two, 2.0 * one, rtol=1e-6)
    assert volume.shape == (4, 12 + 2 * RIM, 13 + 2 * RIM)


def test_rays_are_sorted_into_frames() -> None:
    ways = np.concatenate([np.eye(3), -np.eye(3), [[0.0, 0.9, 1.0]]])
    frames = by_frame(frame_numbers(lattice(BLOB), ways))
    assert sum(len(which) for _, which in frames) == 7
    assert len({(frame.axis, frame.flipped) for frame, _ in frames}) == 6
    field = np.arange(24.0).reshape(2, 3, 4)
    assert Frame(0, True).turned(field).shape == (4, 2, 3)
    assert Frame(0, True).turned(field)[0, 0, 0] == field[0, 0, 3]
    assert Frame(1, False).turned(field)[2, 1, 3] == field[1, 2, 3]


def test_cropping_keeps_one_empty_layer() -> None:
    wide = VoxelGrid(np.pad(BLOB.density, 4), [-4.5, -3, -2], [4.5, 3, 2])
    inner = cropped(wide)
    points = np.random.default_rng().uniform(-4.5, 4.5, (400, 3))
    np.testing.assert_allclose(
        trilinear(inner, points), trilinear(wide, points), atol=1e-13
    )
    assert inner.density.size < wide.density.size
    empty = VoxelGrid(np.zeros((3, 3, 3)), [0, 0, 0], [1, 1, 1])
    assert cropped(empty) is empty
