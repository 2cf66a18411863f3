"""Document S's scenes: both ways to draw them, what is handed on, loops that close."""

from __future__ import annotations

import dataclasses
import math
from functools import partial

import numpy as np
import pytest

from refcloud.camera import Camera
from refcloud.image import Picture
from refcloud.scenes import SCENES, View, shader, shader_light, shader_objects
from refcloud.scenes.shader_particles import blended_pixels
from refcloud.sky import Sphere

VIEW = View(48, 36)
NAMES = sorted(name for name in SCENES if name.startswith("shader-"))
SKIES = {
    "shader-b": shader.solid_sky,
    "shader-c": shader.plane_sky,
    "shader-dome": shader.textured_sky,
    "shader-poles": partial(shader.textured_sky, surface=Sphere()),
    "shader-volume": shader.volume_sky,
}


def drawn(name: str, **how) -> Picture:
    scene = SCENES[name]
    return scene.draw(scene.model(), dataclasses.replace(VIEW, **how))


@pytest.mark.parametrize("name", NAMES)
def test_every_scene_is_a_finite_picture_that_shows_something(name: str) -> None:
    light = drawn(name).linear
    assert light.shape == (36, 48, 3)
    assert light.min() >= 0.0
    assert light.max() < 2.0
    assert np.std(light) > 0.05


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("size", [(1, 1), (7, 5)])
def test_pictures_of_any_size_and_time(name: str, size: tuple[int, int]) -> None:
    light = drawn(name, width=size[0], height=size[1], time=-3.3e5).linear
    assert light.shape == (*size[::-1], 3)
    assert np.isfinite(light).all()


@pytest.mark.parametrize(("name", "draw"), SKIES.items(), ids=list(SKIES))
def test_skies_by_triangles_look_like_skies_by_rays(name: str, draw) -> None:
    scene = SCENES[name]
    rays, triangles = (
        draw(scene.model(), VIEW, way=way).linear for way in ("rays", "triangles")
    )
    off = np.abs(rays - triangles).max(axis=-1)
    # Facets lie 3e-4 of the radius inside, or corners off by 1/256 pixel; clouds' edges
    # change light by some 10 per cell. At the plane's horizon a pixel holds many cells.
    assert np.median(off) < 3e-3
    assert np.quantile(off, 0.98) < 0.06


MOVING = [n for n in NAMES if math.isfinite(SCENES[n].motion.period or math.inf)]


@pytest.mark.parametrize("name", MOVING)
def test_a_scene_with_a_period_closes(name: str) -> None:
    period = SCENES[name].motion.period
    assert period is not None
    first, last, other = (
        drawn(name, time=t).linear for t in (0.0, period, 0.37 * period)
    )
    np.testing.assert_allclose(last, first, atol=1e-9)
    if name != "shader-background":
        assert np.abs(other - first).max() > 0.1
    else:
        assert (other == first).all(), "the baseline never moves"


REPEATING = [
    n
    for n in NAMES
    if any(math.isfinite(r) for r in SCENES[n].motion.repeats or (math.inf,))
]


@pytest.mark.parametrize("name", REPEATING)
def test_wind_brings_the_same_sky_again(name: str) -> None:
    repeats = SCENES[name].motion.repeats
    assert repeats is not None
    once = np.array([r if math.isfinite(r) else 0.0 for r in repeats])
    first = drawn(name).linear
    np.testing.assert_allclose(drawn(name, offset=once).linear, first, atol=1e-9)
    assert np.abs(drawn(name, offset=0.37 * once).linear - first).max() > 0.1


@pytest.mark.parametrize("name", ["shader-b", "shader-c", "shader-dome", "shader-lit"])
def test_an_eye_that_stands_still_finds_its_places_once(name: str) -> None:
    kept: dict = {}
    fresh = [drawn(name, time=t) for t in (0.0, 1.0)]
    first, later = (drawn(name, time=t, kept=kept) for t in (0.0, 1.0))
    for one, other in zip(fresh, (first, later), strict=True):
        np.testing.assert_array_equal(one.linear, other.linear)
    known = [row for row in later.skipped if "known already" in row.what]
    assert [(row.skipped, row.of, row.bound) for row in known] == [
        (48 * 36, 48 * 36, 0)
    ]
    assert not any("known already" in row.what for row in first.skipped)
    turned = Camera([0, 0, 0], [0.3, 0.7, -1], width=48, height=36)
    again = drawn(name, camera=turned, kept=kept)
    assert not any("known already" in row.what for row in again.skipped)


@pytest.mark.parametrize("name", ["shader-b", "shader-c", "shader-dome"])
def test_single_precision_stays_within_what_it_tells(name: str) -> None:
    exact, quick = drawn(name), drawn(name, tolerance=1 / 255)
    bound = sum(row.bound for row in quick.skipped if row.stage == "sky")
    off = np.abs(exact.linear - quick.linear).max()
    assert 0.0 < off <= bound < 1e-4


def test_a_fractal_drawn_before_gives_the_picture_of_one_summed_at_every_sample():
    model, small = SCENES["shader-lit"].model(), VIEW
    direct = shader_light.lit_layer(model, small, direct=True).linear
    sampled = shader_light.lit_layer(model, small).linear
    off = np.abs(direct - sampled).max(axis=-1)
    # 128 texels for 16 cells: octaves finer than 1/8 of a cell are left out, which have
    # 1/8 of the noise and less, and the third is between texels linearly.
    finer = dataclasses.replace(VIEW, width=192, height=144)
    direct_too = shader_light.lit_layer(model, finer, direct=True).linear
    sampled_too = shader_light.lit_layer(model, finer).linear
    off_too = np.abs(direct_too - sampled_too).max(axis=-1)
    assert np.median(off) < 0.05
    assert np.median(off_too) < 0.6 * np.median(off)


def test_opposite_signs_have_light_edges_and_the_first_try_has_dark_ones() -> None:
    light = drawn("shader-cover", width=204, height=144).linear
    first, second = light[:, :100], light[:, 104:]
    assert second.mean() > first.mean()


def test_e29_printed_fog_drowns_the_near_and_clears_the_far() -> None:
    light = drawn("shader-fog", width=204, height=144).linear
    printed, mended = light[:, :100], light[:, 104:]
    near = np.s_[-4:]
    grey = shader_light.GREY
    # Some 1.3 units away: e^-(4 - 1.3) = 0.07 of the ground's light is left.
    assert np.abs(printed[near] - grey).max() < 0.07
    assert np.abs(mended[near] - grey).mean() > 0.1
    far = np.s_[73:75]  # the ground below the horizon
    clear, hazy = (np.median(np.abs(half[far] - grey)) for half in (printed, mended))
    assert clear > 1.5 * hazy


def test_a_ball_carved_from_noise_has_no_pole() -> None:
    light = drawn("shader-a", width=256, height=256).linear.mean(axis=-1)
    # Around the pole, seen at the upper part of each ball: the mapped one's rays.
    variation = []
    for panel in (
        light[:128, :128],
        light[:128, 128:],
        light[128:, :128],
        light[128:, 128:],
    ):
        ring = panel[20:40, 54:74]
        variation.append(np.abs(np.diff(ring, axis=1)).mean())
    assert variation[1] > 1.5 * variation[0], "classic"
    assert variation[3] > 1.5 * variation[2], "simplex"


def test_particles_tell_how_many_pixels_they_blend() -> None:
    scene = SCENES["shader-particles"]
    model = scene.model()
    picture = scene.draw(model, VIEW)
    eye = scene.motion.eye
    assert eye is not None
    count = blended_pixels(model.clouds["field"], eye(model, VIEW))
    assert f"blended: {count} pixels of 2496 particles" in picture.notes[-1]
    larger = blended_pixels(
        model.clouds["field"],
        eye(model, dataclasses.replace(VIEW, width=96, height=72)),
    )
    assert larger == pytest.approx(4 * count, rel=0.1)


def test_the_bubble_hides_its_far_side() -> None:
    mesh = shader_objects.bubble_mesh(0.5)
    away = np.linalg.norm(mesh.points, axis=1)
    assert 0.58 <= away.min() < 1.0 < away.max() <= 1.42
    assert mesh.attributes.shape == (len(mesh.points), 6)


def test_intermediates_can_be_looked_at() -> None:
    for name, what in (
        ("shader-dome", "texture"),
        ("shader-volume", "volume"),
        ("shader-lit", "transmittance"),
        ("shader-d", "density"),
    ):
        seen: dict = {}
        drawn(name, observe=seen.__setitem__)
        assert np.asarray(seen[what]).size > 100


def test_what_a_texture_has_no_use_for_is_refused() -> None:
    for name in ("shader-b", "shader-lit", "shader-e", "shader-d"):
        with pytest.raises(ValueError, match="look: expected none beside a sky"):
            drawn(name, look="man")
    with pytest.raises(ValueError, match="camera: expected none"):
        drawn("shader-a", camera=Camera([0, 0, 1], [0, 0, 0]))


def test_surfaces_can_be_looked_at_from_anywhere() -> None:
    below = Camera([0.0, -30.0, 0.0], [0, 0, 1], width=24, height=18)
    assert np.isfinite(drawn("shader-dome", camera=below).linear).all()
    out = Camera([0, 0, 5], [0, 0, 0], width=24, height=18)
    assert np.isfinite(drawn("shader-b", camera=out).linear).all()
    assert isinstance(shader.AROUND, Sphere)
