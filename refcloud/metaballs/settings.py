"""What every method of the fit is told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from refcloud.metaballs.kernels import Kernel
from refcloud.metaballs.kmeans import Clusters
from refcloud.metaballs.pairs import Work
from refcloud.metaballs.refine import Fit

Watch = Callable[[str, Work, Fit | Clusters], object]


@dataclass(frozen=True)
class Settings:
    """How balls are found; each field is `approximate`'s parameter of the same name.

    Attributes
    ----------
    kernel, seed, overlap, rim, rim_depth, rounds, refine_steps, least_radius
        As in `approximate`; None where the method chooses.
    watch
        Called with a name, the grid, and a fit on it or clusters.
    """

    kernel: Kernel
    seed: int
    watch: Watch
    overlap: float | None = None
    rim: float | None = None
    rim_depth: float = 1.5
    rounds: int = 10
    refine_steps: int | None = None
    least_radius: float = 1.1
