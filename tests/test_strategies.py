"""The strategies draw what the check lets in, and reach what they should."""

from __future__ import annotations

from typing import Annotated, Any, Literal

import numpy as np
import pytest
from hypothesis import find, given, settings
from hypothesis import strategies as st
from strategies import FARTHEST, arguments_for, numbers_in, values_for

from refcloud.checking import check, checked
from refcloud.conventions import Array, Colour, Positive, Range, Seed, Shape, Vector
from refcloud.image import srgb_encode, to_codes
from refcloud.raster import transmittance

HINTS: dict[str, Any] = {
    "float": float,
    "int": int,
    "bool": bool,
    "str": str,
    "share": Annotated[float, Range(0.0, 1.0)],
    "open share": Annotated[float, Range(0, 1, "1", open_lower=True, open_upper=True)],
    "positive": Annotated[float, Positive],
    "far": Annotated[float, Range(1e6)],
    "below": Annotated[float, Range(upper=-5.0)],
    "seed": Seed,
    "count": Annotated[int, Range(1, 9)],
    "open count": Annotated[int, Range(0, 3, "1", open_lower=True, open_upper=True)],
    "vector": Vector,
    "colour": Colour,
    "array": Array,
    "points": Annotated[Array, Shape("...", 3)],
    "picture": Annotated[Array, Shape("H", "W", 3), Range(0.0, 1.0)],
    "scalars": Annotated[Array, Shape("...")],
    "choice": Literal["disc", "square"],
    "maybe": Annotated[float, Range(0.0, 1.0)] | None,
    "pair": tuple[Annotated[int, Range(0, 3)], float],
    "many": tuple[Annotated[float, Range(0.0)], ...],
}
QUICK = settings(max_examples=30)


@QUICK
@pytest.mark.parametrize("hint", HINTS.values(), ids=HINTS)
@given(data=st.data())
def test_what_is_drawn_passes_the_check(hint: Any, data: st.DataObject) -> None:
    value = data.draw(values_for(hint))
    back = check("value", value, hint)
    if isinstance(value, np.ndarray):
        np.testing.assert_array_equal(back, value)
    else:
        assert back == value


@QUICK
@given(data=st.data())
def test_a_letter_is_one_size_in_one_call(data: st.DataObject) -> None:
    sizes: dict[str, int] = {}
    one = data.draw(values_for(Annotated[Array, Shape("N", 3)], sizes))
    other = data.draw(values_for(Annotated[Array, Shape("N")], sizes))
    assert len(one) == len(other) == sizes["N"]


@pytest.mark.parametrize("end", [0.0, 1.0])
def test_closed_ends_are_reached(end: float) -> None:
    assert find(numbers_in(Range(0.0, 1.0)), lambda value: value == end) == end


def test_missing_ends_are_far_away() -> None:
    assert find(numbers_in(Range()), lambda value: value > FARTHEST / 2)
    assert find(numbers_in(Range()), lambda value: value < -FARTHEST / 2)
    assert find(numbers_in(Range(1e6)), lambda value: value > 1e6)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_leading_axes_come_in_every_number(count: int) -> None:
    points = values_for(Annotated[Array, Shape("...", 3)])
    assert find(points, lambda value: value.ndim == count + 1).shape[-1] == 3


@QUICK
@pytest.mark.parametrize("function", [srgb_encode, to_codes, transmittance])
@given(data=st.data())
def test_whole_calls_are_let_in(function, data: st.DataObject) -> None:
    arguments = data.draw(arguments_for(function))
    assert np.isfinite(function(**arguments)).all()


@QUICK
@given(data=st.data())
def test_calls_share_their_letters_and_take_given_strategies(data) -> None:
    @checked
    def scale(
        points: Annotated[Array, Shape("N", 3)],
        by: Annotated[Array, Shape("N")],
        *,
        how: object = None,
    ) -> Array:
        assert how == "by hand"
        return points * by[:, None]

    hand = st.just("by hand")
    arguments = data.draw(arguments_for(scale, how=hand))
    assert scale(**arguments).shape == arguments["points"].shape


def test_a_default_is_left_out_at_times_and_given_at_times() -> None:
    calls = arguments_for(to_codes)
    assert "tone" not in find(calls, lambda call: "tone" not in call)
    assert "tone" in find(calls, lambda call: "tone" in call)


def test_what_has_no_strategy_is_named() -> None:
    with pytest.raises(TypeError, match=r"no strategy for .*slice"):
        values_for(slice)
