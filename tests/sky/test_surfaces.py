"""Surfaces of skies: round trips, how far each stretches, and rays that lie on them."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.skies import drawn_points, drawn_surface

from refcloud.camera import Camera, OrthographicCamera, rays
from refcloud.noise import fbm
from refcloud.sky import (
    Dome,
    Fog,
    Plane,
    Sphere,
    dome_coordinates,
    dome_points,
    places,
    shaded,
    sphere_coordinates,
    sphere_points,
)

INSIDE = Camera([0, 0, 0], [0.1, 0.4, -1], fov_y=1.2, width=24, height=18)
ALL = (Plane(height=1.5), Sphere(), Dome(), Sphere([0, 2, -9], 2.0))


@given(st.data())
def test_a_point_of_a_sphere_comes_back_from_its_picture(data) -> None:
    sphere = drawn_surface(data.draw, Sphere)
    points = drawn_points(data.draw, sphere)
    back = sphere_points(sphere_coordinates(points, sphere), sphere)
    np.testing.assert_allclose(back, points, atol=1e-13 * (30.0 + sphere.radius))


@given(st.floats(-0.5, 0.5), st.booleans())
def test_along_its_axes_the_grid_is_the_texture(share: float, other: bool) -> None:
    dome = Dome(tiles=3.0)
    uv = np.array([share, 0.0][:: -1 if other else 1]) * 3.0 + 1.5
    back = dome_coordinates(dome_points(uv, dome), dome)
    np.testing.assert_allclose(back, uv, atol=1e-12)


def test_the_grid_reaches_the_rim_with_its_whole_border() -> None:
    dome = Dome(tiles=1.0)
    t = np.linspace(0.0, 1.0, 9)
    border = np.concatenate([np.stack([t, s + 0 * t], axis=1) for s in (0.0, 1.0)])
    points = dome_points(border, dome)
    np.testing.assert_allclose(points[:, 1], 0.0, atol=1e-12)
    np.testing.assert_allclose(np.hypot(*points[:, [0, 2]].T), 10.0, rtol=1e-12)


def stretch(coordinates, way: np.ndarray, step: float = 1e-5) -> float:
    """Give how many times farther apart neighbours are one way than the other.

    The ratio of the singular values of d(coordinates) / d(point), on a unit sphere.
    """
    across = np.cross(way, [0.3, 0.5, 0.8])
    across /= np.linalg.norm(across)
    pair = np.stack([across, np.cross(way, across)])
    ahead, behind = (
        coordinates((way + s * pair) / math.hypot(1.0, step)) for s in (step, -step)
    )
    values = np.linalg.svd((ahead - behind) / (2.0 * step), compute_uv=False)
    return values[0] / values[1]


@pytest.mark.parametrize("theta", [0.02, 0.3, 0.8, 1.2, 1.5])
def test_the_half_sphere_is_distorted_at_its_edge_alone(theta: float) -> None:
    way = np.array([math.sin(theta) * 0.6, math.cos(theta), math.sin(theta) * 0.8])
    dome, sphere = Dome(radius=1.0), Sphere(radius=1.0)
    found = stretch(lambda p: dome_coordinates(p, dome), way)
    assert found == pytest.approx(theta / math.sin(theta), rel=1e-4)
    assert found < math.pi / 2.0
    # Around a sphere the picture covers 2 pi along the equator and pi from pole to
    # pole: a texture twice as wide as high is pinched by 1 / sin(theta).
    wrapped = stretch(lambda p: sphere_coordinates(p, sphere) * [2.0, 1.0], way)
    assert wrapped == pytest.approx(1.0 / math.sin(theta), rel=1e-3)


@pytest.mark.parametrize("surface", ALL, ids=lambda s: type(s).__name__)
def test_what_a_pixel_sees_lies_on_its_ray_and_on_the_surface(surface) -> None:
    found = places(INSIDE, surface)
    assert found.seen.any()
    origins, directions = (part[found.seen] for part in rays(INSIDE))
    on_ray = origins + found.distance[:, None] * directions
    np.testing.assert_allclose(found.points, on_ray, atol=1e-12)
    if isinstance(surface, Plane):
        np.testing.assert_allclose(found.points[:, 1], 1.5, atol=1e-12)
    else:
        away = np.linalg.norm(found.points - surface.center, axis=1)
        np.testing.assert_allclose(away, surface.radius, rtol=1e-12)
    assert (found.distance > 0.0).all()


def apart(a: np.ndarray, b: np.ndarray, surface) -> np.ndarray:
    off = np.abs(a - b)
    # Around a sphere u = 0 and u = 1 are one place.
    return np.minimum(off, 1.0 - off) if isinstance(surface, Sphere) else off


@pytest.mark.parametrize("surface", ALL, ids=lambda s: type(s).__name__)
def test_triangles_see_what_rays_see(surface) -> None:
    exact = places(INSIDE, surface)
    errors = []
    for fineness in (24, 48):
        drawn = places(INSIDE, surface, way="triangles", fineness=fineness)
        # A ball's outline has corners; seen from inside there is none.
        missed = np.count_nonzero(exact.seen != drawn.seen)
        assert missed <= (2 if surface is ALL[3] else 0)
        both = exact.seen & drawn.seen
        one, other = (p.coordinates[both[p.seen]] for p in (exact, drawn))
        off = apart(one, other, surface)
        at, there = (p.points[both[p.seen]] for p in (exact, drawn))
        far = np.linalg.norm(at - there, axis=1) / exact.distance[both[exact.seen]]
        errors.append([np.median(off), np.quantile(off, 0.95), np.median(far)])
    if isinstance(surface, Plane):
        # Flat in itself; corners are snapped to 1/256 of a pixel, which moves a ray by
        # as much, and what it meets by the more the flatter it meets the plane.
        pixel = 2.0 * math.tan(0.6) / 18
        flatness = 1.5 / exact.distance[both[exact.seen]]
        assert (far * flatness).max() < pixel / 256
        return
    # Facets: half as wide, a quarter as far from the sphere.
    for coarse, fine in zip(*errors, strict=True):
        assert fine < 0.35 * coarse
    assert errors[1][0] < 3e-4
    assert errors[1][2] < 1e-3


@pytest.mark.parametrize("kind", ["pinhole", "parallel"])
def test_pictures_by_triangles_and_by_rays_are_alike(kind) -> None:
    camera = INSIDE
    if kind == "parallel":
        camera = OrthographicCamera(
            [0, 0, 30], [0, 0, 0], height_of_view=9.0, width=24, height=18
        )
    pictures = []
    for way in ("rays", "triangles"):
        found = places(camera, Sphere(), way=way, fineness=96)
        assert found.way == way
        behind = np.zeros((18, 24, 3))

        def shade(p):
            light = 0.5 + 0.5 * fbm(0.2 * p.points, octaves=2)
            return light, np.ones(len(light))

        pictures.append(shaded(behind, found, shade, fog=Fog(0.05)))
    # Light changes by about 0.3 per unit, facets lie within 3e-3 of the sphere.
    assert np.abs(pictures[0] - pictures[1]).max() < 2e-3
    assert np.ptp(pictures[0]) > 0.05


def test_a_sphere_from_outside_shows_its_near_side() -> None:
    found = places(INSIDE, ALL[3])
    assert 0 < np.count_nonzero(found.seen) < found.seen.size
    middle = np.linalg.norm(ALL[3].center)
    assert (found.distance < middle).all()


def test_a_dome_has_no_lower_half_and_a_plane_an_end() -> None:
    down = dataclasses.replace(INSIDE, target=np.array([0, -1.0, -1]))
    assert not places(down, Dome()).seen.any()
    assert not places(INSIDE, Plane(height=-1.0, reach=1e-3)).seen.any()
    assert not places(down, Plane(height=1.0)).seen.any()


def test_places_are_handed_on_while_the_eye_stands_still() -> None:
    first = places(INSIDE, Dome())
    again = places(INSIDE, Dome(), earlier=first)
    assert again.points is first.points
    assert [(r.skipped, r.of, r.bound) for r in again.skipped] == [(432, 432, 0.0)]
    turned = dataclasses.replace(INSIDE, eye=np.array([0.1, 0, 0]))
    for camera, surface in (
        (turned, Dome()),
        (INSIDE, Dome(tiles=3)),
        (INSIDE, ALL[1]),
    ):
        found = places(camera, surface, earlier=again)
        assert not found.skipped
        assert found.points is not first.points
    drawn = places(INSIDE, Dome(), way="triangles", fineness=9, earlier=first)
    assert not drawn.skipped
    assert places(INSIDE, Dome(), way="triangles", fineness=9, earlier=drawn).skipped
    assert not places(
        INSIDE, Dome(), way="triangles", fineness=8, earlier=drawn
    ).skipped


@given(st.floats(0.0, 1.0))
def test_shading_keeps_what_is_not_covered(share: float) -> None:
    found = places(INSIDE, ALL[3])
    behind = np.linspace(0.0, 1.0, 18 * 24 * 3).reshape(18, 24, 3)
    count = len(found.distance)
    over = shaded(behind, found, lambda p: (np.ones(count), np.full(count, share)))
    np.testing.assert_array_equal(over[~found.seen], behind[~found.seen])
    np.testing.assert_allclose(
        over[found.seen], share + (1 - share) * behind[found.seen], atol=1e-15
    )


def test_thick_fog_of_the_background_hides_the_surface_wholly() -> None:
    found = places(INSIDE, Dome())
    behind = np.linspace(0.0, 1.0, 18 * 24 * 3).reshape(18, 24, 3)
    ones = np.ones(len(found.distance))
    over = shaded(behind, found, lambda p: (ones, ones), fog=Fog(1e3, None))
    np.testing.assert_array_equal(over, behind)


def test_shapes_that_do_not_fit_are_refused() -> None:
    found = places(INSIDE, Dome())
    with pytest.raises(ValueError, match=r"behind: expected shape \(18, 24, 3\)"):
        shaded(np.zeros((2, 2, 3)), found, lambda p: None)
    with pytest.raises(ValueError, match="shader: expected light of shape"):
        shaded(np.zeros((18, 24, 3)), found, lambda p: (np.ones(3), np.ones(3)))
