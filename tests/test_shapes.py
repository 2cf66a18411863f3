"""Arguments of shapes that do not go together are refused by both names."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refcloud import cloudmap, image, lighting, march, metaballs, noise, sky, transport
from refcloud.checking import checked
from refcloud.conventions import Array, Shape
from refcloud.lighting import Octaves
from refcloud.shapes import elementwise, refuse_unlike

TWO, THREE = np.full(2, 0.5), np.full(3, 0.5)
PAIR, TRIPLE = np.eye(3)[:2], np.eye(3)
BOX = {"lower": np.zeros(3), "upper": np.ones(3)}


@pytest.mark.parametrize(
    ("call", "first", "second"),
    [
        (lambda: noise.linear(TWO, THREE, TWO), "a", "b"),
        (lambda: noise.cosine(TWO, TWO, THREE), "a", "t"),
        (lambda: noise.hermite(0.5, TWO, THREE), "b", "t"),
        (lambda: noise.quintic(TWO, THREE, TWO), "a", "b"),
        (lambda: noise.cubic(TWO, TWO, TWO, TWO, THREE), "v0", "t"),
        (lambda: noise.catmull_rom(TWO, TWO, THREE, TWO, TWO), "v0", "v2"),
        (lambda: noise.remap(TWO, 0.0, THREE, 0.0, 1.0), "values", "h0"),
        (lambda: noise.wrapped_bilinear(np.eye(2), TWO, THREE), "x", "y"),
        (lambda: metaballs.wyvill(TWO, THREE), "r", "R"),
        (lambda: metaballs.gaussian(TWO, THREE), "r", "sigma"),
        (lambda: metaballs.printed_wyvill(TWO, THREE), "r", "R"),
        (lambda: transport.cell_mean(TWO, THREE), "tau", "own"),
        (
            lambda: transport.folded_beams(TWO, TWO, THREE, turned=0.5),
            *("tau", "own"),
        ),
        (lambda: cloudmap.modulate(TWO, THREE), "Q", "noise"),
        (lambda: march.ray_box(PAIR, TRIPLE, **BOX), "origins", "directions"),
        (lambda: lighting.eroded(TWO, THREE, erosion=0.5), "weight", "noise"),
        (lambda: lighting.lit_share(TWO, THREE, relief=0.5), "noise", "ahead"),
        (
            lambda: lighting.octave_source(
                TWO, THREE, g=0.5, albedo=0.9, octaves=Octaves()
            ),
            *("cos_theta", "tau"),
        ),
    ],
)
def test_both_arguments_and_shapes_are_named(call, first: str, second: str) -> None:
    line = rf"^{second}: expected a shape that fits {first} of \(.*\), got"
    with pytest.raises(ValueError, match=rf"{line} shape \([^\n]*\)$"):
        call()


Any_ = Annotated[Array, Shape("...")]


@checked
def example(
    a: Array, b: Any_, c: Annotated[Array, Shape("...", 3)], d: Any_ | None = None
) -> tuple[int, ...]:
    return np.broadcast_shapes(a.shape, b.shape, c.shape[:-1])


@given(st.lists(st.lists(st.integers(1, 3), max_size=3).map(tuple), min_size=3))
def test_it_refuses_just_what_numpy_cannot_broadcast(shapes: list[Any]) -> None:
    a, b, c = shapes[:3]
    arguments = np.ones(a), np.ones(b), np.ones((*c, 3))
    try:
        expected = np.broadcast_shapes(a, b, c)
    except ValueError:
        with pytest.raises(ValueError, match=r"^[bc]: expected a shape that fits"):
            example(*arguments)
        return
    assert example(*arguments) == expected
    # What may be absent has its own rules.
    assert example(*arguments, d=np.ones(7)) == expected


def test_only_shapes_that_are_open_go_together() -> None:
    vector = Annotated[Array, Shape(3)]
    assert elementwise({"a": Array, "b": vector, "return": Array}) == {}
    assert elementwise({"a": Array, "b": Any_, "c": float}) == {"a": 0, "b": 0}
    refuse_unlike({"a": np.ones(2), "c": 3.0}, {"a": 0, "b": 0})


@pytest.mark.parametrize(
    "call",
    [
        lambda: image.largest_difference(np.ones((2, 2)), np.ones((3, 2))),
        lambda: sky.fogged(PAIR, THREE, density=1.0, color=THREE),
        lambda: sky.base_density(TWO, THREE, sky.FlatBase()),
        lambda: lighting.sky_source(TWO, THREE, octaves=Octaves()),
    ],
)
def test_others_refuse_in_one_line_too(call: Callable[[], Any]) -> None:
    with pytest.raises(ValueError, match=r"^[a-z]+: expected [^\n]*, got [^\n]*$"):
        call()
