"""``refcloud bench``: run time beside error, as a table or for machines."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from dataclasses import dataclass

from refcloud import bench
from refcloud.cli.options import FileOption, options_of
from refcloud.cli.outputs import ready, say
from refcloud.cli.parser import Command
from refcloud.refusal import complaint

ABOUT = "Measure run time against error, beside other libraries where installed."


@dataclass(frozen=True)
class Measurement:
    """How to measure, and how to print it.

    Attributes
    ----------
    quick
        Small arrays and few rounds, for a look at the table.
    json
        Rows for machines instead of a table.
    """

    quick: bool = False
    json: bool = False


OPTIONS = options_of(Measurement)
PLOT = FileOption(
    "plot",
    "--plot",
    (str,),
    None,
    "Name of a figure (.png) of error against run time; none without it. Needs"
    " matplotlib.",
)
FIGURES = (".png",)


def command() -> Command:
    """Give the command's argument and options."""
    made = Command("bench", ABOUT)
    made.argument("WHAT", "what is measured: " + ", ".join(bench.SUBJECTS))
    made.group("the measurement", "", (*OPTIONS, PLOT))
    return made


def run(words: Sequence[str]) -> int:
    """Measure, and print the rows."""
    given = command().parse(words)
    (name,) = given.arguments
    if name not in bench.SUBJECTS:
        expected = "one of " + ", ".join(bench.SUBJECTS)
        raise ValueError(complaint("WHAT", expected, repr(name)))
    subject, how = bench.SUBJECTS[name], Measurement(**given.of(OPTIONS))
    figure = given.options.get(PLOT.flag)
    if figure is not None:
        figure = ready(figure, FIGURES, PLOT.flag)
    rows = bench.run(subject, how.quick)
    if how.json:
        say(json.dumps([dataclasses.asdict(row) for row in rows], indent=1))
    else:
        say(bench.table(subject, rows))
    if figure is not None:
        say(str(bench.plot(subject, rows, figure)))
    return 0
