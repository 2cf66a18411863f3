"""The sky room beside its plain twins, and the strategies of the room's tests."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import refcloud.sky as array
from refcloud.optics import Sun
from refcloud.plain import sky as plain
from twins import Draw, twin
from twins.camera import as_plain, drawn_camera

WITHOUT: dict[str, str] = {}

ROUNDED = "worst seen 2.6e-16 in 600 examples, times 8: the same few operations"

channels = st.floats(0.0, 2.0)
colours = st.tuples(channels, channels, channels)
sides = st.integers(1, 6)
FIELDS = plain.Sky._fields


def drawn_sky(draw: Draw) -> array.Sky:
    return array.Sky(
        *(draw(colours) for _ in range(3)),
        bend=draw(st.floats(0.3, 3.0)),
        haze_height=draw(st.floats(0.02, 2.0)),
        glow=draw(st.sampled_from([0.0, 0.01, 1.0])),
        glow_g=draw(st.floats(0.0, 0.95)),
    )


def drawn_suns(draw: Draw, most: int = 2) -> tuple[Sun, ...]:
    """Draw suns of any colour, dark ones among them."""
    way = st.floats(-1.0, 1.0)
    ways = st.tuples(way, way, way).filter(lambda v: np.abs(v).max() > 0.1)
    suns = st.tuples(ways, st.just((0.0, 0.0, 0.0)) | colours)
    return tuple(Sun(*sun) for sun in draw(st.lists(suns, max_size=most)))


@twin(
    array.clear_sky,
    plain.clear_sky,
    tolerance=2e-13,
    why="worst seen 1.6e-15; lobes of peak 800 magnify the last bits of a direction",
)
def clear_sky(draw: Draw):
    camera, sky, suns = drawn_camera(draw), drawn_sky(draw), drawn_suns(draw)
    fields = plain.Sky(*(np.asarray(getattr(sky, name)).tolist() for name in FIELDS))
    lights = [(tuple(s.direction.tolist()), s.irradiance.tolist()) for s in suns]
    expected = [
        [
            plain.clear_sky(as_plain(camera), fields, lights, i, j)
            for i in range(camera.width)
        ]
        for j in range(camera.height)
    ]
    return array.clear_sky(camera, sky, suns=suns), expected


@twin(array.sky_gradient, plain.sky_gradient, tolerance=2e-15, why=ROUNDED)
def sky_gradient(draw: Draw):
    top, bottom = draw(colours), draw(colours)
    width, height = draw(sides), draw(sides)
    rows = [plain.sky_gradient(top, bottom, j, height) for j in range(height)]
    actual = array.sky_gradient(top, bottom, width=width, height=height)
    return actual, [[row] * width for row in rows]


@twin(array.printed_gradient, plain.printed_gradient, tolerance=2e-15, why=ROUNDED)
def printed_gradient(draw: Draw):
    width, height = draw(sides), draw(sides)
    rows = [plain.printed_gradient(j, height) for j in range(height)]
    actual = array.printed_gradient(width=width, height=height)
    return actual, [[row] * width for row in rows]
