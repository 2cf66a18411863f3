"""The framebuffer on OpenGL against ours: read back, clear, masks, scissor, depth."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from twins.framebuffer import (
    CODE,
    COLOUR,
    DEPTH,
    FLOATS_AND_CODES,
    HALF,
    drawn_state,
)

from refcloud import gl, raster
from refcloud.gl import opengl
from refcloud.gl.state import blend_color
from refcloud.raster import Blending, Framebuffer, State, stored
from refcloud.raster.factors import OVER

pytestmark = pytest.mark.gl

FORMATS = ["RGBA32F", "RGBA16F", "RGBA8", "SRGB8_ALPHA8"]
every_format = pytest.mark.parametrize("format", FORMATS)
HEIGHT, WIDTH = 5, 7
EVERYTHING = slice(None), slice(None)
# No product of these overflows float32: OpenGL goes on with infinity, ours does not.
MODERATE = st.floats(-4.0, 4.0, width=32) | CODE | HALF
ENDS = st.tuples(st.integers(-9, 12), st.integers(-9, 12)).map(sorted)


def filled(format: str) -> tuple[gl.Target, Framebuffer]:
    """Put the same pixels on both sides, no two of them alike."""
    ramp = np.linspace(-0.5, 1.5, HEIGHT * WIDTH * 4).reshape(HEIGHT, WIDTH, 4)
    ours = Framebuffer(stored(ramp, format).copy(), format=format)
    target = gl.framebuffer(WIDTH, HEIGHT, format)
    gl.write_pixels(target, ours.pixels)
    return target, ours


@every_format
def test_what_is_written_is_read_back_the_same_way_up(format) -> None:
    target, ours = filled(format)
    np.testing.assert_array_equal(gl.read_pixels(target, *EVERYTHING), ours.pixels)
    for rows, columns in ((slice(1, 3), slice(2, 7)), (slice(4, 5), slice(0, 1))):
        np.testing.assert_array_equal(
            gl.read_pixels(target, rows, columns),
            raster.read_pixels(ours, rows, columns),
        )
    assert gl.read_pixels(target, slice(2, 2), slice(0, 3)).shape == (0, 3, 4)


@every_format
def test_averages_of_an_area_are_ours(format) -> None:
    target, ours = filled(format)

    @given(rows=ENDS, columns=ENDS)
    @settings(max_examples=40)
    def check(rows, columns) -> None:
        box = slice(*rows), slice(*columns)
        found, expected = gl.read_average(target, *box), raster.read_average(ours, *box)
        assert (found is None) == (expected is None)
        if found is not None:
            np.testing.assert_allclose(found, expected, rtol=1e-14, atol=1e-16)

    check()


@every_format
def test_a_clear_rounds_as_the_format_does(format, llvmpipe) -> None:
    target = gl.framebuffer(WIDTH, HEIGHT, format)

    @given(color=COLOUR)
    @settings(max_examples=60)
    def check(color) -> None:
        gl.clear(target, color)
        found = gl.read_pixels(target, *EVERYTHING)
        assert (found == found[0, 0]).all()
        # The driver clears by the exact curve of sRGB, and float16 toward zero.
        how = "ideal" if format == "SRGB8_ALPHA8" else "llvmpipe"
        expected = stored(color, format, arithmetic=how)
        off = np.abs(found[0, 0] - expected).max()
        assert off == 0.0 or (format == "SRGB8_ALPHA8" and off * 255.0 < 1.01)

    check()


@settings(max_examples=40)  # the driver compiles a shader for each state
@given(data=st.data(), format=FLOATS_AND_CODES)
def test_masks_scissor_and_depth_are_ours(data, llvmpipe, format) -> None:
    draw = data.draw
    target = gl.framebuffer(3, 3, format, depth=True)
    values = draw(arrays(np.float64, (3, 3, 4), elements=MODERATE))
    depth = draw(arrays(np.float64, (3, 3), elements=DEPTH))
    pixels = stored(values, format, arithmetic="llvmpipe").copy()
    ours = Framebuffer(pixels, depth.copy(), format, "llvmpipe")
    # Both sides start from the same colours and depths.
    always = State(depth_func="ALWAYS")
    gl.draw_fragments(target, *EVERYTHING, values, depth=depth, state=always)
    gl.write_pixels(target, ours.pixels)
    state, _ = drawn_state(draw, 3)
    source = draw(arrays(np.float64, (2, 2, 4), elements=MODERATE))
    new = draw(arrays(np.float64, (2, 2), elements=DEPTH))
    top, left = draw(st.integers(0, 1)), draw(st.integers(0, 1))
    box = slice(top, top + 2), slice(left, left + 2)
    color, far = draw(st.none() | COLOUR), draw(st.none() | DEPTH)
    for room, where in ((raster, ours), (gl, target)):
        room.draw_fragments(where, *box, source, depth=new, state=state)
        room.clear(where, color, depth=far, state=state)
    found = gl.read_pixels(target, *EVERYTHING)
    # To the bit, denormals aside: with a colour mask the driver's code for minima and
    # maxima is another, and lets a denormal by.
    np.testing.assert_allclose(found, ours.pixels, rtol=0.0, atol=2.0**-126)
    # 24 bits of depth.
    gap = np.abs(gl.read_depth(target) - ours.depth)
    assert gap.max() <= 2.0**-24


def test_e35_a_real_rgba8_stalls(llvmpipe) -> None:
    for format in FORMATS[:3]:
        target = gl.framebuffer(1, 1, format)
        gl.clear(target, np.ones(4))
        layer, over = np.array([[[0.0, 0.0, 0.0, 1.0 / 255.0]]]), State(blending=OVER)
        for _ in range(1000):
            gl.draw_fragments(target, *EVERYTHING, layer, state=over)
        found = gl.read_pixels(target, *EVERYTHING)[0, 0, 0]
        how = {"format": format, "arithmetic": "llvmpipe"}
        assert found == raster.seen_through_layers(1.0 / 255.0, 1000, **how)[-1]
        if format == "RGBA8":
            assert found == 127.0 / 255.0


def test_bad_input_is_refused_in_one_line() -> None:
    with pytest.raises(ValueError, match=r"format: expected one of RGBA32F, .*RGBA64F"):
        gl.framebuffer(1, 1, "RGBA64F")
    with pytest.raises(ValueError, match=r"sides of at most .* make the picture"):
        gl.framebuffer(10**6, 1)
    target = gl.framebuffer(2, 2)
    with pytest.raises(ValueError, match="rows: expected a slice of step 1 within"):
        gl.read_pixels(target, slice(0, 3), slice(0, 1))
    with pytest.raises(ValueError, match=r"source: expected shape \(2, 1, 4\)"):
        gl.draw_fragments(target, slice(0, 2), slice(0, 1), np.zeros((1, 1, 4)))


def test_without_a_blend_colour_its_factors_are_refused() -> None:
    class Bare:
        mglo = None

    with pytest.raises(ValueError, match="constant: expected a moderngl that finds"):
        blend_color(Bare(), Blending("CONSTANT_COLOR", "ZERO"))


def test_an_error_of_opengl_is_raised(monkeypatch) -> None:
    class Failing:
        error = "GL_INVALID_ENUM"

    monkeypatch.setattr(opengl, "context", Failing)
    with pytest.raises(RuntimeError, match="OpenGL: GL_INVALID_ENUM from a test"):
        opengl.refuse_errors("a test")
