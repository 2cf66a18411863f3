"""Rows of the framebuffer: formats, fragments, both arithmetics."""

from __future__ import annotations

import typing

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from refcloud import raster
from refcloud.plain import framebuffer as plain
from refcloud.plain import llvmpipe as plain_llvmpipe
from refcloud.raster import blending, formats, llvmpipe
from refcloud.raster.factors import Blending, Equation, Factor
from refcloud.raster.formats import Format
from refcloud.raster.store import DepthFunc, State
from twins import Draw, twin

CODE = st.integers(0, 255).map(lambda code: code / 255.0)
HALF = st.integers(0, 254).map(lambda code: (code + 0.5) / 255.0)
DENORMAL = st.floats(-1.0, 1.0, width=32).map(lambda x: x * 2.0**-127)
CHANNEL = (
    st.floats(-4.0, 4.0, width=32)
    | st.floats(0.0, 1.0, width=32)
    | CODE
    | HALF
    | DENORMAL
    | st.sampled_from([0.0, 1.0, 1e30, 3e5, 2.0**-20])
)
COLOUR = st.lists(CHANNEL, min_size=4, max_size=4)
FORMAT = st.sampled_from(typing.get_args(Format))
FLOATS_AND_CODES = st.sampled_from(["RGBA32F", "RGBA16F", "RGBA8"])
DEPTH = st.sampled_from([0.0, 0.25, 0.5, 1.0])
BOOL = st.booleans()
RULE = st.tuples(
    st.sampled_from(typing.get_args(Factor)),
    st.sampled_from(typing.get_args(Factor)),
    st.sampled_from(typing.get_args(Equation)),
)
# A value at half a code may fall to either side: pow rounds by the system's library.
ONE_CODE = 1.01 / 255.0


def drawn_rules(draw: Draw) -> tuple[Blending, plain.Rules]:
    """Draw one set of rules, the halves alike or apart."""
    rgb, constant = draw(RULE), draw(COLOUR)
    alpha = draw(RULE) if draw(BOOL) else rgb
    rules = Blending(rgb[0], rgb[1], alpha[0], alpha[1], rgb[2], alpha[2], constant)
    return rules, plain.Rules(rgb, alpha, constant)


def drawn_state(draw: Draw, side: int) -> tuple[State, plain.State]:
    """Draw which operations are on."""
    blending, rules = drawn_rules(draw) if draw(BOOL) else (None, None)
    mask = draw(st.tuples(BOOL, BOOL, BOOL, BOOL))
    ends = [sorted(draw(st.tuples(*[st.integers(-2, side + 2)] * 2))) for _ in "yx"]
    some = draw(BOOL)
    scissor = tuple(slice(*pair) for pair in ends) if some else None
    ranges = tuple(range(*pair) for pair in ends) if some else None
    func = draw(st.none() | st.sampled_from(typing.get_args(DepthFunc)))
    writes = draw(BOOL)
    return (
        State(blending, mask, scissor, func, writes),  # type: ignore[arg-type]
        plain.State(rules, mask, ranges, func, writes),  # type: ignore[arg-type]
    )


def filled(draw: Draw, side: int, format: str) -> raster.Framebuffer:
    """Draw a framebuffer whose pixels the format holds."""
    values = draw(arrays(np.float64, (side, side, 4), elements=CHANNEL))
    depth = draw(arrays(np.float64, (side, side), elements=DEPTH))
    return raster.Framebuffer(formats.stored(values, format).copy(), depth, format)


@twin(raster.stored, plain.stored, tolerance=0, why="the same roundings")
def stored(draw: Draw):
    color, format = draw(COLOUR), draw(FLOATS_AND_CODES)
    return raster.stored(color, format), plain.stored(color, format)


@twin(raster.stored, plain.stored, tolerance=ONE_CODE, why="half a code, by pow")
def stored_encoded(draw: Draw):
    color = draw(COLOUR)
    encoded = raster.stored(color, "SRGB8_ALPHA8")
    return encoded, plain.stored(color, "SRGB8_ALPHA8")


@twin(
    blending.blended_as,
    plain.blended_as,
    tolerance=ONE_CODE,
    why="half a code, by pow; the float formats stand in draw_fragments, exactly",
)
def blended_as(draw: Draw):
    (rules, plainly), source = drawn_rules(draw), draw(COLOUR)
    pixel, format = raster.stored(draw(COLOUR), "SRGB8_ALPHA8"), "SRGB8_ALPHA8"
    actual = blending.blended_as(np.array(source), pixel, rules, format)
    return actual, plain.blended_as(source, pixel.tolist(), plainly, format)


@twin(
    llvmpipe.blended_llvmpipe,
    plain_llvmpipe.blended_llvmpipe,
    tolerance=0,
    why="the same float32 and whole numbers",
)
def blended_llvmpipe(draw: Draw):
    (rules, plainly), source = drawn_rules(draw), draw(COLOUR)
    format = draw(FORMAT.filter(lambda name: name != "RGBA64F"))
    pixel = raster.stored(draw(COLOUR), format, arithmetic="llvmpipe")
    actual = llvmpipe.blended_llvmpipe(np.array(source), pixel, rules, format)
    expected = plain_llvmpipe.blended_llvmpipe(source, pixel.tolist(), plainly, format)
    return actual, expected


@twin(raster.draw_fragments, plain.draw_fragments, tolerance=0, why="the same sums")
def draw_fragments(draw: Draw):
    format = draw(FLOATS_AND_CODES | st.just("RGBA64F"))
    buffer = filled(draw, 3, format)
    state, plainly = drawn_state(draw, 3)
    source = draw(arrays(np.float64, (2, 2, 4), elements=CHANNEL))
    depth = draw(arrays(np.float64, (2, 2), elements=DEPTH))
    top, left = draw(st.integers(0, 1)), draw(st.integers(0, 1))
    fragments = [
        (top + j, left + i, float(depth[j, i]), source[j, i].tolist())
        for j in range(2)
        for i in range(2)
    ]
    pixels, depths = buffer.pixels.tolist(), buffer.depth.tolist()
    box = slice(top, top + 2), slice(left, left + 2)
    raster.draw_fragments(buffer, *box, source, depth=depth, state=state)
    plain.draw_fragments(pixels, depths, fragments, plainly, format)
    return _all_of(buffer.pixels, buffer.depth), _all_of(pixels, depths)


@twin(raster.clear, plain.clear, tolerance=0, why="the same roundings")
def clear(draw: Draw):
    format, color, depth = draw(FLOATS_AND_CODES), draw(COLOUR), draw(DEPTH)
    buffer = filled(draw, 3, format)
    state, plainly = drawn_state(draw, 3)
    pixels, depths = buffer.pixels.tolist(), buffer.depth.tolist()
    raster.clear(buffer, color, depth=depth, state=state)
    plain.clear(pixels, depths, color, depth, plainly, format)
    return _all_of(buffer.pixels, buffer.depth), _all_of(pixels, depths)


@twin(
    raster.read_average,
    plain.read_average,
    tolerance=1e-15,
    why="at most 9 numbers, added in another order",
)
def read_average(draw: Draw):
    buffer = filled(draw, 3, draw(FORMAT))
    ends = [sorted(draw(st.tuples(*[st.integers(-3, 6)] * 2))) for _ in "yx"]
    actual = raster.read_average(buffer, slice(*ends[0]), slice(*ends[1]))
    boxes = [range(*pair) for pair in ends]
    expected = plain.read_average(buffer.pixels.tolist(), *boxes)
    return ([] if mean is None else mean for mean in (actual, expected))


@twin(
    raster.seen_through_layers,
    plain.seen_through_layers,
    tolerance=0,
    why="the same products and roundings",
)
def seen_through_layers(draw: Draw):
    alpha, layers = draw(st.floats(0.0, 1.0)), draw(st.integers(0, 20))
    format = draw(FLOATS_AND_CODES)
    actual = raster.seen_through_layers(alpha, layers, format=format)
    return actual, plain.seen_through_layers(alpha, layers, format)


def _all_of(pixels: typing.Any, depths: typing.Any) -> np.ndarray:
    return np.concatenate([np.ravel(pixels), np.ravel(depths)])
