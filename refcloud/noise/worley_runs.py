"""The axes of a Worley grid: samples sorted by cell, in runs of one length.

Samples may lie in any order and in any cells. In runs of one length they can be laid
side by side, and one long row of numbers holds a sample of each cell.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.noise.lattice import Cells
from refcloud.noise.worley_cells import _split

LONGEST_RUN = 32  # samples of one cell along one axis that are laid in one run
RUN_COST = 2.0  # what a run costs beside its samples, in samples (measured)


@dataclass(frozen=True)
class _Runs:
    """One axis of a grid: samples of the same cell in runs of one length.

    A run that is shorter than the others is filled up with its last sample.
    """

    size: int  # samples of the whole axis
    cells: Cells  # cell of each run, shape (R,)
    index: NDArray[np.intp]  # place of each sample on the axis, shape (samples, R)
    places: Array  # its place in the cell, shape (samples, R)

    @property
    def samples(self) -> int:
        return len(self.index)

    def part(self, chosen: slice) -> _Runs:
        index, places = self.index[:, chosen], self.places[:, chosen]
        return _Runs(self.size, self.cells[chosen], index, places)

    def target(self) -> slice | NDArray[np.intp]:
        """Give where the samples go, run by run; a slice where they lie in order."""
        flat = self.index.T.ravel()
        if np.array_equal(flat, np.arange(flat[0], flat[0] + flat.size)):
            return slice(int(flat[0]), int(flat[0]) + flat.size)
        return flat


def _runs(coordinates: Array, period: int | None) -> _Runs:
    """Sort an axis by cell, and cut it in runs of the length that wastes least."""
    cells, places = _split(coordinates, period)
    order = np.argsort(cells, kind="stable")
    own, first, counts = np.unique(cells[order], return_index=True, return_counts=True)
    lengths = np.arange(1, min(LONGEST_RUN, int(counts.max(initial=1))) + 1)
    needed = -(-counts // lengths[:, np.newaxis])  # runs of each cell, by length
    length = int(lengths[np.argmin(needed.sum(axis=1) * (lengths + RUN_COST))])
    runs = needed[length - 1]
    # Number the runs within their cell, and fill the last of each.
    number = np.arange(runs.sum()) - np.repeat(np.cumsum(runs) - runs, runs)
    within = number * length + np.arange(length)[:, np.newaxis]
    index = order[
        np.repeat(first, runs) + np.minimum(within, np.repeat(counts, runs) - 1)
    ]
    return _Runs(coordinates.size, np.repeat(own, runs), index, places[index])


def _blocks(axes: list[_Runs], most: int) -> list[list[_Runs]]:
    """Cut the runs of all axes in blocks of at most so many cells, near to cubes."""
    lengths: list[int] = []
    for axis in axes[::-1]:  # what z and y leave goes to x, whose rows are written
        left = most // math.prod(lengths)
        share = int(left ** (1.0 / (len(axes) - len(lengths))) + 1e-9)
        lengths.append(max(1, min(len(axis.cells), share)))
    blocks: list[list[_Runs]] = [[]]
    for axis, length in zip(axes, lengths[::-1], strict=True):
        starts = range(0, len(axis.cells), length)
        parts = [axis.part(slice(start, start + length)) for start in starts]
        blocks = [[*block, part] for part in parts for block in blocks]
    return blocks
