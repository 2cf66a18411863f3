"""The sun's work is kept: only what changed is carried again; the report says so."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
from small_scenes import BACKDROP, BALLS, EXTENDED, EYE, LOOKS, MEDIUM, SUNS

from refcloud.camera import Camera
from refcloud.lighting import LitMetaballs, eyeward, sunward
from refcloud.lighting import lit as lit_module
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun
from refcloud.render import render

SIDE = dataclasses.replace(EYE, eye=np.array([7.0, 0.0, 0.0]))


def carried(earlier: LitMetaballs, **changed: Any) -> tuple[LitMetaballs, set[str]]:
    """Light balls after an earlier pass; which lights were carried again."""
    seen: set[str] = set()
    how: dict[str, Any] = {
        "balls": earlier.balls,
        "suns": earlier.suns,
        "medium": earlier.medium,
        "look": earlier.look,
    } | changed
    balls, suns = how.pop("balls"), how.pop("suns")
    watch = seen.add
    lit = sunward(
        balls, suns, **how, earlier=earlier, observe=lambda name, value: watch(name)
    )
    fresh = sunward(balls, suns, **how)
    np.testing.assert_array_equal(lit.light, fresh.light)
    np.testing.assert_array_equal(lit.ambient, fresh.ambient)
    return lit, {name.removesuffix(" order") for name in seen if "order" in name}


@pytest.mark.parametrize("look", LOOKS.values(), ids=LOOKS)
def test_l15_only_what_changed_is_carried_again(look) -> None:
    lit = sunward(BALLS, SUNS, medium=MEDIUM, look=look)
    sky = {"sky", "ground"} if look.sky_light.any() else set()
    lit_again, again = carried(lit)
    assert again == set()
    (row,) = lit_again.skipped
    assert (row.stage, row.skipped, row.of, row.bound) == ("light", 4, 4, 0.0)
    moved = Sun([0, 1, 5])
    assert carried(lit, suns=(SUNS[0], moved))[1] == {"sun 1"}
    assert carried(lit, suns=SUNS[::-1])[1] == set()
    assert carried(lit, suns=(*SUNS, moved))[1] == {"sun 2"}
    brighter = dataclasses.replace(SUNS[0], irradiance=2.0 * SUNS[0].irradiance)
    assert carried(lit, suns=(brighter, SUNS[1]))[1] == {"sun 0"}
    centers = BALLS.centers.copy()
    centers[3, 1] += 1e-9
    everything = {"sun 0", "sun 1"} | sky
    for changed in (
        {"balls": dataclasses.replace(BALLS, centers=centers)},
        {"balls": dataclasses.replace(BALLS, densities=1.01 * BALLS.densities)},
        {"balls": dataclasses.replace(BALLS, kernel="gaussian")},
        {"medium": Medium(1.6, 0.9)},
        {"look": dataclasses.replace(look, buffer=17)},
    ):
        assert carried(lit, **changed)[1] == everything
    # The phase function is the eye's (E26).
    assert carried(lit, medium=Medium(1.5, 0.9, 0.3, "hg"))[1] == set()


def test_l15_lit_balls_serve_any_eye_and_the_report_says_so() -> None:
    lit = sunward(BALLS, SUNS, medium=MEDIUM, look=EXTENDED)
    for eye in (EYE, SIDE):
        seen: set[str] = set()
        picture = render(
            lit,
            camera=eye,
            background=BACKDROP,
            observe=lambda name, value, seen=seen: seen.add(name),
        )
        assert not [name for name in seen if name.startswith(("sun", "sky", "ground"))]
        assert "light: reused for 1 of 1 clouds" in picture.notes
        fresh = render(
            BALLS,
            camera=eye,
            background=BACKDROP,
            suns=SUNS,
            medium=MEDIUM,
            look=EXTENDED,
        )
        np.testing.assert_array_equal(picture.linear, fresh.linear)
        assert not [note for note in fresh.notes if "reused" in note]
    assert render(lit).linear.shape == (768, 1024, 3)  # framed as balls are


def test_l15_gain_and_depths_are_found_once_for_all_eyes(monkeypatch) -> None:
    asked: list[str] = []
    for name in ("gain_of", "ball_depths"):
        found = getattr(lit_module, name)
        monkeypatch.setattr(
            lit_module,
            name,
            lambda *args, name=name, found=found: asked.append(name) or found(*args),
        )
    lit = sunward(BALLS, SUNS, medium=MEDIUM, look=EXTENDED)
    for eye in (EYE, SIDE, EYE):
        eyeward(lit, eye)
    assert sorted(asked) == ["ball_depths", "gain_of"]  # a grey medium has one depth
    fresh = sunward(BALLS, SUNS, medium=MEDIUM, look=EXTENDED)
    np.testing.assert_array_equal(eyeward(lit, SIDE)[0], eyeward(fresh, SIDE)[0])


@pytest.mark.parametrize(
    ("name", "part"), [("suns", SUNS), ("medium", MEDIUM), ("look", "man")]
)
def test_what_lit_balls_bring_is_not_taken_twice(name: str, part: Any) -> None:
    lit = sunward(BALLS, SUNS, medium=MEDIUM, look=EXTENDED)
    with pytest.raises(ValueError, match=rf"^{name}: expected none beside lit balls"):
        render(lit, camera=Camera([0, 0, 9], [0, 0, 0]), **{name: part})


def test_an_empty_cloud_has_no_light_to_keep() -> None:
    nothing = Metaballs(np.zeros((0, 3)), [], [])
    lit = sunward(nothing, SUNS, medium=MEDIUM, look=EXTENDED)
    assert carried(lit)[1] == set()
