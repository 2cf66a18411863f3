"""The map of stability: exact numbers, verdicts, and that it ends with no red."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refcloud.bench import stability
from refcloud.bench.stability import Axis, Found, Probe, judge, relative_error
from refcloud.bench.stability.exact import (
    MATH,
    PI,
    Exact,
    exact,
    exact_numbers,
)
from refcloud.cli import main
from refcloud.plain import optics as plain_optics

angles = st.floats(-3.0, 3.0)
# Python's own functions are right to a few last bits.
CLOSE = 1e-14


@given(angles)
def test_exact_functions_are_those_of_math(x: float) -> None:
    for name in ("exp", "expm1", "cos", "erf"):
        found, known = getattr(MATH, name)(exact(x)), getattr(math, name)(x)
        assert float(found) == pytest.approx(known, rel=CLOSE, abs=CLOSE), name
    assert float(MATH.sqrt(exact(abs(x)))) == pytest.approx(math.sqrt(abs(x)))
    assert float(MATH.fmod(exact(x), 0.75)) == math.fmod(x, 0.75)
    if abs(x) < 1.5:
        assert float(MATH.tan(exact(abs(x)))) == pytest.approx(
            math.tan(abs(x)), rel=CLOSE
        )


@given(st.floats(1e-300, 1e-3))
def test_expm1_keeps_its_digits_near_nothing(x: float) -> None:
    assert float(MATH.expm1(exact(x))) == pytest.approx(math.expm1(x), rel=CLOSE)


def test_pi_is_right_to_fifty_digits() -> None:
    known = "3.14159265358979323846264338327950288419716939937510"
    assert abs(Fraction(PI) - Fraction(known)) < Fraction(1, 10**50)


@given(st.floats(-1e300, 1e300), st.floats(-1e300, 1e300))
def test_sums_and_products_with_floats_are_exact(a: float, b: float) -> None:
    assert exact(a) + b == Fraction(a) + Fraction(b)
    assert b - exact(a) == Fraction(b) - Fraction(a)
    assert isinstance(exact(a) * b, Exact)
    assert exact(a) * b == Fraction(a) * Fraction(b)


def test_the_plain_modules_get_their_math_back() -> None:
    with exact_numbers(plain_optics):
        assert isinstance(plain_optics.beer_lambert(exact(1.0)), Exact)
    assert plain_optics.math is math


@pytest.mark.parametrize(
    ("value", "dtype", "colour"),
    [
        (1.0 + 1e-12, "float64", "green"),
        (1.0 + 1e-7, "float64", "amber"),
        (1.0 + 1e-7, "float32", "green"),
        (1.0 + 1e-3, "float32", "amber"),
        (1.1, "float64", "red"),
        (math.nan, "float64", "red"),
        (math.inf, "float64", "red"),
    ],
)
def test_a_cell_says_how_many_digits_are_right(
    value: float, dtype: str, colour: str
) -> None:
    assert judge(lambda: Found([value], [1.0]), dtype).colour == colour


def _raise(error: Exception) -> Found:
    raise error


@pytest.mark.parametrize(
    ("error", "colour"),
    [
        (ValueError("tau: expected at least 0, got -1"), "refused"),
        (ValueError("array must not contain infs or NaNs"), "red"),
        (ValueError("tau: expected 1\nor 2"), "red"),
        (ZeroDivisionError("division by zero"), "red"),
        (FloatingPointError("overflow"), "red"),
    ],
)
def test_only_one_clear_line_is_a_refusal(error: Exception, colour: str) -> None:
    assert judge(lambda: _raise(error), "float64").colour == colour


def test_an_overflow_and_a_warning_are_red() -> None:
    big = np.array([1e300])
    assert judge(lambda: Found(big * big, [1.0]), "float64").colour == "red"
    assert judge(lambda: Found(big / 0.0, [math.inf]), "float64").colour == "red"


def test_an_expected_infinity_is_no_error() -> None:
    assert relative_error(Found([math.inf, 0.0], [math.inf, 0.0])) == 0.0


def usual_form(g: float) -> Found:
    """Give Henyey-Greenstein forward with 1 + g^2 - 2 g, which cancels near g = 1."""
    with exact_numbers(plain_optics):
        right = plain_optics.henyey_greenstein(exact(1.0), exact(g))
    spread = 1.0 + g * g - 2.0 * g
    return Found([(1.0 - g * g) / (4.0 * math.pi * spread**1.5)], [right])


def test_the_map_sees_a_form_that_cancels_e36() -> None:
    colours = [
        judge(lambda g=g: usual_form(g), "float64").colour
        for g in (0.5, 1.0 - 1e-6, 1.0 - 1e-9)
    ]
    assert colours == ["green", "amber", "red"]


TINY = Probe(
    "a sum",
    "fractions",
    Axis("a", (0.1, 1 - 1e-9)),
    Axis("b", (0.2, 1e300, "x")),
    lambda a, b: Found([a + b], [Fraction(a) + Fraction(b)]),
)


def test_table_rows_and_pictures_show_every_cell() -> None:
    panels = stability.panels([TINY])
    text, rows = stability.text_of(panels), stability.rows_of(panels)
    assert "a sum" in text
    assert "red: a sum at a 0.1, b x: unsupported operand" in text
    assert [row["colour"] for row in rows] == ["green", "green", "red"] * 2
    assert rows[3]["down"] == "a 1-1e-09"
    assert stability.bare_map(panels, cell=2).linear.shape == (8, 10, 3)
    assert stability.labelled_map(panels).linear.shape[1] == 640


def test_a_quick_map_is_printed_and_drawn(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    name = str(tmp_path / "map.png")
    assert main(["bench", "stability", "--quick", "--plot", name]) == 0
    out = capsys.readouterr().out
    assert "henyey_greenstein" in out
    assert "red: " not in out
    assert (tmp_path / "map.png").exists()


@pytest.mark.slow
def test_no_cell_of_the_whole_map_is_red(tmp_path: Path) -> None:
    panels = stability.panels(stability.PROBES)
    assert "red: " not in stability.text_of(panels)
    # What the references are worth: every algorithm keeps its digits somewhere.
    assert all(panel.count("green") for panel in panels)
