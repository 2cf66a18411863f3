"""``refcloud bench``: run time beside error, as a table or for machines."""

from __future__ import annotations

import dataclasses
import json
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from refcloud import bench
from refcloud.bench import certificates, skipping, stability
from refcloud.bench.plot import matplotlib_figures
from refcloud.cli.options import FileOption, options_of
from refcloud.cli.outputs import printable, ready, say
from refcloud.cli.parser import Command, Given
from refcloud.refusal import complaint

ABOUT = "Measure run time against error; without a name list what can be measured."


@dataclass(frozen=True)
class Measurement:
    """How to measure, and how to print it.

    Attributes
    ----------
    quick
        Small arrays and few rounds, for a look at the table.
    json
        Rows for machines instead of a table.
    peers
        Other libraries and OpenGL as well, those that are installed.
    only
        Of certificates: one kind of scenes, all of them without it.
    """

    quick: bool = False
    json: bool = False
    peers: bool = False
    only: certificates.Word | None = None


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
STABILITY = "stability"  # a map of errors, without times
SKIPPING = "skipping"  # what each named scene leaves out
CERTIFICATES = "certificates"  # counts of errors, without times
NAMES = (*bench.SUBJECTS, STABILITY, SKIPPING, CERTIFICATES)


def command() -> Command:
    """Give the command's argument and options."""
    made = Command("bench", ABOUT)
    made.argument("WHAT", "what is measured: " + ", ".join(NAMES), optional=True)
    made.group("the measurement", "", (*OPTIONS, PLOT))
    return made


def run(words: Sequence[str]) -> int:
    """Measure, and print the rows."""
    given = command().parse(words)
    if not given.arguments:
        _refuse_idle(given, "without WHAT", given.options)
        for name, what in subjects().items():
            say(f"{name:12}  {what}")
        return 0
    (name,) = given.arguments
    if name not in NAMES:
        expected = "one of " + ", ".join(NAMES)
        raise ValueError(complaint("WHAT", expected, repr(name)))
    how, figure = Measurement(**given.of(OPTIONS)), given.options.get(PLOT.flag)
    if how.only is not None and name != CERTIFICATES:
        advice = f"only {CERTIFICATES} has kinds"
        raise ValueError(complaint("--only", f"none beside {name}", how.only, advice))
    if name not in bench.SUBJECTS:
        _refuse_idle(given, f"beside {name}, which has no peers", ["--peers"])
    if figure is not None:
        figure = ready(figure, FIGURES, PLOT.flag)
    if name == STABILITY:
        return _stability(how, figure)
    if name == SKIPPING:
        return _skipping(how, figure)
    if name == CERTIFICATES:
        return _certificates(how, figure)
    if figure is not None:
        matplotlib_figures()  # refused before the work where there is none
    subject = bench.SUBJECTS[name]
    rows = bench.run(subject, how.quick, how.peers)
    if how.json:
        say(json.dumps([dataclasses.asdict(row) for row in rows], indent=1))
    else:
        say(bench.table(subject, rows))
    if figure is not None:
        _name(bench.plot(subject, rows, figure), how)
    return 0


def _refuse_idle(given: Given, where: str, flags: Iterable[str]) -> None:
    """Refuse options that would change nothing."""
    for flag in flags:
        if given.options.get(flag, False) is not False:
            raise ValueError(complaint(flag, f"none {where}", "one"))


def _name(figure: Path, how: Measurement) -> None:
    """Print a figure's name; beside rows for machines it is no result."""
    if how.json:
        print(printable(str(figure), sys.stderr), file=sys.stderr)
    else:
        say(str(figure))


def subjects() -> dict[str, str]:
    """Say in a line what each name measures."""
    found = {name: subject.title for name, subject in bench.SUBJECTS.items()}
    found[STABILITY] = "where each algorithm keeps its digits: errors alone"
    found[SKIPPING] = "what each named scene leaves out: counts, shares and bounds"
    found[CERTIFICATES] = "how often a certificate fails, on generated scenes"
    return found


def _certificates(how: Measurement, figure: Path | None) -> int:
    """Draw generated scenes, and count those that are off by more than was asked."""
    if figure is not None:
        advice = "leave it out: counts have no figure"
        raise ValueError(
            complaint(PLOT.flag, "none beside certificates", "one", advice)
        )
    found = certificates.tallies(how.quick, how.only)
    if how.json:
        rows = [{"kind": k, **dataclasses.asdict(t)} for k, t in found.items()]
        say(json.dumps(rows, indent=1))
    else:
        say(certificates.table_of(found))
    return 0


def _stability(how: Measurement, figure: Path | None) -> int:
    """Judge every cell of the map of stability; `quick` leaves out the slow probes."""
    probes = [p for p in stability.PROBES if not (how.quick and p.slow)]
    panels = stability.panels(probes)
    if how.json:
        say(json.dumps(stability.rows_of(panels), indent=1))
    else:
        say(stability.text_of(panels))
    if figure is not None:
        _name(stability.labelled_map(panels).save(figure, tone="none"), how)
    return 0


def _skipping(how: Measurement, figure: Path | None) -> int:
    """Draw the named scenes, small ones where `quick`, and list what they skipped."""
    if figure is not None:
        raise ValueError(complaint(PLOT.flag, "none beside skipping, a table", "one"))
    size, found = skipping.named_savings(how.quick)
    if how.json:
        say(json.dumps(skipping.rows_of(found), indent=1))
    else:
        say(skipping.text_of(size, found))
    return 0
