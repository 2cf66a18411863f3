"""How a cloud's light is solved: which directions, on which grid, how many sweeps.

A plan is a list of stages, coarse to fine. Each starts from the light that the one
before found: first few directions on coarse grids until little changes, then more
directions for a last look. A step to finer grids or directions keeps all that was
learned about light that wandered far; a sweep or two then put right what is near.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from refcloud.checking import check_fields
from refcloud.conventions import Range
from refcloud.optics import Medium, Sun, phase
from refcloud.transport.directions import DirectionCount

GradeName = Literal["quick", "standard", "reference", "fine", "finer", "finest"]


@dataclass(frozen=True)
class Stage:
    """One stage of a plan.

    Attributes
    ----------
    directions
        26, 50 or 128.
    halvings
        How often the plan's finest grid is halved for this stage.
    most
        Sweeps, at most; 1 is a look at the light that is there.
    residual
        Relative residual at which it ends.
    """

    directions: DirectionCount
    halvings: Annotated[int, Range(0, 8)]
    most: Annotated[int, Range(1, 10_000)]
    residual: Annotated[float, Range(0.0, 1.0)] = 1e-3

    def __post_init__(self) -> None:
        check_fields(self)


@dataclass(frozen=True)
class Plan:
    """Stages, and the grid that they count from.

    Attributes
    ----------
    stages
        Coarse to fine.
    depth
        The grid is halved as long as its voxels stay thinner than this optical depth,
        and 48 of them are left along the longest axis; 0 keeps the cloud's own grid.
    double
        Whether float64 is used instead of float32.
    """

    stages: tuple[Stage, ...]
    depth: Annotated[float, Range(0.0)] = 0.0
    double: bool = False

    def __post_init__(self) -> None:
        check_fields(self)
        if not self.stages:
            raise ValueError("stages: expected at least one, got none")


START = (Stage(26, 2, 60), Stage(26, 1, 60))
PLANS: dict[str, Plan] = {
    "quick": Plan((*START, Stage(50, 0, 1)), depth=0.3),
    "standard": Plan((*START, Stage(26, 0, 2), Stage(50, 0, 1)), depth=0.3),
    "reference": Plan((*START, Stage(50, 0, 60), Stage(128, 0, 1))),
    "fine": Plan((*START, Stage(50, 0, 60, 2e-4), Stage(128, 0, 60, 2e-4))),
    "finer": Plan(
        (*START, Stage(26, 0, 100, 2e-6), Stage(128, 0, 100, 2e-6)), double=True
    ),
    "finest": Plan(
        (
            Stage(26, 2, 500, 1e-7),
            Stage(26, 1, 500, 1e-7),
            Stage(26, 0, 500, 1e-7),
            Stage(128, 0, 500, 1e-7),
        ),
        double=True,
    ),
}

# Largest error of a plan's picture against "finest", as a share of what the suns could
# send at most: at least the first number, and the second times the optical depth of the
# thickest voxel, in which light has farther to wander. Times 1.5 they are the worst
# seen: the first on 27 clouds, suns and lobes of 32 voxels' edge at a depth of 0.25 in
# a voxel; the second on 79 generated ones of 6 to 20 voxels' edge at depths of 0.03 to
# 300, and on three of 8 to 24 at 1.7 to 5. Beyond `BLUNTEST` the lobe is too narrow for
# 50 directions: a sun behind the cloud would show it.
ERRORS = {
    "quick": (0.05, 0.15),
    "standard": (0.022, 0.1),
    "reference": (0.0032, 0.012),
    "fine": (1.4e-4, 2.7e-3),
    "finer": (4.5e-6, 1.3e-5),
}
BLUNTEST = 0.6
FEW = ("quick", "standard")


def error_of(name: str, depth: float) -> float:
    """Give what a plan counts with, of what the suns could send, by a voxel's depth."""
    least, by_depth = ERRORS[name]
    return max(least, by_depth * depth)


def plan_for(
    tolerance: float, suns: tuple[Sun, ...], medium: Medium, depth: float = 0.0
) -> Plan:
    """Choose the cheapest plan whose measured error a tolerance allows.

    The depth is that of the thickest voxel, optical.

    The error counts against "finest". That is itself off by the voxels: at an optical
    depth of 0.25 in each a picture is 0.005 from an unbiased estimate (relative RMSE),
    at 1.25 it is 0.02, at 5 0.1, and at 20 0.24 (0.30 with albedo 0.95, a fifth too
    dark in all). What an even wall loses up to 1e4 stands in `scattered_light`.
    """
    g = medium.g if medium.phase == "hg" else 0.0
    peak = float(phase(medium, np.array(1.0 if g >= 0.0 else -1.0)))
    most = peak * sum(float(sun.irradiance.max()) for sun in suns)
    for name in ERRORS:
        if error_of(name, depth) * max(most, 1.0) <= tolerance:
            if name not in FEW or abs(g) <= BLUNTEST:
                return PLANS[name]
    return PLANS["finest"]
