"""Light volumes are kept by the caller: same bits, and only while all stands still."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from small_marches import BLOB, MEDIUM, SUN

import refcloud as rc
from refcloud.camera import Camera, rays
from refcloud.cloudmap import VoxelGrid
from refcloud.march import certified, integrate, volumes
from refcloud.optics import Sun
from refcloud.transport import LightVolume, sun_depths

EYE = Camera([2.2, 1.2, 3.0], [0, 0, 0], width=27, height=20)
OTHER_EYE = Camera([-1.2, 1.9, 2.4], [0, 0, 0], width=27, height=20)
HOW = {"medium": MEDIUM, "tolerance": 0.1}
OTHER_SUN = Sun([0.4, 0.6, -0.5])


def seen_by(cloud, eye, **how) -> tuple[rc.Picture, dict]:
    seen: dict = {}
    given = {"camera": eye, "suns": SUN, "observe": seen.__setitem__, **HOW, **how}
    return rc.render(cloud, **given), seen


def test_a_new_eye_keeps_the_light_and_the_bits(monkeypatch) -> None:
    _, before = seen_by(BLOB, EYE)
    kept = before["light volumes"]
    fresh, anew = seen_by(BLOB, OTHER_EYE)
    made = []

    def counted(*args, **how) -> LightVolume:
        made.append(args)
        return sun_depths(*args, **how)

    monkeypatch.setattr(volumes, "sun_depths", counted)
    again, seen = seen_by(BLOB, OTHER_EYE, volumes=(*kept, *anew["light volumes"]))
    assert not made
    assert np.array_equal(again.linear, fresh.linear)
    assert again.notes[-1] == "light volume: reused for 1 of 1 suns"
    assert seen["light volumes"][0] is kept[0]
    assert not any("light volume:" in note for note in fresh.notes)


def test_a_moved_sun_or_another_grid_makes_a_new_volume() -> None:
    kept = seen_by(BLOB, EYE)[1]["light volumes"]
    denser = VoxelGrid(1.1 * BLOB.density, BLOB.lower, BLOB.upper)
    shifted = VoxelGrid(BLOB.density, BLOB.lower + 0.1, BLOB.upper + 0.1)
    for cloud, suns in ((BLOB, OTHER_SUN), (denser, SUN), (shifted, SUN)):
        fresh, _ = seen_by(cloud, EYE, suns=suns)
        again, seen = seen_by(cloud, EYE, suns=suns, volumes=kept)
        assert np.array_equal(again.linear, fresh.linear)
        assert again.notes[-1] == "light volume: reused for 0 of 1 suns"
        assert not {id(v) for v in kept} & {id(v) for v in seen["light volumes"]}
    both, _ = seen_by(BLOB, EYE, suns=(SUN, OTHER_SUN), volumes=kept)
    assert both.notes[-1] == "light volume: reused for 1 of 2 suns"


def test_any_rays_keep_the_light_of_an_equal_cloud() -> None:
    seen: dict = {}
    how = {"suns": SUN, **HOW, "observe": seen.__setitem__}
    fresh, _ = integrate(BLOB, *rays(EYE), **how)
    kept = seen["light volumes"]
    equal = dataclasses.replace(BLOB, density=BLOB.density.copy())
    again, _ = integrate(equal, *rays(EYE), **how, volumes=kept)
    assert np.array_equal(again, fresh)
    assert seen["light volumes"][0] is kept[0]


def test_double_precision_is_left_aside_and_nothing_changes() -> None:
    fresh, _ = seen_by(BLOB, EYE)
    own = sun_depths(certified.volumes_of(BLOB, (SUN,), ()).cloud, SUN.direction)
    again, _ = seen_by(BLOB, EYE, volumes=(own,))
    assert np.array_equal(again.linear, fresh.linear)


def test_what_has_no_use_for_light_volumes_refuses_them() -> None:
    balls = rc.Metaballs([[0, 0, 0.0]], [1.0], [1.0])
    kept = seen_by(BLOB, EYE)[1]["light volumes"]
    for call in (
        lambda: integrate(balls, *rays(EYE), suns=SUN, **HOW, volumes=kept),
        lambda: rc.render(balls, volumes=kept),
        lambda: rc.render("cumulus", volumes=kept),
    ):
        with pytest.raises(ValueError, match=r"^volumes: expected none[^\n]*$"):
            call()
