"""Worley noise beside scipy's k-d tree: what to time for the table of noise.

Each contender is a call without arguments and the number of samples that it makes. All
of one task answer the same question, the exact distance in a pattern that repeats, so
their results can be compared as well.
"""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Range
from refcloud.noise import uniform, worley, worley_grid, worley_points

Task = Literal["grid", "scattered"]


@dataclass(frozen=True)
class Contender:
    """One way to do a task.

    Attributes
    ----------
    name
        What the table calls it.
    samples
        How many values a run gives.
    run
        Does the task, and gives its values.
    peer
        Whether it is another library.
    """

    name: str
    samples: int
    run: Callable[[], Any]
    peer: bool = False


@checked
def worley_contenders(
    task: Task,
    *,
    cells: Annotated[int, Range(2, 64)] = 8,
    side: Annotated[int, Range(2, 512)] = 128,
    count: Annotated[int, Range(1, 1 << 24)] = 2_000_000,
    feature: Literal["F1", "F2"] = "F1",
) -> tuple[Contender, ...]:
    """List the ways to make Worley noise that can be timed here.

    Formula: million samples per second = samples / seconds / 10^6

    Parameters
    ----------
    task
        "grid": side^3 samples of a cube. "scattered": count points in it.
    cells
        Cells along each axis of the cube, after which the pattern repeats.
    side
        Samples along each axis of the grid.
    count
        How many scattered points.
    feature
        Nearest point, "F1", or second nearest, "F2".

    Returns
    -------
    The contenders; scipy's tree is among them where it is installed.

    Source: issue 3; document D (N26-N29).

    Examples
    --------
    >>> len(worley_contenders("grid", cells=2, side=2)) >= 3
    True
    """
    how: dict[str, Any] = {"seed": 0, "period": cells, "feature": feature}
    make: Callable[..., Any]
    places: tuple[Any, ...]
    if task == "grid":
        line = (np.arange(side) + 0.5) * (cells / side)
        samples, make, places = side**3, worley_grid, (line, line, line)
        layers = np.meshgrid(line, line, line, indexing="ij")
        points = np.stack(layers[::-1], axis=-1).reshape(-1, 3)
    else:
        index = np.arange(count)[:, np.newaxis]
        points = uniform(index, np.arange(3), seed=0) * cells
        samples, make, places = count, worley, (points,)

    def ours(**more: Any) -> Callable[[], Any]:
        return lambda: make(*places, **how, **more)

    listed = [
        Contender("exact float32", samples, ours(dtype="float32")),
        Contender("exact float64", samples, ours()),
        Contender(
            "neighbours float32", samples, ours(dtype="float32", search="neighbours")
        ),
    ]
    if importlib.util.find_spec("scipy"):
        tree = importlib.import_module("scipy.spatial").cKDTree
        corners = np.indices((cells,) * 3).reshape(3, -1)
        pattern = corners.T + worley_points(*corners, seed=0, period=cells)
        rank = [1] if feature == "F1" else [2]

        def peer() -> Any:
            return tree(pattern, boxsize=cells).query(points, rank)[0][:, 0]

        listed.append(Contender("scipy cKDTree(boxsize)", samples, peer, peer=True))
    return tuple(listed)
