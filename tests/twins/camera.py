"""The cameras beside their plain twins, and the strategies of the room's tests."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

import refcloud.camera as array
from refcloud.plain import camera as plain
from twins import Draw, twin

WITHOUT: dict[str, str] = {}

STEEP = "worst seen 3e-14; `up` a thousandth off the view magnifies a last bit so far"

coordinates = st.floats(-10.0, 10.0)
places = st.tuples(coordinates, coordinates, coordinates)
sides = st.integers(1, 6)
angles = st.floats(0.05, 3.0)
# No direction, unless it is plainly one: near the limit both may decide apart.
UPWARD = 1e-3


def drawn_camera(draw: Draw, *, kinds: str = "both") -> array.AnyCamera:
    """Draw a camera that stands apart from its target; `up` is across or along."""
    eye, target = draw(places), draw(places)
    view = np.subtract(target, eye)
    assume(math.hypot(*view) > 0.1)
    up = draw(st.just((0.0, 1.0, 0.0)) | places | st.just(tuple(2.0 * view)))
    assume(math.hypot(*up) > 0.1)
    sine = np.linalg.norm(np.cross(up, view)) / math.hypot(*up) / math.hypot(*view)
    assume(sine > UPWARD or sine < 1e-9)
    size = {"width": draw(sides), "height": draw(sides)}
    if kinds == "pinhole" or (kinds == "both" and draw(st.booleans())):
        return array.Camera(eye, target, up, draw(angles), **size)
    return array.OrthographicCamera(eye, target, up, draw(st.floats(0.1, 50.0)), **size)


def as_plain(camera: array.AnyCamera) -> plain.Camera:
    eye, target, up = (
        tuple(v.tolist()) for v in (camera.eye, camera.target, camera.up)
    )
    size = camera.width, camera.height
    if isinstance(camera, array.Camera):
        return plain.Camera(eye, target, up, *size, camera.fov_y)
    return plain.Camera(eye, target, up, *size, None, camera.height_of_view)


@twin(array.axes, plain.axes, tolerance=1e-12, why=STEEP)
def axes(draw: Draw):
    camera = drawn_camera(draw)
    return array.axes(camera), plain.axes(as_plain(camera))


@twin(
    array.project,
    plain.project,
    tolerance=1e-10,
    why="worst seen 2e-14; places at depth 0.01 know it to 14 digits, and see `axes`",
)
def project(draw: Draw):
    camera = drawn_camera(draw)
    points = draw(st.lists(places, max_size=4))
    expected = [plain.project(as_plain(camera), point) for point in points]
    # A place beside the eye may fall on either side of it.
    assume(all(abs(depth) > 1e-2 for _, _, depth, _ in expected))
    actual = np.stack(array.project(camera, np.reshape(points, (-1, 3))), axis=1)
    return actual, np.reshape(expected, (-1, 4))


@twin(array.rays, plain.rays, tolerance=1e-12, why=STEEP)
def rays(draw: Draw):
    camera = drawn_camera(draw)
    expected = [
        [plain.rays(as_plain(camera), i, j) for i in range(camera.width)]
        for j in range(camera.height)
    ]
    return np.stack(array.rays(camera), axis=2), expected


@twin(array.frame, plain.frame, tolerance=1e-12, why=STEEP)
def frame(draw: Draw):
    lower, upper = draw(places), draw(places)
    how = {
        "width": draw(sides),
        "height": draw(sides),
        "margin": draw(st.floats(1.0, 3.0)),
    }
    camera = array.frame(lower, upper, **how)
    expected = plain.frame(lower, upper, **how, fov_y=array.FOV_Y)
    return [camera.eye, camera.target], [expected.eye, expected.target]
