"""The scenes of document D: what each shows, and what they refuse."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from twins.camera import drawn_camera, places

from refcloud.camera import Camera, axes, project
from refcloud.cloudmap import (
    box_corners,
    placed_texture,
    trilinear,
    worley_smooth_texture,
)
from refcloud.image import Picture, srgb_encode
from refcloud.lighting import Look
from refcloud.noise import worley_drawn, worley_grid, worley_smooth_grid
from refcloud.optics import Medium, Sun
from refcloud.render import render
from refcloud.scene import SCENES, Model, View
from refcloud.scenes import demand, demand_hero, demand_plane
from refcloud.scenes.demand_hero import HERO, Placed, seen_from, turned_sun
from refcloud.sky import printed_gradient

FLAT = ("worley", "worley-inverted", "cells", "perlin", "sky")
BOXED = ("box", "faces", "quad", "lit", "background")
VIEW = View(64, 48)


def drawn(name: str, view: View = VIEW) -> Picture:
    scene = SCENES[f"demand-{name}" if name else "demand"]
    return scene.draw(scene.model(), view)


def test_every_figure_of_document_d_is_a_scene() -> None:
    names = {name for name in SCENES if name.startswith("demand")}
    assert names == {"demand", *(f"demand-{name}" for name in (*FLAT, *BOXED))}
    assert all(
        SCENES[name].title.startswith("document D: ") for name in names - {"demand"}
    )


@pytest.mark.parametrize("name", [*FLAT, *BOXED])
@pytest.mark.parametrize("size", [(40, 30), (17, 40), (5, 5)])
def test_scenes_come_in_any_size(name: str, size) -> None:
    picture = drawn(name, View(*size))
    assert picture.linear.shape == (size[1], size[0], 3)
    assert picture.linear.min() >= 0.0


def test_n26_the_pictures_hold_the_numbers_of_the_document() -> None:
    dots = demand_plane.DOTS
    values = worley_drawn(64, 48, count=dots.count, seed=dots.seed)
    shown, inverted = (
        255.0 * srgb_encode(drawn(name).linear[..., 0])
        for name in ("worley", "worley-inverted")
    )
    np.testing.assert_allclose(shown, values, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(inverted, 255.0 - values, rtol=0.0, atol=1e-9)


def test_n32_the_rejected_noise_hardly_shows_in_the_lumps() -> None:
    picture = srgb_encode(drawn("perlin", View(204, 150)).linear[..., 0])
    off = np.abs(picture[:, :100] - picture[:, 104:])
    assert off[:75].mean() > 0.1, "each for itself they are other noises"
    assert off[75:].mean() < 0.03
    # Below are the lumps that each of them fills, as the texture has them.
    x, y = (np.arange(100) + 0.5) * 4.0 / 150, (np.arange(75, 150) + 0.5) * 4.0 / 150
    for detail, side in (("smooth", slice(100)), ("gradient", slice(104, None))):
        lumps = worley_smooth_grid(x, y, [0.4], seed=3, octaves=3, detail=detail)
        np.testing.assert_allclose(picture[75:, side], lumps[0], rtol=0.0, atol=1e-12)


def test_n32_the_finer_noise_above_is_the_one_that_fills_the_lumps() -> None:
    # remap(w, s - 1, 1, 0, 1) = v: from w and v the filling s follows.
    view = View(40, 60)
    line = (np.arange(40) + 0.5) * 4.0 / 60
    w = 1.0 - worley_grid(line, line[:30], [0.4], seed=3, normalize="clip")[0]
    for detail in ("smooth", "gradient"):
        v = worley_smooth_grid(line, line[:30], [0.4], seed=3, octaves=3, detail=detail)
        above = srgb_encode(demand_plane.filled(detail, view).linear[:30, :, 0])
        clear = v[0] < 0.999
        s = (w + 1.0 - 2.0 * v[0])[clear] / (1.0 - v[0])[clear]
        np.testing.assert_allclose(above[clear], s, rtol=0.0, atol=1e-9)


def test_e34_the_printed_sky_is_nearly_black_beside_the_mended_one() -> None:
    sky = drawn("sky").linear
    left, right = sky[:, :30], sky[:, 34:]
    np.testing.assert_array_equal(left, printed_gradient(width=30, height=48))
    assert left.max() < 0.26
    assert not left[..., :2].any()
    assert right.min() > 0.09
    assert (np.diff(right, axis=0) > 0.0).all(), "it gets lighter toward the horizon"


def test_r07_the_wrong_try_shows_the_texture_of_the_faces_alone() -> None:
    camera = demand.eye(VIEW)
    faces = drawn("faces").linear
    # The middle of the front wall: a pixel holds the texture there and nothing behind.
    middle = np.array([[0.02, 0.03, demand.OWN.upper[2]]])
    x, y, _, _ = project(camera, middle)
    row, column = int(y[0]), int(x[0])
    inside = placed_texture(
        worley_smooth_texture(64, cells=4, seed=2, threshold=0.45),
        demand.FACES.lower,
        demand.FACES.upper,
        repeats=(2, 1, 1),
    )
    right, up, back = axes(camera)
    scale = 2.0 * np.tan(0.5 * camera.fov_y) / camera.height
    way = (column + 0.5 - 32) * scale * right - (row + 0.5 - 24) * scale * up - back
    t = (demand.OWN.upper[2] - camera.eye[2]) / way[2]
    density = float(trilinear(inside, camera.eye + t * way - [0, 0, 1e-12]))
    shown = srgb_encode(faces[row, column])
    np.testing.assert_allclose(shown, 0.25 + 0.75 * density, rtol=0.0, atol=1e-9)


def test_r03_beers_law_alone_mixes_the_sky_with_white() -> None:
    sky = demand_plane.mended(VIEW)
    bare = dataclasses.replace(demand.QUAD, frame="none")
    scene = demand.boxed(bare, Model({}), VIEW)
    share = (scene.linear - sky) / (1.0 - sky)
    # The same share in every channel, between none and all.
    np.testing.assert_allclose(share, share[..., :1] * np.ones(3), atol=1e-9)
    assert share.min() > -1e-12
    assert 0.9 < share.max() <= 1.0


def test_f07_f08_the_box_is_the_cloud_between_its_walls() -> None:
    lit, framed, boxed = (drawn(name).linear for name in ("lit", "quad", "box"))
    corners = box_corners(demand.OWN.lower, demand.OWN.upper)
    x, y, _, _ = project(demand.eye(VIEW), corners)
    outside = np.ones((48, 64), bool)
    columns, rows = (slice(int(v.min()) - 1, int(v.max()) + 2) for v in (x, y))
    outside[rows, columns] = False
    assert outside.any()
    for picture in (framed, boxed):
        np.testing.assert_array_equal(picture[outside], lit[outside])
    assert (boxed[24, 32] != lit[24, 32]).all()


def test_the_pair_holds_the_same_cloud_twice() -> None:
    both = drawn("background", View(84, 48)).linear
    left, gap, right = both[:, :40], both[:, 40:44], both[:, 44:]
    assert (gap == 1.0).all()
    # Where nothing of the background shows, both are the cloud.
    same = np.abs(left - right).max(axis=2) < 0.01
    assert 20 < same.sum() < left[..., 0].size / 2
    assert (left[0] == demand_plane.PLAIN).all()


def test_light_comes_from_the_suns_that_are_given() -> None:
    dark, one, two = (
        drawn("lit", dataclasses.replace(VIEW, suns=suns)).linear
        for suns in ((), (demand.OWN.sun,), (demand.OWN.sun, demand.OWN.sun))
    )
    np.testing.assert_array_equal(one, drawn("lit").linear)
    np.testing.assert_allclose(two - one, one - dark, rtol=0.0, atol=1e-12)
    assert (one - dark).max() > 0.3


def test_r02_tolerance_bounds_what_savings_change() -> None:
    exact = drawn("lit").linear
    for tolerance in (1e-4, 1.0 / 255.0, 0.1):
        close = drawn("lit", dataclasses.replace(VIEW, tolerance=tolerance)).linear
        assert np.abs(close - exact).max() <= tolerance


@settings(max_examples=60)
@given(st.data(), places, st.floats(0.2, 5.0), st.floats(-3.0, 3.0), places)
def test_a_cloud_is_seen_where_it_is_placed(data, place, scale, turn, point) -> None:
    camera = drawn_camera(data.draw)
    placed = Placed(0, place[0], place[2], scale, turn, 1.0)
    c, s = np.cos(turn), np.sin(turn)
    x, y, z = point
    world = np.array([c * x + s * z, y, -s * x + c * z]) * scale
    world += [place[0], 0.0, place[2]]
    there = np.array(project(camera, world[None]))
    here = np.array(project(seen_from(camera, placed), [point]))
    assume(abs(there[2, 0]) > 1.0)
    assume(np.abs(there).max() < 1e4)
    np.testing.assert_allclose(here[:2], there[:2], rtol=1e-7, atol=1e-7)
    np.testing.assert_allclose(here[2] * scale, there[2], rtol=1e-7, atol=1e-7)


def test_suns_turn_with_the_eye() -> None:
    sun = Sun([1.0, 2.0, 3.0], [1.0, 2.0, 3.0])
    camera = Camera([0.0, 0.0, 0.0], sun.direction)
    moved = seen_from(camera, Placed(0, 0.0, 0.0, 1.0, 0.7, 1.0))
    own = turned_sun(sun, 0.7)
    np.testing.assert_allclose(own.direction, -axes(moved)[2], atol=1e-14)
    np.testing.assert_array_equal(own.irradiance, sun.irradiance)


def test_clouds_are_as_fine_as_the_picture_shows_them() -> None:
    sizes = []
    for width in (320, 1024, 3200):
        camera = demand_hero.cumulus.camera(View(width, width * 3 // 4))
        sizes.append(demand_hero.fineness(camera, HERO))
    assert sizes[0] > 2.5 * sizes[1] > 0.5
    assert sizes[1:] == [demand_hero.FINEST] * 2
    assert demand.fineness(View(1024, 1)) == demand.VOXEL
    assert demand.fineness(View(1, 1)) == demand.COARSEST


def test_the_farthest_cloud_is_drawn_first() -> None:
    front = demand_hero.cumulus.camera(VIEW)
    behind = dataclasses.replace(front, eye=np.array([0.0, 5.0, -2000.0]))
    order = demand_hero.farthest_first(front)
    assert order[-1] is HERO
    assert demand_hero.farthest_first(behind)[0] is HERO
    assert {*order} == {*demand_hero.FIELD, HERO}


def test_the_hero_stands_over_its_field() -> None:
    camera = Camera(demand_hero.OWN.eye, demand_hero.OWN.target, width=48, height=36)
    picture = drawn("", View(48, 36, camera))
    assert [note.split(":")[0] for note in picture.notes] == [
        *["field"] * 5,
        "cloud",
        "scattered light",
    ]
    assert set(picture.seconds) == {"sky", "generate", "march"}
    whites = (picture.linear.min(axis=2) > 0.4).mean(axis=1)
    assert not whites[:6].any(), "clear sky above"
    assert whites[12:30].max() > 0.25, "the cloud in the middle"
    assert whites[30:].max() > 0.05, "the field below"


ONE = {
    "camera": Camera([0, 0, 9], [0, 0, 0], width=8, height=6),
    "suns": (demand.OWN.sun,),
    "medium": Medium(1.0),
    "look": Look(),
}


@pytest.mark.parametrize(
    ("name", "refused"),
    [
        *((name, part) for name in FLAT for part in ONE),
        *((name, "look") for name in (*BOXED, "")),
        *(("faces", part) for part in ("suns", "medium")),
        ("quad", "suns"),
    ],
)
def test_what_a_scene_has_no_use_for_is_refused(name: str, refused: str) -> None:
    view = dataclasses.replace(VIEW, **{refused: ONE[refused]})
    with pytest.raises(ValueError, match=rf"^{refused}: expected none beside [^\n]*$"):
        drawn(name, view)


def test_a_medium_without_lobes_is_refused_and_another_serves() -> None:
    with pytest.raises(ValueError, match=r"^phase: expected 'hg' or 'isotropic'"):
        render("demand-lit", width=16, medium=Medium(10.0))
    thin = render("demand-lit", width=16, medium=Medium(0.1, phase="isotropic"))
    assert np.abs(thin.linear - demand_plane.mended(View(16, 12))).max() < 0.1


def test_an_own_camera_sees_the_box_from_anywhere() -> None:
    inside = Camera([0.9, 0.6, 0.7], [0, 0, 0], fov_y=1.2, width=32, height=24)
    behind = Camera([-2, -1, -4], [0, 0, 0], width=32, height=24)
    for camera in (inside, behind):
        picture = drawn("box", View(9, 9, camera))
        assert picture.linear.shape == (24, 32, 3)
        assert np.isfinite(picture.linear).all()


def test_the_hero_may_be_lit_in_octaves() -> None:
    """So it is where that is said, and in a medium that the solution does not model."""
    tinted = Medium(1.5, [1.0, 0.9, 0.8], 0.6, "hg")
    for view in (
        View(24, 18, scattering="single", tolerance=0.1),
        View(24, 18, medium=tinted, tolerance=0.1),
    ):
        assert not any("scattered" in note for note in drawn("", view).notes)


def test_figures_of_document_d_refuse_solved_light() -> None:
    for name in FLAT + BOXED:
        with pytest.raises(ValueError, match=r"^scattering: expected "):
            drawn(name, dataclasses.replace(VIEW, scattering="multiple"))
