"""The noise benchmark: run time against error, beside peers where installed."""

from __future__ import annotations

from refcloud.bench.contenders import LISTS, PEERS
from refcloud.bench.subject import NS, Subject

NOISE = Subject(
    name="noise",
    title="kinds of noise, on grids and at points",
    about="CPU time per sample, medians; error: largest distance from float64",
    lists=tuple(LISTS),
    peers=PEERS,
    unit=NS,
    rate=("Ms/s", 1e3),
    reference="the same in float64, 1e-12 from its plain twin; peers have their own",
)
