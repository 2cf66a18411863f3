"""Every blend factor and equation against scalar arithmetic, and what blends obey."""

from __future__ import annotations

import itertools
import typing

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from refcloud.plain import raster as plain
from refcloud.raster import Blending, Framebuffer, blend, draw_fragments, framebuffer
from refcloud.raster.blending import blend_patch, blended, blended_as
from refcloud.raster.factors import Equation, Factor
from refcloud.raster.store import State

FACTORS = typing.get_args(Factor)
EQUATIONS = typing.get_args(Equation)
PAIRS = list(itertools.product(FACTORS, FACTORS))
# Beyond [0, 1] on both sides: a float buffer clamps nothing.
CHANNEL = st.floats(-4.0, 4.0) | st.sampled_from([0.0, 1.0, -1.0, 0.5])
COLOUR = arrays(np.float64, 4, elements=CHANNEL)
ROUNDING = 1e-15  # rounding of s f and d f, each up to 4 x 5, and of their sum


def patches(height: int, width: int) -> st.SearchStrategy[np.ndarray]:
    return arrays(np.float64, (height, width, 4), elements=CHANNEL)


def colours(seed: int, count: int = 64) -> np.ndarray:
    """Spread colours over [-2, 3] by multiples of irrational numbers."""
    steps = np.sqrt([2.0, 3.0, 5.0, 7.0]) * np.arange(1, count + 1)[:, None]
    return (steps * (seed + 1)) % 1.0 * 5.0 - 2.0


def test_names_are_all_of_opengl() -> None:
    assert len(FACTORS) == 15
    assert len(EQUATIONS) == 5


@pytest.mark.parametrize("equation", EQUATIONS)
@pytest.mark.parametrize(("src_factor", "dst_factor"), PAIRS)
def test_every_blend_is_scalar_arithmetic(
    src_factor: str, dst_factor: str, equation: str
) -> None:
    source, destination = colours(1), colours(2)
    constant = np.array([0.3, 0.7137, 0.45, 0.62])
    actual = blended(source, destination, src_factor, dst_factor, equation, constant)
    for row in range(len(source)):
        expected = plain.blend(
            source[row].tolist(),
            destination[row].tolist(),
            src_factor,
            dst_factor,
            equation,
            constant.tolist(),
        )
        assert actual[row].tolist() == expected, "the same products, the same bits"


@given(
    source=patches(2, 3),
    below=patches(4, 5),
    constant=COLOUR,
    factors=st.tuples(st.sampled_from(FACTORS), st.sampled_from(FACTORS)),
    equation=st.sampled_from(EQUATIONS),
    top=st.integers(0, 2),
    left=st.integers(0, 2),
)
def test_blend_writes_its_box_and_nothing_else(
    source, below, constant, factors, equation, top, left
) -> None:
    buffer = Framebuffer(below.copy())
    rows, columns = slice(top, top + 2), slice(left, left + 3)
    blend(buffer, rows, columns, source, *factors, equation=equation, constant=constant)
    expected = below.copy()
    expected[rows, columns] = blended(
        source, below[rows, columns], *factors, equation, constant
    )
    np.testing.assert_array_equal(buffer.pixels, expected)


@given(source=patches(3, 2), below=patches(3, 2))
def test_the_short_way_of_splats_is_the_general_rule(source, below) -> None:
    short, pair = below.copy(), ("ONE", "ONE_MINUS_SRC_ALPHA", "FUNC_ADD")
    blend_patch(short, source, *pair)
    np.testing.assert_array_equal(short, blended(source, below, *pair, np.zeros(4)))


@given(a=patches(2, 2), b=patches(2, 2), below=patches(2, 2))
def test_over_is_associative(a, b, below) -> None:
    pair = ("ONE", "ONE_MINUS_SRC_ALPHA", "FUNC_ADD", np.zeros(4))
    one_by_one = blended(b, blended(a, below, *pair), *pair)
    at_once = blended(blended(b, a, *pair), below, *pair)
    # Terms up to 4 x 5 x 5 = 100; six operations: 6e-14, and a margin of 2.
    np.testing.assert_allclose(one_by_one, at_once, rtol=0, atol=1.2e-13)


@given(
    source=patches(2, 2),
    below=patches(2, 2),
    factors=st.tuples(st.sampled_from(FACTORS), st.sampled_from(FACTORS)),
    equation=st.sampled_from(["MIN", "MAX"]),
)
def test_min_and_max_leave_the_factors_out(source, below, factors, equation) -> None:
    whole = blended(source, below, "ONE", "ONE", equation, np.zeros(4))
    other = blended(source, below, *factors, equation, np.zeros(4))
    np.testing.assert_array_equal(whole, other)


@given(
    source=patches(2, 2),
    below=patches(2, 2),
    factors=st.tuples(st.sampled_from(FACTORS), st.sampled_from(FACTORS)),
)
def test_subtract_and_reverse_subtract_are_opposites(source, below, factors) -> None:
    one = blended(source, below, *factors, "FUNC_SUBTRACT", np.zeros(4))
    other = blended(source, below, *factors, "FUNC_REVERSE_SUBTRACT", np.zeros(4))
    np.testing.assert_array_equal(one, -other)


@given(source=patches(2, 2), below=patches(2, 2))
def test_keep_and_replace(source, below) -> None:
    none = np.zeros(4)
    kept = blended(source, below, "ZERO", "ONE", "FUNC_ADD", none)
    replaced = blended(source, below, "ONE", "ZERO", "FUNC_ADD", none)
    np.testing.assert_array_equal(kept, below)
    np.testing.assert_array_equal(replaced, source)


@given(below=patches(3, 3))
@settings(max_examples=20)
def test_a_part_of_the_buffer_may_be_blended_onto_another_part(below) -> None:
    buffer = Framebuffer(below.copy())
    upper, rest = slice(0, 2), slice(1, 3)
    blend(buffer, rest, slice(None), buffer.pixels[upper], "ONE", "ONE")
    np.testing.assert_array_equal(buffer.pixels[rest], below[upper] + below[rest])


def test_saturate_leaves_alpha_whole() -> None:
    buffer = framebuffer(1, 1, color=[0.2, 0.2, 0.2, 0.75])
    light = [[[1.0, 1.0, 1.0, 0.5]]]
    box = slice(0, 1), slice(0, 1)
    blend(buffer, *box, light, "SRC_ALPHA_SATURATE", "ONE")
    np.testing.assert_allclose(
        buffer.pixels[0, 0], [0.45, 0.45, 0.45, 1.25], rtol=ROUNDING
    )


@pytest.mark.parametrize(
    ("rows", "columns", "shape", "message"),
    [
        (slice(0, 3), slice(0, 4), (2, 4, 4), r"source: expected shape \(3, 4, 4\)"),
        (slice(0, 4), slice(0, 4), (4, 4, 4), "rows: expected a slice"),
        (slice(-1, 2), slice(0, 4), (3, 4, 4), "rows: expected a slice"),
        (slice(0, 2), slice(3, 1), (2, 2, 4), "columns: expected a slice"),
        (slice(0, 3, 2), slice(0, 4), (2, 4, 4), "rows: expected a slice"),
        (slice(0.0, 3), slice(0, 4), (3, 4, 4), "rows: expected a slice"),
        (slice(0, 3), slice(0, 4), (3, 4, 3), r"source: expected an array of shape"),
    ],
)
def test_a_wrong_box_is_refused(rows, columns, shape, message) -> None:
    with pytest.raises(ValueError, match=message):
        blend(framebuffer(4, 3), rows, columns, np.zeros(shape), "ONE", "ZERO")


@pytest.mark.parametrize("name", ["SRC1_COLOR", "GL_ONE", "one", ""])
def test_a_wrong_name_is_refused(name: str) -> None:
    box = slice(0, 1), slice(0, 1)
    with pytest.raises(ValueError, match=f"src_factor.*got {name!r}"):
        blend(framebuffer(1, 1), *box, np.zeros((1, 1, 4)), name, "ONE")


few = settings(max_examples=25)
RULES = st.tuples(
    st.sampled_from(FACTORS), st.sampled_from(FACTORS), st.sampled_from(EQUATIONS)
)


@few
@given(source=patches(2, 2), below=patches(2, 2), rgb=RULES, alpha=RULES, c=COLOUR)
def test_alpha_has_rules_of_its_own(source, below, rgb, alpha, c) -> None:
    buffer, box = Framebuffer(below.copy()), (slice(None), slice(None))
    blend(
        buffer,
        *box,
        source,
        *rgb[:2],
        src_alpha=alpha[0],
        dst_alpha=alpha[1],
        equation=rgb[2],
        equation_alpha=alpha[2],
        constant=c,
    )
    colours_ = blended(source, below, *rgb, c)
    alphas = blended(source, below, *alpha, c)
    np.testing.assert_array_equal(buffer.pixels[..., :3], colours_[..., :3])
    np.testing.assert_array_equal(buffer.pixels[..., 3], alphas[..., 3])


@pytest.mark.parametrize("format", ["RGBA32F", "RGBA16F", "RGBA8", "SRGB8_ALPHA8"])
@few
@given(source=patches(2, 2), below=patches(2, 2), rgb=RULES, alpha=RULES, c=COLOUR)
def test_both_arithmetics_stay_near_each_other(
    format, source, below, rgb, alpha, c
) -> None:
    # Colours of [-4, 4]: two terms of at most 4 x 5 each; a step of float16 is there
    # 1/64. Codes: source, factor and product rounded, each by half a code at most;
    # llvmpipe's curve is 1.2e-3 off where a code is 3e-4 of linear light: 8 codes.
    most = {"RGBA32F": 1e-5, "RGBA16F": 1 / 32, "RGBA8": 3.1 / 255}
    buffer = framebuffer(2, 2, format=format)
    draw_fragments(buffer, slice(None), slice(None), below)
    rules = Blending(rgb[0], rgb[1], alpha[0], alpha[1], rgb[2], alpha[2], c)
    ideal, driver = (
        blended_as(source, buffer.pixels, rules, format, arithmetic)
        for arithmetic in ("ideal", "llvmpipe")
    )
    assert np.abs(ideal - driver).max() <= most.get(format, 9.1 / 255)
    if format in ("RGBA8", "SRGB8_ALPHA8"):
        assert (ideal >= 0.0).all()
        assert (ideal <= 1.0).all()


@few
@given(source=patches(3, 2), below=patches(3, 2))
def test_without_blending_the_new_colour_stays(source, below) -> None:
    box = slice(None), slice(None)
    for state in (State(), State(blending=Blending())):
        buffer = Framebuffer(below.copy())
        draw_fragments(buffer, *box, source, state=state)
        np.testing.assert_array_equal(buffer.pixels, source)


def test_nothing_is_drawn_where_the_scissor_is_empty() -> None:
    buffer, box = framebuffer(4, 4, depth=1.0), (slice(0, 3), slice(0, 3))
    for rows in (slice(3, 9), slice(-5, 0), slice(2, 1)):
        state = State(scissor=(rows, slice(0, 4)), depth_func="ALWAYS")
        draw_fragments(buffer, *box, np.ones((3, 3, 4)), depth=0.5, state=state)
    assert not buffer.pixels.any()
    assert (buffer.depth == 1.0).all()


def test_nearest_fragments_win_in_any_order() -> None:
    state, box = State(depth_func="LESS"), (slice(0, 1), slice(0, 3))
    red, blue = np.array([1.0, 0, 0, 1]), np.array([0, 0, 1.0, 1])
    layers = [(red, [0.2, 0.6, 0.5]), (blue, [0.4, 0.4, 0.4])]
    for order in (layers, layers[::-1]):
        buffer = framebuffer(3, 1, depth=1.0)
        for color, depth in order:
            source = np.broadcast_to(color, (1, 3, 4))
            draw_fragments(buffer, *box, source, depth=[depth], state=state)
        assert buffer.pixels[0].tolist() == [red.tolist(), *[blue.tolist()] * 2]
        assert buffer.depth.tolist() == [[0.2, 0.4, 0.4]]


@pytest.mark.parametrize("name", ["SRC1_COLOR", "ONE_MINUS_SRC1_ALPHA"])
def test_a_second_source_is_refused_by_name(name: str) -> None:
    with pytest.raises(ValueError, match=f"dst_alpha: .*one of 'ZERO', .*got '{name}'"):
        Blending(dst_alpha=name)  # type: ignore[arg-type]


@pytest.mark.parametrize("format", ["RGBA32F", "RGBA16F", "RGBA8", "SRGB8_ALPHA8"])
@pytest.mark.parametrize("arithmetic", ["ideal", "llvmpipe"])
@few
@given(source=COLOUR, rgb=RULES, huge=st.sampled_from([1e30, 1e300]))
def test_no_colour_is_too_large(format, arithmetic, source, rgb, huge) -> None:
    buffer = framebuffer(1, 1, color=source, format=format, arithmetic=arithmetic)
    box, constant = (slice(None), slice(None)), source * -huge
    for _ in range(2):  # the second blend meets what the first left
        how = {"equation": rgb[2], "constant": constant}
        blend(buffer, *box, source[None, None] * huge, *rgb[:2], **how)
        assert np.isfinite(buffer.pixels).all()
