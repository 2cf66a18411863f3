"""A recipe runs, keeps its stages, and is written as the Python that gives the same."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import refcloud as rc
from refcloud.refusal import complaint
from refcloud.scene import Model, Scene, View, enter
from refcloud.studio import setups
from refcloud.studio.named import setup_of
from refcloud.studio.recipe import Call, Kept, Name, Recipe, Stage, cooked, written
from refcloud.studio.scene_file import scene_of, scene_text
from refcloud.studio.setups import Frame, frame_of

SMALL = Frame(16, 12)
COARSE = Frame(16, 12, coarse=True)
# Small clouds: the same calls in little time.
LITTLE = {"generate": {"diameters": [20, 11, 11], "relief": 2, "cell": 3, "voxel": 2}}
VALUES: dict[str, dict[str, Any]] = {
    "cloud": {
        **LITTLE,
        "approximate": {"count": 20, "method": "quick"},
        "look": {"buffer": 32, "sky_buffer": 16},
        "haze": {"length": 500.0},
        "second_sun": {},
        "file": {"exposure": 0.8, "dither": False},
    },
    "march": {**LITTLE, "quality": {"tolerance": 0.2}},
    "box": {"box": {"lengths": [2.5, 1.5, 1.6]}, "texture": {"voxel": 0.2}},
    "noise": {"noise": {"size": 16, "kind": "simplex"}},
    "demand-worley": {},
    "demand-lit": {"sun": {"direction": [0, 1, 0]}, "second_sun": {}},
}


def picture_of(name: str, frame: Frame, kept: Kept) -> rc.Picture:
    setup = setups()[name]
    recipe = setup.recipe(setup.taken(VALUES[name]), frame)
    return cooked(recipe, kept, coarse=frame.coarse)[recipe.stages[-1].name]


@pytest.mark.parametrize("name", VALUES)
def test_the_python_makes_the_page_s_picture(name, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    setup = setups()[name]
    values = setup.taken(VALUES[name])
    recipe = setup.recipe(values, SMALL)
    text = recipe.python("picture.png")
    assert all(len(line) <= 88 for line in text.splitlines())
    names: dict[str, Any] = {}
    exec(compile(text, name, "exec"), names)
    drawn = picture_of(name, SMALL, Kept())
    assert np.array_equal(names["picture"].linear, drawn.linear)
    codes = rc.load_picture("picture.png").codes(tone="none", dither=False)
    assert np.array_equal(codes, drawn.codes(**recipe.saving))


@pytest.mark.parametrize("name", VALUES)
def test_coarse_frames_of_every_kind_are_drawn(name) -> None:
    drawn = picture_of(name, COARSE, Kept())
    assert np.isfinite(drawn.linear).all()
    assert drawn.linear.max() > 0.0


@pytest.mark.parametrize("name", VALUES)
def test_scenes_survive_their_file(name) -> None:
    setup = setups()[name]
    values = setup.taken(VALUES[name])
    found, again = scene_of(scene_text(setup, values))
    assert found is setup
    recipe = setup.recipe(values, SMALL)
    assert setup.recipe(again, SMALL).python("a") == recipe.python("a")


def test_blocks_that_are_off_stay_off_in_a_file() -> None:
    setup = setups()["cumulus"]
    values = setup.taken({"medium": None, "camera": {"fov_y": 0.4}})
    text = scene_text(setup, values)
    assert 'medium = "off"' in text
    assert scene_of(text)[1]["medium"] is None
    assert "fov_y=0.4" in setup.recipe(values, SMALL).python("a")


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("", "scene: expected format"),
        ("[", "scene: expected a TOML file"),
        ("a = " + "[" * 5000, "scene: expected a TOML file"),
        ('format = "refcloud.studio"\nversion = 2', "scene: expected format"),
        (
            'format = "refcloud.studio"\nversion = 1\nscene = "sun"',
            "scene: expected one of cloud",
        ),
        (
            'format = "refcloud.studio"\nversion = 1\nscene = "cloud"\nlook = 7',
            "look: expected values by name",
        ),
        (
            'format = "refcloud.studio"\nversion = 1\nscene = "cloud"\n'
            "[look]\nerosion = 1.5",
            "look.erosion: expected a finite number in [0, 1)",
        ),
    ],
)
def test_other_files_are_refused_in_one_line(text, line) -> None:
    with pytest.raises((ValueError, TypeError)) as refusal:
        scene_of(text)
    assert str(refusal.value).startswith(line)
    assert "\n" not in str(refusal.value)


class Counted:
    """A function that counts its calls."""

    def __init__(self) -> None:
        self.calls: list[int] = []

    def __call__(self, value: int, *, times: int = 1) -> int:
        self.calls.append(value)
        return value * times


def recipe_of(first: Counted, last: Counted, value: int, times: int) -> Recipe:
    start = Call("first", first, (value,))
    end = Call("last", last, (Name("a"),), {"times": times})
    return Recipe((Stage("a", start, start.but(times=3)), Stage("b", end)), {})


def test_stages_are_kept_and_coarse_ones_give_way_to_them() -> None:
    first, last, kept = Counted(), Counted(), Kept()
    assert cooked(recipe_of(first, last, 5, 2), kept, coarse=True)["b"] == 30
    assert cooked(recipe_of(first, last, 5, 2), kept)["b"] == 10
    assert first.calls == [5, 5], "the coarse form, then the stage itself"
    assert cooked(recipe_of(first, last, 5, 7), kept, coarse=True)["b"] == 35
    assert first.calls == [5, 5], "what is kept is better than coarse"
    assert cooked(recipe_of(first, last, 6, 7), kept)["b"] == 42
    assert first.calls == [5, 5, 6]
    assert last.calls == [15, 5, 5, 6], "the last stage runs each time"


def test_what_is_kept_has_a_bound() -> None:
    kept = Kept(most=1000)
    for k in range(5):
        kept.keep(str(k), np.zeros(50))  # 400 bytes each
    assert list(kept.results) == ["3", "4"]
    kept.find("3")
    kept.keep("5", np.zeros(50))
    assert list(kept.results) == ["3", "5"]
    kept.keep("large", np.zeros(500))
    assert not kept.results


def test_values_are_written_so_that_they_read_back() -> None:
    for value in (1 / 255, 8 / 255, 0.1, 3, True, None, "a'b", (1, 2.5), (7,)):
        assert eval(written(value)) == value
    assert written(1 / 255) == "1 / 255"
    assert eval(written(np.array([0.1, 1e-30, -5.0]))) == [0.1, 1e-30, -5.0]


def test_a_scene_at_its_start_is_left_to_itself() -> None:
    for name in rc.scenes.SCENES:
        setup = setups()[name]
        text = setup.recipe(setup.taken({}), SMALL).python("a.png")
        call = f"rc.render('{name}', width=16, height=12, tolerance=1 / 255)"
        assert call in text


def test_starting_values_of_scenes_are_their_own() -> None:
    """Writing the blocks out gives the picture that the scene gives by itself."""
    for name in ("demand-lit", "demand-quad"):
        setup = setups()[name]
        values = setup.taken({})
        alone = cooked(setup.recipe(values, SMALL), Kept())["picture"]
        direction = [float(v) for v in rc.scenes.demand.OWN.sun.direction]
        moved = {"camera": {"up": [0, 2, 0]}}
        if name == "demand-lit":
            moved |= {"sun": {"direction": direction}, "medium": {"g": 0.2 + 1e-16}}
        other = cooked(setup.recipe(setup.taken(moved), SMALL), Kept())["picture"]
        assert np.allclose(alone.linear, other.linear, atol=1e-6)


def test_coarse_clouds_that_are_kept_give_the_same_bits() -> None:
    small = {"width": 24, "height": 18, "tolerance": 1 / 255}
    first, again = (rc.render("demand", **small) for _ in range(2))
    # An observer sees the clouds made, so they are made.
    seen: list[str] = []
    made = rc.render("demand", **small, observe=lambda name, value: seen.append(name))
    assert "layers" in seen
    assert np.array_equal(first.linear, again.linear)
    assert np.array_equal(first.linear, made.linear)


def test_scenes_that_nobody_knows_yet_are_offered_with_all_parts() -> None:
    seen: list[View] = []

    def draw(model: Model, view: View) -> rc.Picture:
        seen.append(view)
        if view.look is not None:
            raise ValueError(complaint("look", "none", "one"))
        return rc.Picture(np.ones((view.height, view.width, 3)))

    scene = Scene("new", "a new scene", lambda: Model({}), draw)
    setup = setup_of(scene)
    on = [g.key for g in setup.groups if g.on]
    assert on == ["quality", "file"], "the scene keeps its own until it is asked"
    enter(scene)
    try:
        recipe = setup.recipe(setup.taken({}), SMALL)
        assert cooked(recipe, Kept())["picture"].linear.shape == (12, 16, 3)
        assert seen[-1].camera is None
        moved = setup.recipe(setup.taken({"camera": {}}), SMALL)
        cooked(moved, Kept())
        assert seen[-1].camera.width == 16
        with pytest.raises(ValueError, match="look: expected none"):
            cooked(setup.recipe(setup.taken({"look": {}}), SMALL), Kept())
    finally:
        del rc.scenes.SCENES["new"]


def test_sizes_have_bounds() -> None:
    assert frame_of(2048, 1536).width == 2048
    for size in ((2049, 10), (10, 1537), (0, 5), (5, -1)):
        with pytest.raises(ValueError, match="size: expected 1 x 1 to 2048 x 1536"):
            frame_of(*size)
