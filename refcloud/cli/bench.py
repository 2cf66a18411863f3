"""``refcloud bench``: run time beside error, as a table or for machines."""

from __future__ import annotations

import dataclasses
import json as json_format
from collections.abc import Sequence

from refcloud import bench
from refcloud.cli.options import options_of
from refcloud.cli.outputs import say
from refcloud.cli.parser import Command
from refcloud.refusal import complaint

ABOUT = "Measure run time against error, beside other libraries where installed."
SUBJECTS = ("noise",)


def measure(*, quick: bool = False, json: bool = False) -> str:
    """Measure every contender, interleaved, in CPU time.

    Parameters
    ----------
    quick
        Small arrays and few rounds, for a look at the table.
    json
        Rows for machines instead of a table.
    """
    rows = bench.run(quick)
    if json:
        return json_format.dumps([dataclasses.asdict(row) for row in rows], indent=1)
    return bench.table(rows)


OPTIONS = options_of(measure)


def command() -> Command:
    """Give the command's argument and options."""
    made = Command("bench", ABOUT)
    made.argument("WHAT", "what is measured: " + ", ".join(SUBJECTS))
    made.group("the measurement", "", OPTIONS)
    return made


def run(words: Sequence[str]) -> int:
    """Measure, and print the rows."""
    given = command().parse(words)
    (subject,) = given.arguments
    if subject not in SUBJECTS:
        expected = "one of " + ", ".join(SUBJECTS)
        raise ValueError(complaint("WHAT", expected, repr(subject)))
    say(measure(**given.of(OPTIONS)))
    return 0
