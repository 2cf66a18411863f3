"""Work that nobody asked to leave out: dark lights, empty views, what did not change.

Each test counts calls or places; that the picture is the same stands in
``test_skipping.py`` or beside the counts.
"""

from __future__ import annotations

import dataclasses
import importlib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from small_marches import BLOB, SUN
from small_marches import MEDIUM as HAZY
from small_scenes import BACKDROP, BALLS, EXTENDED, EYE, MEDIUM, SUNS

from refcloud.camera import Camera
from refcloud.cloudmap import VoxelGrid
from refcloud.compose import Layer, draw_layers
from refcloud.conventions import Skipped
from refcloud.lighting import Octaves, octave_march, sunward
from refcloud.metaballs import Metaballs
from refcloud.optics import Medium, Sun
from refcloud.render import render

DARK = Sun([0, 1, 0], [0, 0, 0])
FRONT = Camera([2.2, 1.2, 3.0], [0, 0, 0], width=27, height=20)
AWAY = Camera([2.2, 1.2, 3.0], [9, 5, 12], width=27, height=20)
EMPTY = VoxelGrid(np.zeros((3, 4, 5)), [-1, -1, -1], [1, 1, 1])
NOTHING = Metaballs(np.zeros((0, 3)), [], [])
TOLERANCES = [0.0, 0.1]
MARCHED = {"suns": (SUN,), "medium": HAZY, "background": [0.1, 0.2, 0.3]}


@pytest.fixture
def count(monkeypatch) -> Callable[..., list[int]]:
    """Count what a function of a module is given: one number for each call."""

    def count(
        module: str, name: str, size: Callable[..., int] = lambda *_: 1
    ) -> list[int]:
        found = importlib.import_module(f"refcloud.{module}")
        real, calls = getattr(found, name), []

        def counted(*args: Any, **how: Any) -> Any:
            calls.append(size(*args))
            return real(*args, **how)

        monkeypatch.setattr(found, name, counted)
        return calls

    return count


def test_a_sun_without_light_is_not_carried(count) -> None:
    carried = count("lighting.sunward", "sized_share")
    how = {"medium": MEDIUM, "look": EXTENDED}
    sunward(BALLS, SUNS, **how)
    assert sum(carried) == len(SUNS) + 2  # sky and ground
    carried.clear()
    sunward(BALLS, (DARK, SUNS[0], DARK), **how)
    assert sum(carried) == 1 + 2


@pytest.mark.parametrize("tolerance", TOLERANCES)
def test_a_marched_sun_without_light_has_no_columns(count, tolerance) -> None:
    volumes = count("march.volumes", "sun_depths")
    columns = count("march.exact", "far_of")
    cuts = count("march.exact", "cut", lambda grid, o, d, suns: len(suns))
    how = MARCHED | {"camera": FRONT, "tolerance": tolerance}
    render(BLOB, **how)
    one = [sum(calls) for calls in (volumes, columns, cuts)]
    for calls in (volumes, columns, cuts):
        calls.clear()
    picture = render(BLOB, **(how | {"suns": (DARK, SUN)}))
    assert [sum(calls) for calls in (volumes, columns, cuts)] == one
    assert Skipped("light", "suns without light", 1, 2) in picture.skipped


def test_no_light_is_marched_where_nothing_scatters(count) -> None:
    columns = count("march.exact", "far_of")
    black = dataclasses.replace(HAZY, albedo=0.0)
    picture = render(BLOB, **(MARCHED | {"camera": FRONT, "medium": black}))
    assert not columns
    assert Skipped("light", "suns without light", 1, 1) in picture.skipped


def test_a_solved_sun_without_light_has_no_columns(count) -> None:
    solved = count("transport.scattering", "sun_depths")
    seen: dict[str, Any] = {}
    how = MARCHED | {"camera": FRONT, "scattering": "multiple", "tolerance": 0.1}
    both = how | {"suns": (SUN, DARK)}
    alone = render(BLOB, **how)
    assert sum(solved) == 1
    picture = render(BLOB, **both, observe=seen.__setitem__)
    assert sum(solved) == 2
    np.testing.assert_array_equal(picture.linear, alone.linear)
    again = render(BLOB, **(both | {"scattering": seen["scattered light"]}))
    assert sum(solved) == 2
    np.testing.assert_array_equal(again.linear, alone.linear)


def test_octaves_make_no_columns_for_lights_without_light(count) -> None:
    columns = count("lighting.octave_march", "sun_depths")
    off = {"sky_light": np.zeros(3), "ground_light": np.zeros(3)}
    how = {"medium": Medium(4.0, phase="hg"), "step": 0.1}
    octave_march(BLOB, FRONT, suns=(DARK, SUN), octaves=Octaves(**off), **how)
    assert sum(columns) == 1


@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize(
    ("cloud", "camera", "rows"),
    [
        (NOTHING, EYE, set()),
        (
            BALLS,
            dataclasses.replace(EYE, target=2.0 * EYE.eye),
            {
                Skipped("light", "lights of clouds off the picture", 4, 4),
                Skipped("eye", "balls off the picture", 6, 6),
            },
        ),
    ],
    ids=["no balls", "all behind the camera"],
)
def test_a_cloud_that_cannot_show_is_neither_lit_nor_drawn(
    cloud, camera, rows, tolerance, count
) -> None:
    lit = count("lighting.sunward", "sized_share")
    drawn = count("lighting.eyeward", "seen_by")
    layers = [Layer(cloud, MEDIUM, EXTENDED)] * 2
    for background in (BACKDROP, "transparent"):
        picture = draw_layers(layers, camera, SUNS, background, tolerance=tolerance)
        assert not lit
        assert not drawn
        assert {
            dataclasses.replace(r, skipped=r.skipped // 2, of=r.of // 2)
            for r in picture.skipped
        } == rows
        if background is BACKDROP:
            np.testing.assert_array_equal(picture.linear, BACKDROP)
            assert picture.alpha is None
        else:
            assert not picture.linear.any()
            assert not picture.alpha.any()


@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize(
    ("cloud", "camera"),
    [(EMPTY, FRONT), (BLOB, AWAY)],
    ids=["no density", "all behind the camera"],
)
def test_rays_past_the_density_look_up_nothing(cloud, camera, tolerance, count) -> None:
    volumes = count("march.volumes", "sun_depths")
    placed = count("march.exact", "far_of", lambda points, *_: len(points.ray))
    slabs = count("march.fast", "as_slabs")
    sliced = count("march.certified", "sliced")
    picture = render(cloud, **MARCHED, camera=camera, tolerance=tolerance)
    assert (picture.linear == [0.1, 0.2, 0.3]).all()
    assert sum(volumes) == sum(placed) == sum(slabs) == sum(sliced) == 0


def test_an_empty_grid_is_solved_in_a_sweep_of_eight_voxels() -> None:
    seen: dict[str, Any] = {}
    picture = render(
        EMPTY,
        **MARCHED,
        camera=FRONT,
        scattering="multiple",
        observe=seen.__setitem__,
    )
    assert (picture.linear == [0.1, 0.2, 0.3]).all()
    assert seen["scattered light"].shape == (2, 2, 2)
    assert set(seen["scattered light"].iterations) == {1}


@pytest.mark.parametrize("scattering", ["single", "multiple"])
def test_another_eye_makes_no_light_anew(count, scattering) -> None:
    seen: dict[str, Any] = {}
    # So large that the coarsest volume serves both eyes, whatever light is left to it.
    how = MARCHED | {"tolerance": 0.3}
    render(BLOB, **how, camera=FRONT, scattering=scattering, observe=seen.__setitem__)
    made = [
        count("march.volumes", "sun_depths"),
        count("transport.scattering", "sun_depths"),
        count("transport.scattering", "solve"),
    ]
    kept = seen["light volumes"]
    light = seen.get("scattered light", "single")
    side = dataclasses.replace(FRONT, eye=[3.0, 1.2, 2.2])
    render(BLOB, **how, camera=side, scattering=light, volumes=kept)
    assert [sum(calls) for calls in made] == [0, 0, 0]
