"""A map of where each algorithm keeps its digits, over its parameters and past them."""

from refcloud.bench.stability.chart import bare_map, labelled_map
from refcloud.bench.stability.probe import Axis, Panel, Probe, panel, panels
from refcloud.bench.stability.probes import PROBES
from refcloud.bench.stability.table import rows_of, text_of
from refcloud.bench.stability.verdict import Cell, Found, judge, relative_error

__all__ = [
    "PROBES",
    "Axis",
    "Cell",
    "Found",
    "Panel",
    "Probe",
    "bare_map",
    "judge",
    "labelled_map",
    "panel",
    "panels",
    "relative_error",
    "rows_of",
    "text_of",
]
