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
from refcloud.raster import Framebuffer, blend, framebuffer
from refcloud.raster.blending import Equation, Factor, blend_patch, blended

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
