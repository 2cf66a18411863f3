"""A tolerance for the whole picture: the measured error of every scene stays below it.

Scenes are named ones, at five tolerances, and generated ones. The exact picture is that
of tolerance 0; of light scattered many times it is the finest solution on its grid.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from small_marches import blob
from twins.lighting import scattered_balls
from twins.march import directions

import refcloud as rc
from refcloud.bench.timing import Row, timed
from refcloud.bench.tolerance import (
    KINDS,
    asked_and_measured,
    depends,
    drawn,
    scenes_at,
)
from refcloud.bench.tolerance_plot import ASKED, NAME, asked_figure
from refcloud.camera import Camera
from refcloud.image import load_picture
from refcloud.optics import Medium, Sun
from refcloud.scene import SCENES

WIDTH = 32
PARTS = ("demand-quad", "man-10")  # small ones, for what needs no more
WHOLE = "displayed white"


def off_and_told(name: str, tolerance: float, exact: np.ndarray) -> tuple[float, float]:
    """Draw a scene: its largest error, and the sum of all bounds in its report."""
    found = drawn(name, WIDTH, tolerance)
    told = sum(row.bound for row in found.skipped if row.unit == WHOLE)
    return float(np.abs(found.linear - exact).max()), told


@pytest.mark.slow
@pytest.mark.parametrize("name", list(SCENES))
def test_named_scenes_keep_every_tolerance(name: str) -> None:
    exact = drawn(name, WIDTH, 0.0).linear
    for tolerance in ASKED:
        off, told = off_and_told(name, tolerance, exact)
        assert off <= tolerance, tolerance
        assert told <= tolerance * (1.0 + 1e-9), tolerance


@pytest.mark.parametrize("name", PARTS)
def test_some_scenes_keep_every_tolerance(name: str) -> None:
    exact = drawn(name, WIDTH, 0.0).linear
    for tolerance in ASKED:
        off, told = off_and_told(name, tolerance, exact)
        assert off <= tolerance
        assert told <= tolerance * (1.0 + 1e-9)


def test_pictures_of_the_plane_have_nothing_to_do_with_a_tolerance() -> None:
    assert not depends("demand-worley")
    assert depends("demand-quad")


tolerances = st.floats(-4.0, -1.0).map(lambda power: 10.0**power)


def balls_off(data: st.DataObject) -> None:
    """Draw generated balls by both passes, exactly and to a tolerance."""
    seed = data.draw(st.integers(0, 2**40), label="seed")
    balls = scattered_balls(seed, data.draw(st.integers(1, 60), label="balls"))
    tolerance = data.draw(tolerances, label="tolerance")
    look = data.draw(st.sampled_from(["man", "cumulus"]), label="look")
    width = data.draw(st.sampled_from([24, 48, 96]), label="width")
    suns = tuple(
        Sun(way) for way in data.draw(st.lists(directions(), min_size=1, max_size=2))
    )
    how = {
        "camera": Camera([0.5, 1.0, 7.0], [0, 0, 0], width=width, height=width),
        "suns": suns,
        "medium": Medium(data.draw(st.floats(0.1, 9.0), label="sigma"), 0.9),
        "look": look,
    }
    exact = rc.render(balls, **how).linear
    found = rc.render(balls, tolerance=tolerance, **how).linear
    assert np.abs(found - exact).max() <= tolerance + 1e-12


def many_times_off(data: st.DataObject) -> None:
    """March a generated cloud under light of every order, to a tolerance."""
    shape = data.draw(st.tuples(*[st.integers(4, 9)] * 3), label="shape")
    cloud = blob(shape, data.draw(st.integers(0, 2**40), label="seed"))
    assume(cloud.density.any())
    depth = 10.0 ** data.draw(st.floats(-1.0, 1.0), label="depth of a voxel")
    edge = float(((cloud.upper - cloud.lower) / np.array(shape[::-1])).max())
    eye = 4.0 * np.array(data.draw(directions(), label="eye"))
    how = {
        "camera": Camera(eye, [0, 0, 0], fov_y=0.8, width=9, height=9),
        "suns": Sun(data.draw(directions(), label="sun")),
        "medium": Medium(
            depth / (edge * cloud.density.max()),
            data.draw(st.sampled_from([1.0, 0.9]), label="albedo"),
            data.draw(st.floats(-0.5, 0.8), label="g"),
            "hg",
        ),
        "scattering": "multiple",
    }
    tolerance = data.draw(tolerances, label="tolerance")
    exact = rc.render(cloud, **how).linear
    found = rc.render(cloud, tolerance=tolerance, **how).linear
    assert np.abs(found - exact).max() <= tolerance + 1e-12


@settings(max_examples=8, suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_generated_balls_stay_within_the_tolerance(data) -> None:
    balls_off(data)


@pytest.mark.slow
@settings(max_examples=60, suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_many_generated_balls_stay_within_the_tolerance(data) -> None:
    balls_off(data)


@pytest.mark.slow
@settings(max_examples=6, suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_light_of_every_order_stays_within_the_tolerance(data) -> None:
    many_times_off(data)


def test_the_table_tells_who_vouches() -> None:
    rows = timed(scenes_at(16, ASKED, PARTS), rounds=1)
    assert len(rows) == len(PARTS) * (len(ASKED) + 1)
    by_name = {(row.task, row.name): row for row in rows}
    for name in PARTS:
        for tolerance in ASKED:
            row: Row = by_name[name, NAME.format(tolerance)]
            assert row.error is not None
            assert row.error <= tolerance
    text = asked_and_measured(rows).splitlines()
    assert text[1].split()[-3:] == list(KINDS)
    assert len(text) == 2 + len(PARTS) * len(ASKED)
    proved, certified, measured = text[2].split()[-3:]
    assert text[2].startswith("demand-quad")
    assert (float(proved), certified, float(measured)) == (0.09, "-", 0.01)


@pytest.mark.slow  # the stage that has matplotlib
def test_the_figure_shows_what_was_asked_and_what_came_out(tmp_path) -> None:
    pytest.importorskip("matplotlib", reason="needs matplotlib (extra: bench)")
    rows = timed(scenes_at(16, ASKED, PARTS), rounds=1)
    picture = load_picture(asked_figure(rows, tmp_path / "tolerance.png")).linear
    assert picture.shape == (360 + 26, 640, 3)  # two lines of the legend
    # Scenes that no tolerance changes are left out: the legend grows no longer.
    same = [Row(f"s{k}", r.name, r.timing, None, 0.0) for k in range(9) for r in rows]
    again = load_picture(asked_figure([*rows, *same], tmp_path / "b.png")).linear
    assert again.shape == picture.shape
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 10
