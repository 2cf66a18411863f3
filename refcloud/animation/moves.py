"""What moves, by how much, and where of it each frame stands.

Frame i of N stands at the share i / N of the whole way where the way closes, so that
frame N would be frame 0 again; else at i / (N - 1): the last frame shows its end.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from refcloud.camera import AnyCamera
from refcloud.checking import check_fields
from refcloud.conventions import Array, Range, Shape, Vector, unit_vector
from refcloud.optics import Sun
from refcloud.refusal import complaint
from refcloud.scene import Model, Motion, View

# Whole turns are counted, so turns are given in degrees: 360 is exact, 2 pi is not.
Turn = Annotated[float, Range(-36000.0, 36000.0, "degrees")]
Span = Annotated[Array, Shape(2), Range(-1e9, 1e9)]
Wind = Annotated[Array, Shape(3), Range(-1e9, 1e9, "scene units per unit of time")]
ROUND = 360.0  # degrees
UP = (0.0, 1.0, 0.0)
WHOLE = 1e-9  # of a period: what rounding leaves of a whole number of them


@dataclass(frozen=True)
class Moves:
    """How a scene moves from the first frame to the last.

    Attributes
    ----------
    turn_sun
        How far the suns turn about `sun_axis`, degrees; counterclockwise seen from its
        tip.
    sun_axis
        What they turn about, shape (3,).
    turn_eye
        How far the eye goes around what it looks at, about the upright axis, degrees.
    time
        First and last value of the scene's time; with wind also how long it blows.
        None for one period of scenes that repeat themselves, else for no time, and for
        0 to 1 with wind.
    wind
        How fast it carries the clouds along x, y and z, scene units per unit of time.
    """

    turn_sun: Turn = 0.0
    sun_axis: Vector = field(default_factory=lambda: np.array(UP))
    turn_eye: Turn = 0.0
    time: Span | None = None
    wind: Wind = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        check_fields(self)
        unit_vector(self.sun_axis, "sun_axis")


def completed(moves: Moves, motion: Motion, what: str) -> Moves:
    """Fill in the time that is left open, and refuse what a scene cannot do.

    Parameters
    ----------
    moves
        What was asked for.
    motion
        What the scene can do.
    what
        What a refusal calls the scene.

    Returns
    -------
    The moves with a time, where something goes by it.

    Raises
    ------
    ValueError
        The scene cannot move so, or nothing is to move.
    """
    windy, turned = bool(moves.wind.any()), bool(moves.turn_sun or moves.turn_eye)
    if moves.turn_sun and not motion.suns:
        _refuse("turn_sun", what, "which no sun lights", motion)
    if moves.turn_eye and motion.eye is None:
        _refuse("turn_eye", what, "which has no eye", motion)
    if windy and motion.eye is None and motion.repeats is None:
        _refuse("wind", what, "which has nothing that wind carries", motion)
    for axis, speed, length in zip(
        "xyz", moves.wind, motion.repeats or (), strict=False
    ):
        if speed and length == 0.0:
            _refuse("wind", what, f"which nothing carries along {axis}", motion)
    time = moves.time
    if time is not None and motion.period is None and not windy:
        _refuse("time", what, "which knows no time", motion)
    if time is None and windy:
        time = np.array([0.0, 1.0])
    if time is None and motion.period is not None and not turned:
        if not math.isfinite(motion.period):
            advice = "this scene never repeats: say from when to when"
            raise ValueError(complaint("time", "first and last", "none", advice))
        time = np.array([0.0, motion.period])
    if time is None and not turned:
        able = ", ".join(_able(motion)) or "none: it cannot move"
        raise ValueError(complaint("moves", f"something that moves ({able})", "none"))
    return dataclasses.replace(moves, time=time)


def _able(motion: Motion) -> list[str]:
    """Name the moves that a scene can make."""
    able = ["turn_sun"] if motion.suns else []
    able += ["turn_eye"] if motion.eye is not None else []
    able += ["time"] if motion.period is not None else []
    return able + (["wind"] if motion.eye is not None or motion.repeats else [])


def _refuse(name: str, what: str, why: str, motion: Motion) -> None:
    able = ", ".join(_able(motion))
    advice = f"what can move: {able}" if able else "nothing of it can move"
    raise ValueError(complaint(name, f"none for {what}, {why}", "some", advice))


def closes(moves: Moves, motion: Motion) -> bool:
    """Tell whether the frame after the last would be the first again.

    Parameters
    ----------
    moves
        Completed ones.
    motion
        What the scene can do.

    Returns
    -------
    Whether every move ends where it began.
    """
    if moves.turn_sun % ROUND or moves.turn_eye % ROUND:
        return False
    if moves.time is None:
        return True
    span = float(moves.time[1] - moves.time[0])
    if motion.period is not None and not _whole(span, motion.period):
        return False
    lengths = motion.repeats or (math.inf,) * 3
    return all(
        _whole(float(speed) * span, length)
        for speed, length in zip(moves.wind, lengths, strict=True)
    )


def _whole(way: float, length: float) -> bool:
    """Tell whether a way is a whole number of lengths; 0 is, of any length."""
    if way == 0.0:
        return True
    if not math.isfinite(length) or length == 0.0:
        return False
    count = way / length
    return abs(count - round(count)) <= WHOLE * max(1.0, abs(count))


def share_of(index: int, frames: int, closed: bool) -> float:
    """Give how much of the way a frame has gone, from 0 to 1.

    Parameters
    ----------
    index, frames
        Which frame of how many.
    closed
        Whether the way ends where it began.

    Returns
    -------
    The share.
    """
    return index / (frames if closed else max(frames - 1, 1))


def moved(view: View, model: Model, motion: Motion, moves: Moves, share: float) -> View:
    """Give the view of one frame.

    Parameters
    ----------
    view
        That of the scene at rest.
    model, motion
        Of the scene.
    moves
        Completed ones.
    share
        How much of the way is gone.

    Returns
    -------
    The view, with its own eye, suns, time and offset where they move.
    """
    changes: dict[str, object] = {}
    offset = np.zeros(3)
    if moves.time is not None:
        start, end = (float(value) for value in moves.time)
        changes["time"] = start + share * (end - start)
        # 1. Wind carries what the scene lets it carry, or the eye the other way.
        offset = moves.wind * (share * (end - start))
        if moves.wind.any() and motion.repeats is not None:
            changes["offset"] = offset
    carried = moves.wind.any() and motion.repeats is None
    if motion.eye is not None and (moves.turn_eye or carried):
        # 2. The eye goes around what it looks at, or turns where it stands.
        camera = view.camera or motion.eye(model, view)
        camera = turned_eye(camera, share * moves.turn_eye, motion.turns)
        if carried:
            eye, target = camera.eye - offset, camera.target - offset
            camera = dataclasses.replace(camera, eye=eye, target=target)
        changes["camera"] = camera
    if moves.turn_sun:
        # 3. Suns keep their light.
        angle = share * moves.turn_sun
        suns = motion.suns if view.suns is None else view.suns
        changes["suns"] = tuple(
            Sun(turned(sun.direction, moves.sun_axis, angle), sun.irradiance)
            for sun in suns
        )
    return dataclasses.replace(view, **changes)  # pyright: ignore[reportArgumentType]


def turned_eye(camera: AnyCamera, degrees: float, how: str) -> AnyCamera:
    """Turn a camera about the upright axis.

    Parameters
    ----------
    camera
        At rest.
    degrees
        How far, counterclockwise seen from above.
    how
        "around" its target, or "in place".

    Returns
    -------
    The camera.
    """
    axis, way = np.array(UP), camera.eye - camera.target
    turned_way, up = turned(way, axis, degrees), turned(camera.up, axis, degrees)
    if how == "around":
        eye = camera.target + turned_way
        return dataclasses.replace(camera, eye=eye, up=up)
    return dataclasses.replace(camera, target=camera.eye - turned_way, up=up)


def turned(vector: Array, axis: Array, degrees: float) -> Array:
    """Turn a vector about an axis.

    Formula: v cos + (k x v) sin + k (k . v) (1 - cos) (Rodrigues)

    Parameters
    ----------
    vector
        Shape (3,).
    axis
        Shape (3,), any length but 0.
    degrees
        How far; whole turns give the same bits as none.

    Returns
    -------
    Shape (3,).

    Examples
    --------
    >>> turned(np.array([1.0, 0.0, 0.0]), np.array([0.0, 2.0, 0.0]), 90.0).round(12) + 0
    array([ 0.,  0., -1.])
    """
    if degrees % ROUND == 0.0:
        return vector
    angle, k = math.radians(degrees % ROUND), unit_vector(axis, "axis")
    along = k * float(k @ vector)
    across = math.cos(angle) * (vector - along)
    return across + math.sin(angle) * np.cross(k, vector) + along
