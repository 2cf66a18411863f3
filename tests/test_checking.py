"""Every refusal is one clear line; what fits comes through as floats and arrays."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import refcloud as rc
from refcloud import Metaballs, Picture, VoxelGrid
from refcloud.checking import check, check_fields, checked, complaint
from refcloud.conventions import (
    Array,
    Colour,
    MayBeNotFinite,
    Positive,
    Range,
    Seed,
    Shape,
    Skipped,
    Vector,
    unit_vector,
)

SHARE = Annotated[float, Range(0.0, 1.0)]
COUNT = Annotated[int, Range(1, 9, "balls")]
POINTS = Annotated[Array, Shape("N", 3)]
LIGHT = Annotated[Array, Shape("N", 3), Range(0.0)]
MARK = 123456.789  # stands in the arrays: no refusal may print it


Errors = type[Exception] | tuple[type[Exception], ...]


def refusal(value: Any, hint: Any, error: Errors = ValueError) -> str:
    """Return the text of a refusal, after the tests that hold for all of them."""
    with pytest.raises(error) as caught:
        check("thing", value, hint)
    text = str(caught.value)
    assert text.startswith("thing"), "names the argument"
    assert ": expected " in text
    assert ", got " in text
    assert "\n" not in text
    assert len(text) < 200
    assert str(MARK) not in text
    return text


@pytest.mark.parametrize(
    ("value", "hint", "error", "message"),
    [
        (2, SHARE, ValueError, "thing: expected a finite number in [0, 1], got 2;"),
        (-0.1, SHARE, ValueError, "got -0.1; choose within [0, 1]"),
        (math.nan, SHARE, ValueError, "expected a finite number in [0, 1], got nan"),
        (math.inf, float, ValueError, "expected a finite number, got inf"),
        (-math.inf, float, ValueError, "got -inf"),
        (10**400, float, ValueError, "got inf"),
        (-(10**400), SHARE, ValueError, "got inf"),
        (Fraction(10**400, 3), float, ValueError, "got inf"),
        ("1", float, TypeError, "expected a finite number, got '1'"),
        (None, float, TypeError, "got None"),
        (True, float, TypeError, "got True"),
        (np.True_, float, TypeError, "got a bool"),
        (1j, float, TypeError, "got a complex"),
        ([1.0], float, TypeError, "got a list"),
        (np.full(3, MARK), float, TypeError, "an array of float64 with shape (3,)"),
        (0, Annotated[float, Positive], ValueError, "in (0, inf), got 0"),
        (1.5, int, TypeError, "expected a whole number, got 1.5"),
        (2.0, int, TypeError, "expected a whole number, got 2.0"),
        (math.nan, int, TypeError, "expected a whole number, got nan"),
        (0, COUNT, ValueError, "a whole number in [1, 9] (balls), got 0"),
        (10, COUNT, ValueError, "got 10; choose within [1, 9]"),
        (2**63, Seed, ValueError, "expected a whole number in [-9223372036854775808"),
        (10**400, Seed, ValueError, "expected a whole number in"),
        (np.zeros((2, 2)), POINTS, ValueError, ", got shape (2, 2)"),
        (MARK, POINTS, ValueError, "an array of shape (N, 3), got shape ()"),
        ([[1, 2, 3], [4, 5]], POINTS, ValueError, "got rows of unequal length"),
        ([["a", "b", "c"]], POINTS, TypeError, "of numbers, got a list"),
        (np.full((1, 3), True), POINTS, TypeError, "an array of bool with shape"),
        (np.full((1, 3), 1j), POINTS, TypeError, "of complex128 with shape (1, 3)"),
        ([[None, 1, 2]], POINTS, TypeError, "of numbers"),
        ({1, 2, 3}, Vector, TypeError, "of numbers, got a set"),
        ([[MARK, math.nan, 1]], POINTS, ValueError, "got 1 NaN or infinite of 3"),
        ([math.inf, math.nan, MARK], Vector, ValueError, "got 2 NaN or infinite of 3"),
        ([0.5, -1.0, 2.0], Colour, ValueError, "in [0, inf) (radiance), got -1 to 2"),
        ([10**400, 0, 0], Vector, (TypeError, ValueError), "expected"),
        (
            "sqare",
            Literal["disc", "square"],
            ValueError,
            "expected one of 'disc', 'square', got 'sqare'",
        ),
        (["disc"], Literal["disc"], ValueError, "expected one of 'disc', got a list"),
        (np.full(3, MARK), Literal["disc"], ValueError, "with shape (3,)"),
        ("x" * 500, Literal["disc"], ValueError, "xxx..."),
        (1, str, TypeError, "expected a text, got 1"),
        (1, bool, TypeError, "expected True or False, got 1"),
        ("a", Callable[[int], int], TypeError, "expected a function, got 'a'"),
        ([], Mapping[str, float], TypeError, "expected a Mapping, got a list"),
        ("a", slice, TypeError, "expected a slice, got 'a'"),
        (0, None, TypeError, "expected a NoneType, got 0"),
        (3, tuple[int, int], TypeError, "expected a tuple, got 3"),
        ((1, 2, 3), tuple[int, int], ValueError, "expected 2 values, got 3 values"),
        ((1, 2.5), tuple[int, int], TypeError, "thing[1]: expected a whole number"),
        ((1, -1), tuple[SHARE, ...], ValueError, "thing[1]: expected a finite number"),
        ("a", SHARE | None, TypeError, "expected a finite number in [0, 1], got 'a'"),
        (2, SHARE | str, ValueError, "in [0, 1] or a text, got 2"),
        ([1], SHARE | str, TypeError, "got a list"),
        ([1, math.nan, 2], Colour | POINTS, ValueError, "got 1 NaN or infinite of 3"),
        ([[1, -7.0, 2]], str | Vector | LIGHT, ValueError, "numbers in [0, inf)"),
    ],
    ids=lambda value: str(value)[:30],
)
def test_what_does_not_fit_is_refused_in_one_line(value, hint, error, message) -> None:
    assert message in refusal(value, hint, error)


@pytest.mark.parametrize(
    ("value", "hint", "result"),
    [
        (1, float, 1.0),
        (Fraction(1, 4), SHARE, 0.25),
        (np.float32(0.5), SHARE, 0.5),
        (np.array(0.5), SHARE, 0.5),
        (np.int8(3), COUNT, 3),
        (np.array(3), COUNT, 3),
        (-0.0, SHARE, 0.0),
        (5e-324, Annotated[float, Positive], 5e-324),
        (10**300, float, 1e300),
        (2**63 - 1, Seed, 2**63 - 1),
        ("disc", Literal["disc", "square"], "disc"),
        (None, SHARE | None, None),
        ("a", SHARE | str, "a"),
        ([1, 2], tuple[float, int], (1.0, 2)),
        ((), tuple[float, ...], ()),
        (None, None, None),
        ("anything", Any, "anything"),
        (len, Callable[[Any], int], len),
    ],
)
def test_what_fits_comes_through(value, hint, result) -> None:
    back = check("thing", value, hint)
    assert back == result
    assert type(back) is type(result)


@given(st.integers())
def test_a_seed_is_any_64_bit_number_and_no_other(seed: int) -> None:
    if -(2**63) <= seed < 2**63:
        assert check("seed", seed, Seed) == seed
    else:
        with pytest.raises(ValueError, match="seed: expected a whole number in"):
            check("seed", seed, Seed)


@given(st.floats(), st.floats(), st.floats(), st.booleans(), st.booleans())
def test_a_range_holds_what_lies_between_its_ends(
    value, lower, upper, open_lower, open_upper
) -> None:
    limits = Range(lower, upper, open_lower=open_lower, open_upper=open_upper)
    above = value > lower or (value == lower and not open_lower)
    below = value < upper or (value == upper and not open_upper)
    assert limits.holds(value) is (above and below)
    assert limits.holds(np.array([value, value])) is (above and below)


@pytest.mark.parametrize(
    ("limits", "text"),
    [
        (Range(0, 1), "[0, 1]"),
        (Range(), "(-inf, inf)"),
        (Range(0), "[0, inf)"),
        (Range(0, 1, "1", open_lower=True, open_upper=True), "(0, 1)"),
        (Range(upper=2.5), "(-inf, 2.5]"),
    ],
)
def test_a_range_reads_as_an_interval(limits: Range, text: str) -> None:
    assert str(limits) == text


@pytest.mark.parametrize(
    ("shape", "fits", "other"),
    [
        (Shape(3), [(3,)], [(), (4,), (3, 1)]),
        (Shape("N", 3), [(0, 3), (7, 3)], [(3,), (3, 7), (1, 7, 3)]),
        (Shape("...", 3), [(3,), (5, 3), (2, 5, 3)], [(), (3, 2)]),
        (Shape("..."), [(), (1,), (2, 3, 4)], []),
        (Shape("n", "n"), [(2, 2)], [(2, 3)]),
        (Shape(), [()], [(1,)]),
    ],
)
def test_shapes(shape: Shape, fits: list, other: list) -> None:
    assert all(shape.fits(size, {}) for size in fits)
    assert not any(shape.fits(size, {}) for size in other)


def test_shapes_read_as_tuples() -> None:
    assert str(Shape("H", "W", 3)) == "(H, W, 3)"
    assert str(Shape(3)) == "(3,)"
    assert str(Shape("...", 3)) == "(..., 3)"


def test_a_letter_is_one_size_in_one_call() -> None:
    @checked
    def pair(a: POINTS, b: Annotated[Array, Shape("N")]) -> tuple[int, ...]:
        return a.shape + b.shape

    assert pair(np.zeros((4, 3)), np.zeros(4)) == (4, 3, 4)
    assert pair(np.zeros((5, 3)), np.zeros(5)) == (5, 3, 5)
    with pytest.raises(ValueError, match=r"b: .*\(N,\) \(N = 4\), got shape \(5,\)$"):
        pair(np.zeros((4, 3)), np.zeros(5))


@given(
    arrays(
        st.sampled_from([np.int8, np.uint64, np.float16, np.float32, np.float64]),
        (2, 3),
        elements=st.integers(0, 100),
    )
)
def test_arrays_become_read_only_float64_and_stay_the_callers(array) -> None:
    back = check("thing", array, POINTS)
    assert back.dtype == np.float64
    np.testing.assert_array_equal(back, array)
    assert not back.flags.writeable
    assert array.flags.writeable, "the caller's own array is as it was"


def test_lists_become_arrays() -> None:
    assert check("thing", [[1, 2, 3]], POINTS).tolist() == [[1.0, 2.0, 3.0]]
    assert check("thing", [], Annotated[Array, Shape("N")]).shape == (0,)


def test_marked_points_may_be_not_finite() -> None:
    hint = Annotated[Array, Shape("...", 3), MayBeNotFinite]
    back = check("thing", [math.nan, math.inf, 1.0], hint)
    np.testing.assert_array_equal(back, [math.nan, math.inf, 1.0])


def test_numbers_too_large_for_float64_are_refused_as_infinite() -> None:
    if np.finfo(np.longdouble).max > np.finfo(np.float64).max:
        large = np.array([np.finfo(np.longdouble).max] * 3)
        assert "3 NaN or infinite of 3" in refusal(large, Vector)


@checked
def example(
    a: SHARE, b: COUNT = 1, *, c: Literal["x", "y"] = "x", **rest: Any
) -> tuple[Any, ...]:
    """Give the arguments back."""
    return a, b, c, rest


def test_a_checked_function_converts_and_keeps_its_name() -> None:
    assert example(1, np.int64(2), c="y", d="free") == (1.0, 2, "y", {"d": "free"})
    assert example.__name__ == "example"
    assert example.__doc__ == "Give the arguments back."
    assert example(a=0.5) == (0.5, 1, "x", {})


@pytest.mark.parametrize(
    ("args", "kwargs", "error", "message"),
    [
        ((), {}, TypeError, "example: missing a required argument: 'a'"),
        ((0.5, 1, "y"), {}, TypeError, "example: too many positional arguments"),
        ((2.0,), {}, ValueError, "a: expected a finite number in [0, 1], got 2"),
        ((0.5,), {"c": "z"}, ValueError, "c: expected one of 'x', 'y', got 'z'"),
        ((0.5,), {"b": None}, TypeError, "b: expected a whole number in [1, 9]"),
    ],
)
def test_a_checked_function_refuses_in_one_line(args, kwargs, error, message) -> None:
    with pytest.raises(error) as caught:
        example(*args, **kwargs)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_checked_method_and_an_unmarked_parameter() -> None:
    class Ball:
        @checked
        def grown(self, by: SHARE, anything=None) -> tuple[float, Any]:
            return by, anything

    assert Ball().grown(1, anything="free") == (1.0, "free")
    with pytest.raises(ValueError, match="by: expected"):
        Ball().grown(2)


def test_errors_from_inside_pass_as_they_are() -> None:
    @checked
    def broken(a: SHARE) -> float:
        raise KeyError("inside")

    with pytest.raises(KeyError, match="inside"):
        broken(0.5)


@dataclass(frozen=True)
class Fields:
    points: POINTS
    weights: Annotated[Array, Shape("N"), Positive]
    name: Literal["a", "b"] = "a"

    def __post_init__(self) -> None:
        check_fields(self)


def test_fields_are_checked_and_converted() -> None:
    fields = Fields([[1, 2, 3]], [4])
    assert fields.points.dtype == np.float64
    assert not fields.weights.flags.writeable


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([[1, 2, 3]], [1, 2]), r"^weights: .*\(N = 1\), got shape \(2,\)$"),
        (([[1, 2, 3]], [0]), r"^weights: expected numbers in \(0, inf\), got 0 to 0"),
        (([[1, 2, 3]], [1], "c"), "^name: expected one of 'a', 'b', got 'c'$"),
    ],
)
def test_wrong_fields_are_refused(arguments, message) -> None:
    with pytest.raises(ValueError, match=message):
        Fields(*arguments)


@given(
    hint=st.sampled_from(
        [
            *(SHARE, COUNT, POINTS, Vector, Colour, Seed, Array, bool, str, None),
            *(Literal["a"], tuple[int, ...], SHARE | None),
        ]
    ),
    value=st.recursive(
        st.none()
        | st.booleans()
        | st.integers()
        | st.floats()
        | st.complex_numbers()
        | st.text()
        | st.binary()
        | arrays(st.sampled_from([np.float64, np.int32, bool, object, "U3"]), (2, 3)),
        lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner),
        max_leaves=5,
    ),
)
def test_anything_is_let_in_or_refused_in_one_line(hint: Any, value: Any) -> None:
    try:
        check("thing", value, hint)
    except (TypeError, ValueError) as error:
        text = str(error)
        assert text.startswith("thing")
        assert "\n" not in text
        assert len(text) < 200


def test_the_words_of_a_complaint() -> None:
    assert complaint("a", "b", "c") == "a: expected b, got c"
    assert complaint("a", "b", "c", "d") == "a: expected b, got c; d"


@given(arrays(np.float64, 3, elements=st.floats(allow_nan=False, allow_infinity=False)))
def test_a_unit_vector_has_length_1_and_its_direction(vector) -> None:
    if not vector.any():
        with pytest.raises(ValueError, match=r"^direction: expected a vector"):
            unit_vector(vector)
        return
    unit = unit_vector(vector)
    assert math.hypot(*unit) == pytest.approx(1.0, abs=4e-16)
    scaled = vector / np.abs(vector).max()
    np.testing.assert_allclose(unit * math.hypot(*scaled), scaled, atol=1e-15)


def test_a_zero_vector_is_refused_by_its_name() -> None:
    with pytest.raises(ValueError, match=r"^up: expected a vector that is not zero"):
        unit_vector(np.zeros(3), "up")


def test_a_row_of_the_report_is_one_line() -> None:
    row = Skipped("noise", "octaves", 2, 5, 0.0123)
    assert (
        str(row) == "noise: 2 of 5 octaves skipped,"
        " error at most 0.012 (displayed white, proved)"
    )
    sampled = Skipped("march", "rays", 2, 5, 0.0123, how="certified")
    assert str(sampled).endswith(" at most 0.012 (displayed white, certified)")
    assert str(Skipped("eye", "balls", 2, 5)).endswith("error at most 0")


def test_a_partial_call_is_checked_too() -> None:
    with pytest.raises(ValueError, match="a: expected"):
        functools.partial(example, 2.0)()


def test_values_with_many_numbers_print_short() -> None:
    balls = Metaballs(np.zeros((500, 3)), np.ones(500), np.ones(500))
    grid = VoxelGrid(np.ones((9, 9, 9)), np.zeros(3), np.ones(3))
    for value in (balls, grid, Picture(np.zeros((40, 30, 3)))):
        text = repr(value)
        assert len(text) < 80, text
        assert "\n" not in text, text


def test_a_misspelled_parameter_is_named() -> None:
    with pytest.raises(TypeError, match=r"^generate: .*'sed'; did you mean seed\?$"):
        rc.generate(sed=7)  # pyright: ignore[reportCallIssue]
    with pytest.raises(TypeError, match=r"^generate: .*argument 'zzz'$"):
        rc.generate(zzz=7)  # pyright: ignore[reportCallIssue]


@pytest.mark.parametrize("take", [rc.render, rc.approximate])
def test_a_path_for_a_cloud_is_told_how_to_load_it(take) -> None:
    line = r"^(cloud|grid): expected a .*, got a \w+; load the file first: load_voxels,"
    with pytest.raises(TypeError, match=rf"{line}.*scene_from\(load_scene\(path\)\)"):
        take(Path("x.toml"))
