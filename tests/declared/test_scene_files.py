"""Scene files: the scenes' own bits, round trips, refusals that name the key."""

from __future__ import annotations

import dataclasses
import typing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import values_for

import refcloud as rc
from refcloud.declared import (
    KINDS,
    Cloud,
    Declaration,
    Placement,
    declared_kind,
    load_scene,
    save_scene,
    scene_from,
)
from refcloud.declared.reading import checked_table
from refcloud.parameters import parameter_texts
from refcloud.scenes import SCENES, View
from refcloud.scenes.as_files import FILES

HEAD = 'format = "refcloud.scene"\nversion = 1\n'
KIND = HEAD + "kind = "
# A coarse map of it still takes seconds; its parameters come back like all others.
LONG = ("multiple",)
QUICK = ("man-10", "demand-lit", "simple-sky", "shader-c", "demand-worley")
SMALL = Cloud(
    {"diameters": np.array([20.0, 11.0, 11.0]), "cell": 5.0, "relief": 2.0},
    {"count": 12, "seed": 3},
    Placement(np.array([1.0, 2.0, 3.0]), 0.5, 2.0, 400.0, prune=True),
    {"buffer": 64},
)


def same(one: Any, other: Any) -> bool:
    if dataclasses.is_dataclass(one):
        return type(one) is type(other) and all(
            same(getattr(one, f.name), getattr(other, f.name))
            for f in dataclasses.fields(one)
        )
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[k], other[k]) for k in one)
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(same, one, other))
    return bool(np.array_equal(one, other))


@pytest.mark.parametrize("name", FILES)
def test_a_file_gives_its_declaration_again(name: str, tmp_path: Path) -> None:
    path = save_scene(tmp_path / "a.toml", FILES[name])
    assert same(load_scene(path), FILES[name])
    assert scene_from(load_scene(path)).title == SCENES[name].title


@pytest.mark.parametrize("name", QUICK)
def test_a_file_draws_the_scene_to_the_bit(name: str, tmp_path: Path) -> None:
    scene = scene_from(load_scene(save_scene(tmp_path / "a.toml", FILES[name])))
    view = View(32, 24)
    own = SCENES[name].draw(SCENES[name].model(), view)
    np.testing.assert_array_equal(scene.draw(scene.model(), view).linear, own.linear)


@pytest.mark.slow
@pytest.mark.parametrize("name", [n for n in FILES if n not in (*QUICK, *LONG)])
def test_every_file_draws_its_scene_to_the_bit(name: str, tmp_path: Path) -> None:
    test_a_file_draws_the_scene_to_the_bit(name, tmp_path)


@settings(max_examples=8)
@given(data=st.data())
def test_every_number_comes_back_to_the_last_bit(data, tmp_path_factory) -> None:
    def drawn(thing: type, *names: str) -> dict[str, Any]:
        hints = typing.get_type_hints(thing, include_extras=True)
        return {name: data.draw(values_for(hints[name])) for name in names}

    declared = Declaration(
        data.draw(st.text(max_size=8)),
        'a "title"\twith \x7f signs é',
        (SMALL, Cloud({"seed": data.draw(st.integers(-9, 9))})),
        {"eye": np.array([0.1, 0.2, 1e-300]), "target": -np.ones(3), "fov_y": 0.7},
        (rc.Sun([0.3, 0.4, 0.5], **drawn(rc.Sun, "irradiance")),),
        rc.Medium(1.5, **drawn(rc.Medium, "albedo", "g")),
        rc.Look(**drawn(rc.Look, "erosion", "sky_light", "readback")),
        rc.Sky(**drawn(rc.Sky, "zenith", "bend")),
    )
    declared = dataclasses.replace(
        declared,
        camera={**(declared.camera or {}), "target": np.array([0.0, 0.0, -1.0])},
    )
    path = save_scene(tmp_path_factory.mktemp("a") / "a.toml", declared)
    assert same(load_scene(path), declared)


def test_every_named_scene_has_a_file() -> None:
    assert {*FILES} == {*SCENES}


@settings(max_examples=30)
@given(data=st.data())
def test_parameters_of_kinds_come_back_to_the_last_bit(data, tmp_path_factory) -> None:
    def drawn(thing: Any) -> Any:
        hints = typing.get_type_hints(type(thing), include_extras=True)
        changed = {}
        for field in dataclasses.fields(thing):
            value = getattr(thing, field.name)
            if dataclasses.is_dataclass(value):
                changed[field.name] = drawn(value)
            elif type(value) in (int, float, bool, str):
                changed[field.name] = data.draw(values_for(hints[field.name]))
        try:
            return dataclasses.replace(thing, **changed)
        except ValueError:  # two of its numbers do not go together
            return thing

    kind = declared_kind(data.draw(st.sampled_from(sorted(KINDS))))
    changed = dataclasses.replace(kind, name="mine", of=drawn(kind.of))
    path = save_scene(tmp_path_factory.mktemp("a") / "a.toml", changed)
    assert same(load_scene(path), changed)


def test_what_a_kind_s_file_leaves_out_its_scene_has(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(
        HEAD + 'kind = "demand-lit"\n[parameters]\nfov_y = 0.4\n'
        "[parameters.cloud]\nseed = 5\n[parameters.medium]\nsigma_t = 30\n"
    )
    mine, own = load_scene(path).of, KINDS["demand-lit"].own
    assert (mine.fov_y, mine.cloud.seed, mine.medium.sigma_t) == (0.4, 5, 30.0)
    assert (mine.cloud.cell, mine.medium.g) == (own.cloud.cell, own.medium.g)
    assert same(mine.sun, own.sun)
    # And the picture shows it.
    scene = scene_from(load_scene(path))
    picture = rc.render(scene, width=24, height=18).linear
    assert np.abs(picture - rc.render("demand-lit", width=24, height=18).linear).max()


def test_a_field_of_clouds_is_rows_of_a_file(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(HEAD + 'kind = "cumulus"\n[[parameters.field]]\nseed = 3\nx = 9\n')
    (only,) = load_scene(path).of.field
    assert (only.seed, only.x, only.scale) == (3, 9.0, 1.0)


def test_a_declared_scene_is_drawn_and_animated(tmp_path: Path) -> None:
    scene = scene_from(Declaration("mine", "", (SMALL,)))
    picture = rc.render(scene, width=24, height=18)
    assert any(note.startswith("medium: sigma_t") for note in picture.notes)
    made = rc.animate(
        scene,
        tmp_path / "a",
        frames=2,
        moves=rc.Moves(turn_eye=360.0),
        width=24,
        height=18,
    )
    first = rc.load_picture(made.path / "frame-0000.png")
    picture.save(tmp_path / "still.png")
    still = rc.load_picture(tmp_path / "still.png")
    np.testing.assert_array_equal(first.linear, still.linear)


BAD = {
    "x = ": "expected a TOML file, got Invalid",
    'format = "other"\nversion = 1': r'expected format = "refcloud.scene", version = 1',
    HEAD: r"cloud: expected 1 to 1000 tables \[\[cloud\]\], got 0",
    HEAD + "[cloud]": r"cloud: expected tables \[\[cloud\]\], got a dict",
    HEAD + "[[clouds]]": "clouds: expected one of .*; did you mean cloud?",
    HEAD + "[[cloud]]\nshap = 1": r"cloud\[0\].shap: .*did you mean shape?",
    HEAD + "[[cloud]]\nscale = 0": r"cloud\[0\].scale: .*\[1e-06, 1e\+06\], got 0",
    HEAD + "[[cloud]]\nscale = 1e9": r"cloud\[0\].scale: .*, got 1e\+09; choose within",
    HEAD + "[[cloud]]\nair = 1e-300": r"cloud\[0\].air: expected sizes of at least",
    HEAD + "[[cloud]]\n[cloud.shape]\noctaves = 0": r"\[0\].shape.octaves: .*got 0",
    HEAD + "[[cloud]]\n[cloud.balls]\ncount = 2.5": r"balls.count: expected a whole",
    HEAD + "[[cloud]]\n[cloud.balls]\ngrid = 1": r"balls.grid: expected one of count",
    HEAD + "[[cloud]]\n[cloud.look]\nerosion = 1": r"look.erosion: .*\[0, 1\)",
    HEAD + "[[cloud]]\n[[sun]]\ndirection = [0, 1]": r"sun\[0\].direction: .*\(3,\)",
    HEAD + "[[cloud]]\n[[sun]]\ndirection = [0, 0, 0]": r"sun\[0\].direction: .* zero",
    HEAD
    + "[[cloud]]\n[[sun]]\ndirection = [1, 0, 0]\n[[sun]]\ndirection = [0, 0, 0]": (
        r"toml: sun\[1\].direction: expected a vector that is not zero"
    ),
    HEAD + "[[cloud]]\n[medium]\nalbedo = 2": r"medium.albedo: expected .*\[0, 1\]",
    HEAD + "[[cloud]]\n[look]\nlike = 'mann'": "look.like: expected one of 'cumulus'",
    HEAD + "[[cloud]]\n[sky]\nbend = nan": "sky.bend: expected a finite number",
    HEAD + "[[cloud]]\n[camera]\neye = [0, 0, 0]\ntarget = [0, 0, 0]": (
        "camera.target: expected another place than the eye"
    ),
    HEAD + "sky = 3\n[[cloud]]": r"sky: expected a table \[sky\], got 3",
    HEAD + "name = 3\n[[cloud]]": "name: expected a text, got 3",
    HEAD + "scattering = 'twice'\n[[cloud]]": "scattering: expected one of 'single'",
    KIND + '"demand"\n[[cloud]]': "cloud: expected one of kind, name, title, par",
    HEAD + 'kind = "demand-lot"': "kind: expected one of .*, got 'demand-lot'",
    KIND + '"demand-lit"\n[parameters]\nfov = 1': "parameters.fov: .*mean fov_y?",
    KIND + '"demand-lit"\n[parameters]\nfov_y = 9': r"parameters.fov_y: .*radians",
    KIND + '"demand-lit"\nparameters = 3': r"expected a table \[parameters\], got 3",
    KIND + '"demand-lit"\n[parameters.cloud]\nedge = [2,0,0]': "parameters.cloud.edge:",
    KIND + '"demand-lit"\n[parameters.sun]\ndirection = [0,0,0]': (
        "parameters.sun.direction: expected a vector that is not zero"
    ),
    KIND
    + '"cumulus"\n[parameters]\neye = [1,19,0]': "parameters.target: .*than the eye",
    KIND + '"demand"\n[parameters.hero]\nair = 1e-300': "parameters.hero.air: expected",
    KIND + '"demand"\n[parameters.hero]\nscale = 1e9': "hero.scale: .*, got 1e.09; ch",
    KIND + '"demand"\n[[parameters.field]]\nscale = 0': r"field\[0\].scale: expected",
    KIND + '"demand"\n[[parameters.field]]\nx = 1': (
        r"toml: parameters.field\[0\].seed: expected a value, .*, got none"
    ),
    HEAD + "[[cloud]]\n[camera]\ntarget = [0,0,0]": "camera.eye: .* value, .*got none",
    HEAD + "[[cloud]]\n[[sun]]": r"sun\[0\].direction: expected a value, .* got none",
    HEAD + "[[cloud]]\n[medium]\ng = 0": "medium.sigma_t: expected a value, .*got none",
    "a = " + 100_000 * "[": "expected a TOML file, got brackets within brackets",
    "a = " + 10_000 * "9": "expected a TOML file, got a whole number of thousands of",
    f"version = 0x{10_000 * 'f'}": "got None, a number of over 60 digits",
    KIND + '"demand"\n[parameters]\nfield = 3': r"expected tables \[\[parameters.field",
}


@pytest.mark.parametrize("text", BAD, ids=range(len(BAD)))
def test_what_does_not_fit_is_refused_in_one_line(text: str, tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(text)
    with pytest.raises((ValueError, TypeError), match=BAD[text]) as refusal:
        load_scene(path)
    assert "\n" not in str(refusal.value)
    assert str(refusal.value).startswith(f"{path}: ")


def test_no_file_and_no_file_s_kind_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"expected a scene \(.toml\), got no"):
        load_scene(tmp_path / "none.toml")
    with pytest.raises(ValueError, match=r"expected a scene \(.toml\), got a folder"):
        load_scene(tmp_path)
    path = tmp_path / "long.toml"
    path.write_text(1_000_001 * "#")
    line = (
        r"long.toml: expected a scene \(.toml\) of at most 1000000 bytes, got 1000001"
    )
    with pytest.raises(ValueError, match=line):
        load_scene(path)


def test_a_mark_of_utf_8_in_front_is_read_over(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(HEAD + "name = 'é'\n[[cloud]]", "utf-8-sig")
    assert path.read_bytes().startswith(b"\xef\xbb\xbf")
    assert load_scene(path).name == "é"


def test_a_table_is_checked_by_annotations() -> None:
    assert checked_table("medium", {"g": 0}, rc.Medium) == {"g": 0.0}


@pytest.mark.parametrize("name", sorted(KINDS))
def test_a_kind_s_file_says_what_each_parameter_is(name: str, tmp_path: Path) -> None:
    """The comment above a parameter, or above those that share it, is its text."""
    lines = save_scene(tmp_path / "a.toml", FILES[name]).read_text("utf-8").split("\n")
    assert all(len(line) <= 88 for line in lines if line.startswith("#"))
    texts = parameter_texts(type(KINDS[name].own))
    for key, text in texts.items():
        heads = f"{key} = ", f"[parameters.{key}]", f"[[parameters.{key}]]"
        places = [k for k, line in enumerate(lines) if line.startswith(heads)]
        if not places:
            continue  # left to its default, or a row of none
        above: list[str] = []
        for line in reversed(lines[: places[0]]):
            if line.startswith("#"):
                above.insert(0, line[2:])
            elif above or line.startswith("[") or not line:
                break
        assert " ".join(" ".join(above).split()) == " ".join(text.split()), key


def test_the_file_of_cumulus_says_when_its_single_sun_counts(tmp_path: Path) -> None:
    text = save_scene(tmp_path / "a.toml", FILES["cumulus"]).read_text("utf-8")
    for part in ("single_sun", "single_medium"):
        comment = text[: text.index(f"[parameters.{part}]")].rpartition("\n\n")[2]
        assert "# In the place of sun and medium where light is scattered" in comment
        assert "--scattering\n# single" in comment
