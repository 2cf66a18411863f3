"""What a scene says it is drawn with is what it is drawn with."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import refcloud as rc
from refcloud.conventions import SIZES
from refcloud.declared import KINDS, Cloud, Declaration, scene_from
from refcloud.scene import SCENES, Model, Scene, View, own_of
from refcloud.scenes import cumulus, demand, demand_hero

VIEW = View(16, 12)
# A second or more for their clouds; man-10 stands for them, by the same code.
SLOW = ("man-08", "man-13", "man-14")


def small(name: str) -> Scene:
    """Give a scene, or one of its kind with fewer and smaller clouds."""
    if name == "cumulus":
        of = replace(cumulus.OWN, count=30, field_count=10, field_voxel=6.0, field=())
        return KINDS[name].scene(name, "", of)
    if name == "demand":
        return KINDS[name].scene(name, "", replace(demand_hero.OWN, field=()))
    return SCENES[name]


QUICK = [name for name in sorted(SCENES) if name not in SLOW]
CHOOSE = [(name, None) for name in QUICK]
CHOOSE += [(name, "single") for name in ("cumulus", "demand", "multiple", "man-10")]


@pytest.fixture(scope="module")
def models() -> dict[str, Model]:
    """The clouds of each scene, made once."""
    return {}


@pytest.mark.parametrize(("name", "scattering"), CHOOSE)
def test_a_scene_s_own_parts_draw_its_own_picture(name, scattering, models) -> None:
    """Handing a scene what it says is its own changes no bit."""
    scene, view = small(name), replace(VIEW, scattering=scattering)
    model = models[name] = models.get(name) or scene.model()
    own = own_of(scene, view, model)
    alone = scene.draw(model, view)
    parts = {"suns": own.suns, "medium": own.medium, "look": own.look}
    given = replace(view, camera=own.camera, **parts)
    assert np.array_equal(scene.draw(model, given).linear, alone.linear)
    assert own_of(scene, given, model).scattering == own.scattering
    assert not own.open, "with its clouds at hand all of it can be told"


@pytest.mark.parametrize("name", QUICK)
def test_a_scene_refuses_what_it_does_not_say_it_takes(name, models) -> None:
    scene = small(name)
    model = models[name] = models.get(name) or scene.model()
    own = own_of(scene, VIEW, model)
    for part, other in (
        ("suns", (rc.Sun([0.3, 1.0, 0.2]),)),
        ("medium", rc.Medium(0.7)),
        ("look", rc.Look()),
        ("camera", rc.Camera([0.1, 0.2, 3.0], [0.0, 0.3, 0.0], width=16, height=12)),
    ):
        if getattr(own, part) is None:
            with pytest.raises(ValueError, match=f"^{part}: expected none beside"):
                scene.draw(model, replace(VIEW, **{part: other}))


def test_before_the_clouds_are_made_a_scene_says_what_it_can() -> None:
    for name, scene in SCENES.items():
        early = own_of(scene, VIEW)
        assert (early.camera is None) <= (scene.frames or early.suns != ()), name
        for field in early.open:
            assert field == "sigma_t", name
    assert own_of(SCENES["multiple"], VIEW).open == ("sigma_t",)
    assert own_of(SCENES["man-10"], VIEW).camera is None


def test_a_file_without_sun_and_medium_says_what_is_chosen() -> None:
    small_map = {"diameters": [20, 11, 11], "relief": 2, "cell": 3, "voxel": 2}
    for scattering in ("single", "multiple"):
        cloud = Cloud(small_map, {"count": 10, "method": "quick"})
        declared = Declaration("a", "a", (cloud,), scattering=scattering)
        scene = scene_from(declared)
        assert own_of(scene, VIEW).open == ("sigma_t",)
        model = scene.model()
        own = own_of(scene, VIEW, model)
        given = replace(VIEW, suns=own.suns, medium=own.medium, camera=own.camera)
        first, again = (scene.draw(model, view) for view in (VIEW, given))
        assert np.array_equal(first.linear, again.linear)


def test_a_coloured_medium_has_the_sun_of_light_scattered_once() -> None:
    coloured = rc.Medium(1.0, np.array([1.0, 0.9, 0.8]))
    for name, sun in (
        ("cumulus", cumulus.OWN.single_sun),
        ("demand", demand_hero.OWN.octave_sun),
    ):
        own = own_of(SCENES[name], replace(VIEW, medium=coloured))
        assert own.scattering == "single"
        assert own.suns == (sun,)


def test_one_eye_shows_both_pictures_of_a_pair() -> None:
    own = own_of(SCENES["demand-background"], View(44, 30))
    assert own.camera is not None
    assert own.camera.width == 44
    assert own.camera.fov_y > demand.OWN.fov_y, "each of them is narrow"


def test_a_scene_s_name_alone_tells_its_parts() -> None:
    by_name = own_of("cumulus")
    assert by_name.medium == own_of(SCENES["cumulus"], View(44, 30)).medium
    assert by_name.camera is not None
    assert (by_name.camera.width, by_name.camera.height) == SIZES["final"]


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (("cumulos",), ValueError, "^scene: expected one of cumulus, .*got 'cumulos'"),
        ((3,), TypeError, "^scene: expected a Scene or a text, got 3"),
        (("cumulus", 3), TypeError, "^view: expected a View, got 3"),
        ((), TypeError, "^own_of: missing a required argument: 'scene'"),
    ],
)
def test_what_is_no_scene_is_refused(arguments, error, message) -> None:
    with pytest.raises(error, match=message):
        own_of(*arguments)
