"""Words to values: round trips for every option, and no other end than a refusal."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import values_for

from refcloud.cli import animate, approximate, compare, generate, render
from refcloud.cli.options import Option, base_of
from refcloud.cli.parser import Command
from refcloud.cli.setting import CAMERA, MEDIUM, SUN
from refcloud.cli.values import number, value_of

OPTIONS = [
    *generate.OPTIONS,
    *approximate.OPTIONS,
    *render.OPTIONS,
    *render.BACKGROUND,
    *render.SAVING,
    *CAMERA,
    *SUN,
    *MEDIUM,
    *compare.OPTIONS,
    *compare.SHOWING,
]
EACH = 25  # of each option; about 45 options share what is tested
TYPED = [option for option in OPTIONS if not option.is_switch]


def as_words(value: object) -> str:
    if isinstance(value, np.ndarray):
        return " ".join(repr(float(part)) for part in value)
    return value if isinstance(value, str) else repr(value)


def command_with(option: Option) -> Command:
    made = Command("demo", "A demonstration.")
    made.argument("WHAT", "a thing")
    made.group("all", "", [option])
    return made


@pytest.mark.parametrize("option", TYPED, ids=lambda option: option.flag)
@settings(max_examples=EACH)
@given(data=st.data())
def test_every_value_comes_back(option: Option, data) -> None:
    kind = data.draw(st.sampled_from(option.kinds))
    value = data.draw(values_for(kind))
    text = as_words(value)
    np.testing.assert_array_equal(value_of(option, text), value)
    # It comes back from a whole line too, minus signs and all, wherever it stands.
    words = [option.flag, *text.split()]
    place = data.draw(st.sampled_from([["it", *words], [*words, "it"]]))
    if base_of(kind) is not str:
        given = command_with(option).parse(place)
        assert given.arguments == ("it",)
        found = given.options[option.flag]
        np.testing.assert_array_equal(found[0] if option.repeated else found, value)


@pytest.mark.parametrize("option", TYPED, ids=lambda option: option.flag)
@settings(max_examples=EACH)
@given(text=st.text(st.sampled_from("0123456789.e-+/naif \t\n%é_"), max_size=12))
def test_other_words_are_refused_by_the_option_s_name(option: Option, text) -> None:
    said = ""
    try:
        value_of(option, text)
    except (ValueError, TypeError) as refusal:
        said = str(refusal)
    assert not said or said.startswith(f"{option.flag}: expected ")
    assert "\n" not in said


@pytest.mark.parametrize(
    ("word", "value"),
    [("1/255", 1 / 255), ("-1e-3", -1e-3), (".5", 0.5), ("1/0", None)],
)
def test_numbers(word: str, value: float | None) -> None:
    assert number(word) == value


def test_options_end_at_two_dashes() -> None:
    option = next(option for option in TYPED if option.flag == "--seed")
    given = command_with(option).parse(["--seed", "-5", "--", "--seed"])
    assert given.arguments == ("--seed",)
    assert given.options == {"--seed": -5}


def test_values_may_stand_behind_an_equals_sign() -> None:
    option = next(option for option in TYPED if option.flag == "--sun")
    given = command_with(option).parse(["--sun=-0.6 0.6 0.4", "--sun=1 -1e-2 0", "it"])
    np.testing.assert_array_equal(
        given.options["--sun"], [[-0.6, 0.6, 0.4], [1.0, -0.01, 0.0]]
    )


@pytest.mark.parametrize(
    ("words", "value"), [(["--dither"], True), (["--no-dither"], False)]
)
def test_switches(words: list[str], value: bool) -> None:
    option = next(option for option in OPTIONS if option.is_switch)
    given = command_with(option).parse([*words, "it"])
    assert given.options == {"--dither": value}


@pytest.mark.parametrize("command", [render.command, animate.command, generate.command])
def test_options_come_once_unless_they_may_be_repeated(command) -> None:
    """Whatever is typed between, and whichever way each of the two is written."""
    made = command()
    arguments = ["WHAT"] if made._arguments else []
    for option in made._options.values():
        if option.is_switch:
            once, twice = [option.flag], [[option.flag], ["--no-" + option.flag[2:]]]
        else:
            value = typed_value(option)
            once = [option.flag, *value]
            twice = [once, [f"{option.flag}={' '.join(value)}"]]
        for again in twice:
            words = [*once, *arguments, *again]
            if option.repeated:
                assert len(made.parse(words).options[option.flag]) == 2
                continue
            with pytest.raises(ValueError, match=f"^{option.flag}: expected it once"):
                made.parse(words)


def typed_value(option: Option) -> list[str]:
    """Give words that an option takes."""
    if option.choices:
        return [option.choices[0]]
    return ["0.5"] * option.least_words
