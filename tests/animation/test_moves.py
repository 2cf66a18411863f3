"""What moves: turns about an axis, ways that close, and what a scene cannot do."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_animations import LOOPED, SEEN, STILL

from refcloud import Camera, OrthographicCamera, Sun
from refcloud.animation.moves import (
    Moves,
    closes,
    completed,
    moved,
    share_of,
    turned,
    turned_eye,
)
from refcloud.scene import Model, Motion, View

ANGLE = st.floats(-1000.0, 1000.0)
PART = st.floats(-3.0, 3.0)
VECTOR = st.tuples(PART, PART, PART).map(np.array)
AXIS = VECTOR.filter(lambda v: float(v @ v) > 1e-3)
MODEL, VIEW = Model({}), View(16, 12)


@given(VECTOR, AXIS, ANGLE, ANGLE)
def test_turning_is_a_rotation(vector, axis, a, b) -> None:
    once = turned(vector, axis, a)
    # Ten last bits of vectors of length 5.
    close = {"rtol": 0.0, "atol": 2e-14}
    np.testing.assert_allclose(once @ once, vector @ vector, rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(once @ axis, vector @ axis, rtol=0.0, atol=1e-13)
    both = turned(once, axis, b)
    np.testing.assert_allclose(both, turned(vector, axis, a + b), **close, verbose=True)
    np.testing.assert_allclose(turned(once, axis, -a), vector, **close)


def test_turning_is_counterclockwise_seen_from_the_axis() -> None:
    x, y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    np.testing.assert_allclose(turned(x, y, 90.0), [0, 0, -1], atol=1e-15)


@given(VECTOR, AXIS, st.integers(-3, 3), ANGLE)
def test_whole_turns_give_the_same_bits(vector, axis, rounds, angle) -> None:
    np.testing.assert_array_equal(turned(vector, axis, 360.0 * rounds), vector)


@pytest.mark.parametrize(
    "camera",
    [Camera([1, 2, 5], [0, 1, 0]), OrthographicCamera([1, 2, 5], [0, 1, 0])],
)
def test_an_eye_goes_around_or_turns_in_place(camera) -> None:
    around = turned_eye(camera, 90.0, "around")
    np.testing.assert_array_equal(around.target, camera.target)
    np.testing.assert_allclose(around.eye, [5, 2, -1], atol=1e-14)
    in_place = turned_eye(camera, 90.0, "in place")
    np.testing.assert_array_equal(in_place.eye, camera.eye)
    np.testing.assert_allclose(in_place.target, [1 - 5, 1, 5 + 1], atol=1e-14)
    assert turned_eye(camera, 360.0, "around").eye.tolist() == camera.eye.tolist()


NEVER = (math.inf,) * 3


@pytest.mark.parametrize(
    ("moves", "motion", "closed"),
    [
        (Moves(turn_eye=360.0), SEEN.motion, True),
        (Moves(turn_eye=-720.0, turn_sun=360.0), SEEN.motion, True),
        (Moves(turn_eye=360.0, turn_sun=90.0), SEEN.motion, False),
        (Moves(time=[0, 2]), LOOPED.motion, True),
        (Moves(time=[1, 7]), LOOPED.motion, True),
        (Moves(time=[0, 1]), LOOPED.motion, False),
        (Moves(time=[0, 2], wind=[2, 0, 0]), LOOPED.motion, True),
        (Moves(time=[0, 2], wind=[1, 0, 0]), LOOPED.motion, False),
        (Moves(time=[0, 2], wind=[0, 0, 1]), LOOPED.motion, False),
        (Moves(time=[0, 3]), Motion(period=math.inf), False),
        (Moves(time=[0, 1], wind=[1, 0, 0]), SEEN.motion, False),
        (Moves(time=[0, 1], wind=[1, 0, 0]), Motion(repeats=NEVER), False),
    ],
)
def test_a_way_closes_where_all_of_it_does(moves, motion, closed) -> None:
    assert closes(moves, motion) is closed


@given(st.integers(1, 500))
def test_frames_share_the_way(frames: int) -> None:
    shares = [share_of(i, frames, True) for i in range(frames)]
    assert shares == [i / frames for i in range(frames)]
    shares = [share_of(i, frames, False) for i in range(frames)]
    assert shares[0] == 0.0
    assert frames == 1 or shares[-1] == 1.0


def test_time_is_completed_from_what_moves() -> None:
    def time(moves: Moves, motion: Motion):
        found = completed(moves, motion, "it").time
        return None if found is None else found.tolist()

    assert time(Moves(), LOOPED.motion) == [0.0, 2.0]
    assert time(Moves(wind=[1, 0, 0]), LOOPED.motion) == [0.0, 1.0]
    assert time(Moves(wind=[1, 0, 0]), SEEN.motion) == [0.0, 1.0]
    assert time(Moves(turn_sun=20.0), SEEN.motion) is None
    assert time(Moves(turn_sun=20.0, time=[3, 4], wind=[1, 0, 0]), SEEN.motion) == [
        3,
        4,
    ]


@pytest.mark.parametrize(
    ("moves", "scene", "line"),
    [
        (Moves(), SEEN, r"moves: expected something that moves \(turn_sun, turn_eye"),
        (Moves(), STILL, r"moves: expected .* \(none: it cannot move\), got none"),
        (Moves(turn_sun=9.0), LOOPED, "turn_sun: .* no sun lights, .*: time, wind"),
        (
            Moves(turn_eye=9.0),
            LOOPED,
            "turn_eye: expected none for looped, which",
        ),
        (Moves(turn_eye=9.0), STILL, "turn_eye: .*; nothing of it can move"),
        (Moves(wind=[1, 0, 0]), STILL, "wind: .* which has nothing that wind carries"),
        (Moves(wind=[1, 1, 0]), LOOPED, "wind: .* which nothing carries along y"),
        (Moves(time=[0, 1]), SEEN, "time: expected none for seen, which knows no time"),
    ],
)
def test_what_a_scene_cannot_do_is_refused(moves, scene, line) -> None:
    with pytest.raises(ValueError, match=line) as refusal:
        completed(moves, scene.motion, scene.name)
    assert "\n" not in str(refusal.value)


def test_time_that_never_repeats_is_asked_for() -> None:
    with pytest.raises(ValueError, match=r"time: .*never repeats: say from when"):
        completed(Moves(), Motion(period=math.inf), "it")


@pytest.mark.parametrize(
    ("wrong", "line"),
    [
        ({"turn_sun": math.nan}, "turn_sun: expected a finite number"),
        ({"turn_eye": 1e6}, r"turn_eye: .*\[-36000, 36000\] \(degrees\)"),
        ({"time": [0.0]}, r"time: expected .*\(2,\)"),
        ({"wind": [0.0, math.inf, 0.0]}, "wind: expected finite"),
        ({"sun_axis": [0.0, 0.0, 0.0]}, "sun_axis: expected a vector that is not zero"),
    ],
)
def test_moves_check_their_numbers(wrong, line) -> None:
    with pytest.raises(ValueError, match=line):
        Moves(**wrong)


def test_a_frame_s_view_moves_from_where_the_scene_stands() -> None:
    moves = Moves(turn_sun=90.0, turn_eye=180.0, time=[0, 2], wind=[3, 0, 0])
    view = moved(VIEW, MODEL, SEEN.motion, moves, 0.5)
    assert view.time == 1.0
    assert view.offset is None
    # Wind of 3 for one unit of time carries the clouds to +x: the eye goes to -x.
    assert view.camera is not None
    np.testing.assert_allclose(view.camera.eye, [0 - 3 + 3, 1, 0], atol=1e-14)
    np.testing.assert_allclose(view.camera.target, [-3, 1, 0], atol=1e-14)
    assert view.suns is not None
    half = math.sqrt(0.5)
    np.testing.assert_allclose(view.suns[0].direction, [half, 0, -half], atol=1e-15)
    np.testing.assert_array_equal(
        view.suns[0].irradiance, SEEN.motion.suns[0].irradiance
    )


def test_given_eye_and_suns_are_where_turning_starts() -> None:
    own = View(16, 12, Camera([0, 0, 9], [0, 0, 0]), (Sun([0, 0, 1], [1, 2, 3]),))
    view = moved(own, MODEL, SEEN.motion, Moves(turn_sun=90, turn_eye=90), 1.0)
    assert view.camera is not None
    np.testing.assert_allclose(view.camera.eye, [9, 0, 0], atol=1e-14)
    assert view.suns is not None
    np.testing.assert_allclose(view.suns[0].direction, [1, 0, 0], atol=1e-15)
    assert view.suns[0].irradiance.tolist() == [1, 2, 3]


def test_wind_that_a_scene_carries_itself_leaves_the_eye() -> None:
    moves = Moves(time=[0, 2], wind=[2, 0, 0])
    view = moved(VIEW, MODEL, LOOPED.motion, moves, 0.25)
    assert (view.time, view.camera) == (0.5, None)
    assert view.offset is not None
    assert view.offset.tolist() == [1.0, 0.0, 0.0]
