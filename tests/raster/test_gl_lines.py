"""The same pixels as a real OpenGL draws, Mesa's llvmpipe in software."""

from __future__ import annotations

import importlib.util

import numpy as np
import pytest

from refcloud import gl
from refcloud.noise import uniform
from refcloud.raster import line_pixels, triangle_pixels
from refcloud.raster.diamonds import pixels_between
from refcloud.raster.window import to_subpixels

SIDE = 16  # a power of two: the way into clip space and back rounds nothing
COUNT = 400
VERTEX = """#version 330
in vec2 place;
void main() { gl_Position = vec4(place / 8.0 - 1.0, 0.0, 1.0); }
"""
FRAGMENT = """#version 330
out vec4 color;
void main() { color = vec4(1.0); }
"""

pytestmark = pytest.mark.gl


@pytest.fixture(scope="module")
def context():
    """Give the one context of the process: another would leave it not current."""
    if importlib.util.find_spec("moderngl") is None:
        pytest.skip('needs moderngl: pip install -e ".[test,gl]"')
    try:
        return gl.context()
    except ValueError as missing:
        pytest.skip(str(missing))


def drawn(context, places: np.ndarray) -> np.ndarray:
    """Count how often OpenGL draws each pixel; its row 0 is taken as ours."""
    program = context.program(vertex_shader=VERTEX, fragment_shader=FRAGMENT)
    target = context.framebuffer([context.texture((SIDE, SIDE), 1, dtype="f4")])
    target.use()
    target.clear()
    context.enable_only(context.BLEND)
    context.blend_func = context.ONE, context.ONE
    data = context.buffer(places.astype("f4").tobytes())
    mode = {2: context.LINES, 3: context.TRIANGLES}[len(places)]
    context.vertex_array(program, [(data, "2f", "place")]).render(mode)
    found = target.read(components=1, dtype="f4")
    return np.frombuffer(found, "f4").reshape(SIDE, SIDE)


@pytest.mark.parametrize(("corners", "most"), [(2, 0.01), (3, 0.002)])
def test_f07_f08_pixels_are_those_of_opengl(context, corners: int, most: float) -> None:
    """Compare places to 1/256 pixel, some outside the window.

    Worst seen in 3,000: 0.13 % of the lines' pixels, 0.03 % of the triangles'. OpenGL
    lets a line's pixels lie one pixel aside, and llvmpipe decides some ends otherwise.
    """
    which = np.arange(COUNT)[:, None, None], np.arange(corners)[:, None], np.arange(2)
    u = uniform(*which, seed=0)
    off = total = 0
    for places in np.round((22.0 * u - 3.0) * 256.0) / 256.0:
        ours = np.zeros((SIDE, SIDE))
        find = line_pixels if corners == 2 else triangle_pixels
        parts = places if corners == 2 else [places]
        np.add.at(ours, find(*parts, width=SIDE, height=SIDE), 1.0)
        theirs = drawn(context, places)
        off += np.count_nonzero(ours != theirs)
        total += np.count_nonzero(ours)
        # A pixel that only one of them draws lies beside one that the other draws.
        padded = np.pad(ours, 1)
        around = sum(
            np.roll(padded, (i, j), (0, 1))[1:-1, 1:-1]
            for i in (-1, 0, 1)
            for j in (-1, 0, 1)
        )
        assert not ((theirs > 0) & (around == 0)).any()
    assert total > 2_000
    assert off <= most * total


def test_depths_along_lines_are_those_of_opengl(context) -> None:
    """Compare gl_FragCoord.z where both draw; OpenGL's is float32.

    Worst seen in 300 lines: 7e-6 of what the ends of a line of 4 pixels differ by.
    """
    program = context.program(
        vertex_shader="""#version 330
in vec3 place;
void main() { gl_Position = vec4(place.xy / 8.0 - 1.0, 2.0 * place.z - 1.0, 1.0); }
""",
        fragment_shader="""#version 330
out vec4 color;
void main() { color = vec4(gl_FragCoord.z, 1.0, 0.0, 0.0); }
""",
    )
    texture = context.texture((SIDE, SIDE), 2, dtype="f4")
    target = context.framebuffer([texture])
    target.use()
    context.enable_only(context.NOTHING)
    which = np.arange(100)[:, None, None], np.arange(2)[:, None], np.arange(3)
    compared, worst = 0, 0.0
    for places in uniform(*which, seed=1):
        places[:, :2] = np.round(20.0 * places[:, :2] * 256.0) / 256.0 - 2.0
        if np.abs(places[1, :2] - places[0, :2]).max() < 4.0:
            continue
        target.clear()
        data = context.buffer(places.astype("f4").tobytes())
        context.vertex_array(program, [(data, "3f", "place")]).render(context.LINES)
        theirs = np.frombuffer(target.read(components=2, dtype="f4"), "f4")
        theirs = theirs.reshape(SIDE, SIDE, 2)
        ends = to_subpixels(places[None, :, :2])
        found = pixels_between(ends, SIDE, SIDE, 1)
        start, end = places[:, 2]
        ours = start + found.share * (end - start)
        there, covered = theirs[found.row, found.column].T
        both = covered == 1.0
        compared += both.sum()
        worst = max(worst, np.abs(there - ours)[both].max(initial=0.0))
    assert compared > 500
    assert worst <= 1e-5, worst
