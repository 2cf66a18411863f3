"""Benchmarks: run time beside error, and beside peers where they are installed."""

from refcloud.bench.noise import run, table
from refcloud.bench.timing import Row, Timing
from refcloud.bench.worley import worley_contenders

__all__ = ["Row", "Timing", "run", "table", "worley_contenders"]
