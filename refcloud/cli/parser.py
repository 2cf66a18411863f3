"""A command's options and arguments: their help, and reading them from words."""

from __future__ import annotations

import argparse
import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NoReturn

from refcloud.cli.options import FileOption, Option
from refcloud.cli.outputs import say
from refcloud.cli.values import number, value_of
from refcloud.refusal import complaint

OUTPUT = "--output"
HELP_COLUMN = 30  # where the texts of help start
HELP = ("-h", "--help")


@dataclass(frozen=True)
class Given:
    """What was typed: arguments by place, options by flag (only those given)."""

    arguments: tuple[str, ...]
    options: dict[str, Any]

    def of(self, options: Iterable[Option]) -> dict[str, Any]:
        """Pick the values of some options, by the library's names."""
        return {
            option.name: self.options[option.flag]
            for option in options
            if option.flag in self.options
        }

    @property
    def output(self) -> str | None:
        """Give the output's name, or None."""
        return self.options.get(OUTPUT)

    def named(self, default: str) -> str:
        """Give the output's name, or the default one."""
        return default if self.output is None else self.output


class _Arguments(argparse.ArgumentParser):
    """Refuses in one line, by an exception."""

    def error(self, message: str) -> NoReturn:
        raise ValueError(f"{message}; see {self.prog} --help")


class Command:
    """One command: its arguments, its options in groups, and how both are read."""

    def __init__(
        self,
        name: str,
        about: str,
        output: str = "",
        program: str = "refcloud",
        kind: str = "FILE",
    ) -> None:
        self.name = f"{program} {name}"
        self._kind = kind  # what the output's name is one of, as help shows it
        self._options: dict[str, Option] = {}
        self._arguments: list[str] = []
        self._optional = 0
        self._parser = _Arguments(
            prog=self.name,
            description=about.replace("%", "%%"),
            allow_abbrev=False,
            formatter_class=lambda prog: argparse.HelpFormatter(
                prog, max_help_position=HELP_COLUMN
            ),
        )
        self._flags: set[str] = set(HELP)
        if output:
            self._flags |= {"-o", OUTPUT}
            self._parser.add_argument("-o", OUTPUT, metavar=kind, help=output)

    @property
    def flags(self) -> dict[str, str]:
        """Give the options by the names of the library's parameters."""
        given = {option.name: option.flag for option in self._options.values()}
        return {"path": OUTPUT, **given} if OUTPUT in self._flags else given

    def argument(self, name: str, text: str, *, optional: bool = False) -> None:
        """Add an argument; one that may be left out stands after all others."""
        self._arguments.append(name)
        self._optional += optional
        self._parser.add_argument(name, nargs="?", help=text)

    def group(self, title: str, about: str, options: Iterable[Option]) -> None:
        """Add options under a title."""
        group = self._parser.add_argument_group(title, about.replace("%", "%%") or None)
        for option in options:
            self._options[option.flag] = option
            self._flags.add(option.flag)
            text = option.help.replace("%", "%%")
            if option.is_switch:
                self._flags.add("--no-" + option.flag[2:])
                group.add_argument(
                    option.flag, action=argparse.BooleanOptionalAction, help=text
                )
                continue
            group.add_argument(
                option.flag,
                action="append" if option.repeated else "store",
                metavar=option.metavar,
                help=text,
            )

    def parse(self, words: Sequence[str]) -> Given:
        """Read the words of a call, or refuse them in one line.

        Raises
        ------
        ValueError, TypeError
            An option is unknown or its value does not fit; an argument is missing or
            too many.
        SystemExit
            Help was asked for, and is printed.
        """
        arguments, flags = self._sorted(list(words))
        if not set(HELP).isdisjoint(flags):
            must = len(self._arguments) - self._optional
            names = self._arguments[:must]
            names += [f"[{name}]" for name in self._arguments[must:]]
            self._parser.usage = " ".join([self.name, *names, "[options]"])
            say(self._parser.format_help().rstrip("\n"))
            raise SystemExit(0)
        spaced, _ = self._parser.parse_known_args(flags)
        typed = vars(spaced)
        values: dict[str, Any] = {}
        for option in self._options.values():
            text = typed[option.flag[2:].replace("-", "_")]
            if text is None:
                continue
            if option.repeated:
                values[option.flag] = [value_of(option, each) for each in text]
            else:
                values[option.flag] = (
                    text if option.is_switch else value_of(option, text)
                )
        if typed.get("output") is not None:
            values[OUTPUT] = typed["output"]
        self._check_arguments(arguments)
        for flag, value in values.items():
            if flag == OUTPUT or isinstance(self._options[flag], FileOption):
                _refuse_empty(flag, value)
        return Given(tuple(arguments), values)

    def _check_arguments(self, arguments: list[str]) -> None:
        names = self._arguments
        if len(arguments) < len(names) - self._optional:
            missing = names[len(arguments)]
            advice = f"see {self.name} --help"
            raise ValueError(complaint(missing, "a name", "none", advice))
        for name, word in zip(names, arguments, strict=False):
            _refuse_empty(name, word)
        if len(arguments) > len(names):
            wanted = f"{len(names)}: " + " ".join(names) if names else "none"
            extra = f"also {arguments[len(names)][:60]!r}"
            raise ValueError(complaint("arguments", wanted, extra))

    def _sorted(self, words: list[str]) -> tuple[list[str], list[str]]:
        """Part arguments from options, and join each option with its values."""
        arguments: list[str] = []
        flags: list[str] = []
        seen: set[str] = set()
        while words:
            word = words.pop(0)
            if word == "--":
                arguments += words
                break
            if not _is_flag(word):
                arguments.append(word)
                continue
            flag, equals, _ = word.partition("=")
            if flag not in self._flags and not self._is_short_output(word):
                self._refuse(flag)
            option = self._options.get(flag)
            self._once(flag, seen)
            takes = flag in ("-o", OUTPUT) or (option and not option.is_switch)
            if equals or not takes:
                flags.append(word)
                continue
            values = self._values(option, words)
            if not values:
                kind = option.metavar if option else self._kind
                raise ValueError(complaint(flag, kind, "no value"))
            flags.append(f"{OUTPUT if flag == '-o' else flag}={' '.join(values)}")
        return arguments, flags

    def _once(self, flag: str, seen: set[str]) -> None:
        """Refuse an option that comes a second time, unless it may be repeated."""
        name = flag
        if flag not in self._flags or flag == "-o":
            name = OUTPUT  # also as -oFILE
        elif flag.startswith("--no-") and "--" + flag[5:] in self._options:
            name = "--" + flag[5:]
        option = self._options.get(name)
        if name in seen and not (option and option.repeated) and flag not in HELP:
            raise ValueError(complaint(name, "it once", "it twice", "leave one out"))
        seen.add(name)

    @staticmethod
    def _values(option: Option | None, words: list[str]) -> list[str]:
        """Take an option's values from the front of the words that follow it."""
        least = option.least_words if option else 1
        many = option is not None and option.most_words > 1
        values: list[str] = []
        while words and (
            (len(values) < least and not _is_flag(words[0]))
            or (many and number(words[0]) is not None)
        ):
            values.append(words.pop(0))
        return values

    def _is_short_output(self, word: str) -> bool:
        return "-o" in self._flags and word.startswith("-o")

    def _refuse(self, flag: str) -> NoReturn:
        near = difflib.get_close_matches(flag, sorted(self._flags), 1)
        advice = f"did you mean {near[0]}?" if near else f"see {self.name} --help"
        expected = f"an option of {self.name}"
        raise ValueError(complaint(flag[:60], expected, "an unknown one", advice))


def _refuse_empty(name: str, word: str) -> None:
    """Refuse an empty text, which as a path would mean the current folder."""
    if not word:
        raise ValueError(complaint(name, "a name", "an empty text"))


def _is_flag(word: str) -> bool:
    return word.startswith("-") and word != "-" and number(word) is None
