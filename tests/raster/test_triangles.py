"""Laws of triangles: every pixel once, in any order, in perspective, in turn."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from twins.camera import drawn_camera, places
from twins.triangles import drawn_mesh
from twins.walls import listed, spots

from refcloud.camera import Camera, OrthographicCamera, rays
from refcloud.noise import uniform
from refcloud.plain import triangles as plain
from refcloud.raster import (
    Blending,
    Mesh,
    State,
    Texture,
    Textured,
    draw_triangles,
    framebuffer,
    plane_mesh,
    sphere_mesh,
    triangle_pixels,
    triangles,
)
from refcloud.raster.meshes import separate

SIZE = {"width": 16, "height": 12}
WHITE = [1.0, 1.0, 1.0, 1.0]
NEAREST = State(depth_func="LESS")
SUM = State(blending=Blending("ONE", "ONE"))
EYE = Camera([0.3, 0.4, 3.0], [0.0, 0.0, 0.0], fov_y=0.9, width=32, height=24)


def drawn(mesh, shade, camera=EYE, depth=None, **how) -> np.ndarray:
    buffer = framebuffer(camera.width, camera.height, depth=depth)
    draw_triangles(buffer, camera, mesh, shade, **how)
    return buffer.pixels


def values(fragments) -> np.ndarray:
    """Show the first three attributes, and that there is a fragment."""
    filled = np.zeros((len(fragments.row), 4))
    filled[:, : len(fragments.values)] = fragments.values.T
    filled[:, 3] = 1.0
    return filled


@settings(max_examples=40)
@given(spots, st.lists(st.floats(0.5, 12.0), min_size=3, max_size=7))
def test_triangles_about_a_point_fill_every_pixel_once(middle, reach) -> None:
    # A fan that covers a star-shaped area once, on whole sub-pixels.
    around = 2.0 * np.pi * np.arange(len(reach)) / len(reach)
    way = np.stack([np.cos(around), np.sin(around)], axis=1)
    middle = np.round(np.array(middle) * 256.0) / 256.0
    ring = np.round((middle + np.array(reach)[:, None] * way) * 256.0) / 256.0
    count = np.zeros((12, 16), int)
    x, y = np.arange(16) + 0.5, np.arange(12)[:, None] + 0.5
    within = np.zeros((12, 16), bool)
    for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        np.add.at(count, triangle_pixels([middle, a, b], **SIZE), 1)
        sides = [
            (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
            for p, q in ((middle, a), (a, b), (b, middle))
        ]
        within |= np.min(sides, axis=0) > 0.0
    assert count.max() <= 1
    assert count[within].all()


@given(st.lists(spots, min_size=3, max_size=3), st.permutations(range(3)))
def test_the_order_of_corners_does_not_matter(corners, order) -> None:
    one = triangle_pixels(corners, **SIZE)
    other = triangle_pixels([corners[k] for k in order], **SIZE)
    assert listed(*one) == listed(*other)


@given(st.lists(spots, min_size=3, max_size=3))
def test_a_window_shows_its_part_of_a_triangle(corners) -> None:
    large = triangle_pixels(corners, width=40, height=40)
    inside = (large[0] < 12) & (large[1] < 16)
    small = triangle_pixels(corners, **SIZE)
    assert listed(*small) == listed(large[0][inside], large[1][inside])


@settings(max_examples=60)
@given(st.randoms(use_true_random=False), st.sampled_from([2**11, 2**24, 2**29, 2**29]))
def test_corners_far_away_are_told_exactly(chance, most) -> None:
    # An edge so close by a pixel's centre that it spans the least area with it, 1. Its
    # ends lie as far away as products are whole in float64, and further.
    run, rise, *other = (chance.randint(most // 2, most) for _ in range(4))
    run, rise = run // math.gcd(run, rise), rise // math.gcd(run, rise)
    past, side = chance.choice([-1, 1]), chance.choice([-1, 1])
    y = past * pow(run, -1, rise)
    x = (run * y - past) // rise  # run y - rise x = past
    center = 256 * np.array([chance.randint(0, 11), chance.randint(0, 11)]) + 128
    start = center - (x, y)
    third = side * other[0], -side * other[1]
    corners = np.array([start, np.add(start, (run, rise)), third]) / 256.0
    if chance.random() < 0.5:
        corners[:, 0] = SIZE["width"] - corners[:, 0]
    found = triangle_pixels(corners, **SIZE)
    assert listed(*found) == plain.triangle_pixels(corners.tolist(), **SIZE)


@settings(max_examples=30)
@given(data=st.data())
def test_what_lies_beside_the_window_is_left_out_unseen(data) -> None:
    camera = drawn_camera(data.draw)
    camera = type(camera)(**{**vars(camera), **SIZE})
    corners = drawn_mesh(data.draw, 1), sphere_mesh(5, 4)
    near = data.draw(st.sampled_from([1e-3, 0.5]))

    def pictures() -> list[np.ndarray]:
        return [drawn(mesh, WHITE, camera, state=SUM, near=near) for mesh in corners]

    found = pictures()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(triangles, "BESIDE", 8192.0)  # where triangles are cut anyhow
        np.testing.assert_array_equal(found, pictures())


@settings(max_examples=60)
@given(data=st.data())
def test_the_order_of_corners_and_triangles_does_not_show(data) -> None:
    camera = drawn_camera(data.draw)
    camera = type(camera)(**{**vars(camera), **SIZE})
    mesh = drawn_mesh(data.draw, 2)
    turned = np.array([np.roll(face, k) for k, face in enumerate(mesh.faces)])
    other = Mesh(mesh.points, turned[::-1].reshape(-1, 3), mesh.attributes)
    one, two = (drawn(m, WHITE, camera, state=SUM) for m in (mesh, other))
    np.testing.assert_array_equal(one, two)


@settings(max_examples=60)
@given(data=st.data())
def test_a_mesh_without_gaps_stays_so_where_it_is_cut(data) -> None:
    # A plane through the near plane and far beside the window, in cells: drawn once
    # each, and the same pixels as its two halves.
    eye, target = data.draw(places), data.draw(places)
    assume(abs(eye[1]) > 0.05 and np.abs(np.subtract(eye, target)).max() > 0.1)
    up = [0.0, 1.0, 0.0]
    camera = Camera(eye, target, up, data.draw(st.floats(0.2, 2.5)), **SIZE)
    near = data.draw(st.sampled_from([1e-3, 0.5, 3.0]))
    cells = data.draw(st.integers(2, 9))
    many = drawn(
        plane_mesh(cells, cells, width=1e5, depth=1e5),
        WHITE,
        camera,
        state=SUM,
        near=near,
    )
    few = drawn(
        plane_mesh(1, 1, width=1e5, depth=1e5), WHITE, camera, state=SUM, near=near
    )
    assert many.max() <= 1.0
    # Corners of cells are snapped; so a border moves by less than a pixel.
    assert np.count_nonzero(many != few) <= 4 * 2 * (16 + 12)


@settings(max_examples=60)
@given(data=st.data())
def test_what_is_linear_in_space_is_so_in_the_picture(data) -> None:
    camera = drawn_camera(data.draw)
    camera = type(camera)(**{**vars(camera), **SIZE})
    mesh = plane_mesh(3, 2, width=8.0, depth=8.0, height=data.draw(st.floats(-2, 2)))
    height = mesh.points[0, 1]
    assume(abs(camera.eye[1] - height) > 0.1)
    mesh = dataclasses.replace(mesh, attributes=mesh.points)
    found = drawn(mesh, values, camera, near=0.01)
    origins, directions = rays(camera)
    slope = np.where(found[..., 3] == 1.0, directions[..., 1], 1.0)
    far = (height - origins[..., 1]) / slope
    exact = origins + far[..., None] * directions
    # The corners are snapped to 1/256 pixel: a place is off by what that is there.
    steep = np.abs(directions[..., 1]) > 0.05
    sure = (found[..., 3] == 1.0) & steep & (far > 0.5) & (far < 30.0)
    pixel = np.linalg.norm(directions[0, 0] - directions[-1, -1]) / 20.0
    pixel = max(pixel, np.linalg.norm(origins[0, 0] - origins[-1, -1]) / 20.0)
    most = (0.02 + far * (far + 1.0) * pixel / (0.05 * 64.0))[..., None]
    assert (np.abs(found[..., :3] - exact) <= most)[sure].all()


@given(st.tuples(spots, spots, spots), st.floats(0.1, 9.0))
def test_affine_attributes_come_back_at_every_centre(corners, k) -> None:
    # Parallel rays, one unit to the pixel: a place's own coordinates are attributes.
    camera = OrthographicCamera([8, -6, 1], [8, -6, 0], height_of_view=12, **SIZE)
    places = np.round(np.array(corners) * 256.0) / 256.0
    points = np.concatenate([places * [1, -1], np.zeros((3, 1))], axis=1)
    linear = np.stack([places[:, 0], k * places[:, 1], places.sum(axis=1)], axis=1)
    found = drawn(Mesh(points, [[0, 1, 2]], linear), values, camera, near=0.5)
    j, i = np.nonzero(found[..., 3])
    expected = np.stack([i + 0.5, k * (j + 0.5), i + j + 1.0], axis=1)
    np.testing.assert_allclose(found[j, i, :3], expected, rtol=0, atol=1e-9)
    pixels = triangle_pixels(places, **SIZE)
    assert listed(j, i) == listed(*pixels)


@settings(max_examples=40)
@given(data=st.data())
def test_interpolation_stays_between_the_corners(data) -> None:
    camera = drawn_camera(data.draw)
    camera = type(camera)(**{**vars(camera), **SIZE})
    mesh = drawn_mesh(data.draw, 1)
    found = drawn(mesh, values, camera, near=data.draw(st.sampled_from([1e-3, 1.0])))
    inside = found[found[..., 3] == 1.0, 0]
    if inside.size:
        used = mesh.attributes[np.unique(mesh.faces)]
        # A cut corner may lie 1e4 times nearer than another: so many digits fewer.
        assert inside.min() >= used.min() - 1e-9
        assert inside.max() <= used.max() + 1e-9


def test_derivatives_are_those_of_the_quotient() -> None:
    mesh = dataclasses.replace(plane_mesh(4, 4, width=40.0, depth=40.0))
    seen = []
    camera = Camera([0, 1, 3], [0, 0.4, 0], fov_y=1.0, width=64, height=48)
    draw_triangles(
        framebuffer(64, 48), camera, mesh, lambda f: seen.append(f) or values(f)
    )
    (fragments,) = seen
    whole = np.full((2, 48, 64), np.nan)
    whole[:, fragments.row, fragments.column] = fragments.values
    for change, axis in ((fragments.along_x, 2), (fragments.along_y, 1)):
        exact = np.zeros((2, 48, 64))
        exact[:, fragments.row, fragments.column] = change
        found = np.full_like(exact, np.nan)
        ahead, behind = np.roll(whole, -1, axis), np.roll(whole, 1, axis)
        inner = (slice(None), slice(1, -1), slice(1, -1))
        found[inner] = 0.5 * (ahead - behind)[inner]
        # A difference over two pixels is off by its third derivative, at the horizon.
        sure = np.isfinite(found) & (np.arange(48) > 26)[:, None]
        assert sure.sum() > 1000
        off = np.abs(found - exact)[sure]
        assert off.max() <= 0.02 * np.abs(exact[sure]).max()


def test_nearer_triangles_hide_others_in_any_order() -> None:
    mesh = sphere_mesh(12, 8)
    shuffled = np.argsort(uniform(np.arange(len(mesh.faces)), seed=3))
    mixed = dataclasses.replace(mesh, faces=mesh.faces[shuffled])
    pictures = [drawn(m, values, depth=1.0, state=NEAREST) for m in (mesh, mixed)]
    np.testing.assert_array_equal(*pictures)
    fronts = drawn(mesh, values, depth=1.0, state=NEAREST, cull="BACK")
    np.testing.assert_array_equal(pictures[0], fronts)
    assert (drawn(mesh, values, cull="FRONT_AND_BACK") == 0.0).all()


@pytest.mark.parametrize(("func", "shown"), [("LESS", 0.25), ("LEQUAL", 0.75)])
def test_of_equal_depths_the_function_decides(func: str, shown: float) -> None:
    points = np.array([[-1, -1, 0], [1, -1, 0], [0, 1, 0]] * 2, float)
    mesh = Mesh(points, np.arange(6).reshape(2, 3), [[0.25]] * 3 + [[0.75]] * 3)
    found = drawn(mesh, values, depth=1.0, state=State(depth_func=func))
    there = found[..., 3] == 1.0
    np.testing.assert_allclose(found[there, 0], shown)


def test_batches_show_nowhere(monkeypatch) -> None:
    mesh, state = sphere_mesh(12, 8), NEAREST
    mix = State(blending=Blending("SRC_ALPHA", "ONE_MINUS_SRC_ALPHA"))

    def half(f) -> np.ndarray:
        return np.column_stack([f.values.T, f.depth, 0.5 * f.front + 0.3])

    whole = [drawn(mesh, half, depth=1.0, state=s) for s in (state, mix)]
    for name in ("AT_ONCE", "SHADED_AT_ONCE"):
        monkeypatch.setattr(triangles, name, 50)
    monkeypatch.setattr("refcloud.raster.spans.ROWS_AT_ONCE", 7)
    parts = [drawn(mesh, half, depth=1.0, state=s) for s in (state, mix)]
    np.testing.assert_array_equal(whole, parts)


@settings(max_examples=40)
@given(st.floats(1e-3, 0.2), st.floats(-0.3, 0.3), st.integers(4, 40))
def test_nothing_pops_as_the_near_plane_passes(height, turn, cells) -> None:
    # The eye stands on a floor: below its horizon every pixel shows it, however near.
    camera = Camera([turn, height, 0], [0, height, -1], fov_y=1.5, width=24, height=18)
    floor = plane_mesh(cells, cells, width=1e6, depth=1e6)
    shown = drawn(floor, WHITE, camera, near=1e-4)[..., 0]
    assert (shown[10:] == 1.0).all()
    assert (shown[:9] == 0.0).all()


@settings(max_examples=40)
@given(places, places, st.floats(0.0, 1.0))
def test_degenerate_triangles_draw_nothing(a, b, share) -> None:
    a, b = np.array(a), np.array(b)
    camera = Camera([20.0, 3.0, 4.0], [0.0, 0.0, 0.0], **SIZE)
    flat = separate(np.array([[a, b, a], [a, a, a]]))
    assert (drawn(flat, WHITE, camera) == 0.0).all()


def test_a_texture_is_seen_upright_and_modulated() -> None:
    texels = np.array([[[0.1], [0.2]], [[0.3], [0.4]]])  # the last row lies at t = 1
    camera = OrthographicCamera([0, 9, 0], [0, 0, 0], [0, 0, -1], width=2, height=2)
    texture = Texture(texels, "CLAMP_TO_EDGE", "NEAREST", "NEAREST")
    half = Textured(texture, color=[0.5, 1.0, 1.0, 0.25])
    found = drawn(plane_mesh(1, 1), half, camera)
    np.testing.assert_allclose(found[..., 0], [[0.15, 0.2], [0.05, 0.1]])
    np.testing.assert_array_equal(
        found[..., 1:], np.broadcast_to([0, 0, 0.25], (2, 2, 3))
    )


@settings(max_examples=30)
@given(st.integers(0, 99), st.sampled_from([1, 3, 4]), st.sampled_from([2, 3]))
def test_a_tolerance_is_kept(seed, channels, dimension) -> None:
    where = np.meshgrid(*[np.arange(9)] * dimension, np.arange(channels), indexing="ij")
    texels = 4.0 * uniform(*where[:2], where[-1] + 10 * where[-2], seed=seed) - 2.0
    mesh = sphere_mesh(9, 7)
    mesh = dataclasses.replace(mesh, attributes=2.0 * mesh.points)
    for minify in ("LINEAR", "LINEAR_MIPMAP_LINEAR"):
        texture = Textured(Texture(texels, min_filter=minify), color=[2, 1, 1, 1])
        exact, rough = (drawn(mesh, texture, tolerance=t) for t in (0.0, 1e-5))
        off = np.abs(exact - rough).max()
        assert off <= 1e-5
        assert off > 0.0 or not exact.any()
        # Below what float32 is good for, nothing is saved.
        np.testing.assert_array_equal(exact, drawn(mesh, texture, tolerance=1e-7))


def test_a_framebuffer_of_any_layout_is_written() -> None:
    mesh = sphere_mesh(9, 7)
    kept = framebuffer(32, 24, depth=1.0)
    draw_triangles(kept, EYE, mesh, values, state=NEAREST)
    pixels = np.zeros((24, 64, 4))[:, ::2]
    depth = np.ones((24, 64))[:, ::2]
    odd = type(kept)(pixels, depth)
    draw_triangles(odd, EYE, mesh, values, state=NEAREST)
    np.testing.assert_array_equal(odd.pixels, kept.pixels)
    np.testing.assert_array_equal(odd.depth, kept.depth)


BALL = sphere_mesh(4, 3)
FLAT = Textured(Texture(np.ones((1, 1, 1))))
PARALLEL = OrthographicCamera([0, 0, 3], [0, 0, 0], width=32, height=24)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: drawn(BALL, WHITE, far=1e-4), "far: expected a depth beyond near"),
        (
            lambda: drawn(BALL, WHITE, PARALLEL, depth=1.0, state=NEAREST),
            "far: expected a depth for the depth test of parallel rays",
        ),
        (
            lambda: drawn(Mesh(BALL.points, BALL.faces), FLAT),
            "mesh: expected a mesh of at least 2 attributes, got 0",
        ),
        (lambda: drawn(BALL, lambda f: f.depth), r"shade: expected an array of shape"),
        (
            lambda: drawn(BALL, lambda f: np.full((len(f.row), 4), np.nan)),
            "shade: expected finite numbers",
        ),
        (lambda: drawn(BALL, WHITE, cull="LEFT"), "cull: expected one of"),
        (
            lambda: draw_triangles(framebuffer(4, 4), EYE, BALL, WHITE),
            "buffer: expected shape",
        ),
        (lambda: triangle_pixels([[0, 0]] * 2, **SIZE), "corners: expected an array"),
        (lambda: triangle_pixels([[0, 1e9]] * 3, **SIZE), "corners: expected numbers"),
    ],
)
def test_refusals_name_the_argument_in_one_line(call, message: str) -> None:
    with pytest.raises((ValueError, TypeError), match=rf"^{message}[^\n]*$"):
        call()
