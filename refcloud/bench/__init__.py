"""Benchmarks: run time beside error, and beside peers where they are installed."""

from refcloud.bench.plot import plot
from refcloud.bench.subject import MS, NS, Subject, Unit, run, table
from refcloud.bench.subjects import SUBJECTS
from refcloud.bench.timing import Contender, Row, Timing
from refcloud.bench.worley import worley_contenders

__all__ = [
    "MS",
    "NS",
    "SUBJECTS",
    "Contender",
    "Row",
    "Subject",
    "Timing",
    "Unit",
    "plot",
    "run",
    "table",
    "worley_contenders",
]
