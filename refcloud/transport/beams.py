"""A grid prepared for many sweeps: the same as `sweep`, arranged for few cheap steps.

What is different (`refcloud.transport.swept` takes the steps):

1. Directions that cross the same slices in the same order step together, as a group.
2. A phase function of few Legendre terms needs few numbers per voxel. The source along
   every direction is ``to_source @ terms``, and what light adds to the terms is
   ``to_terms @ radiance``.
3. These numbers are kept for the voxels at and next to the cloud alone.
4. The rows of a slice lie in one line, a dark cell behind each. A shift by whole voxels
   is then a look at the same line from another place: nothing is copied.
5. A shift by parts of a voxel is a product with `shift_matrix`, for a group at once.
6. Transmittances are tabulated once for each length of path through a slice.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.transport.directions import Directions
from refcloud.transport.sweep import Step, mean_transmittance, shift_matrix, step_of

Reals = NDArray[np.floating[Any]]


@dataclass(frozen=True)
class Group:
    """Directions that cross the same slices in the same order, n of them.

    Attributes
    ----------
    axis, sense
        Of the array ``[z, y, x]``.
    members
        Which directions, those of equal length of path side by side.
    runs
        (first, last, fade, mean) for each length: tables of shape (K, h (w + 1)).
    offsets
        How far along a slice's line each beam moves, or None for parts of a voxel.
    matrices
        The shift matrices then, shapes (n, 1, h, h) and (n, 1, w + 1, w + 1).
    """

    axis: int
    sense: int
    members: list[int]
    runs: list[tuple[int, int, Reals, Reals]]
    offsets: list[int] | None
    matrices: tuple[Reals, Reals] | None


@dataclass(frozen=True)
class Beams:
    """A grid that is prepared for sweeps.

    Attributes
    ----------
    shape
        Of the grid, (D, H, W).
    near
        Places of the M voxels at and next to the cloud, as `numpy.nonzero` has them.
    places
        For each axis, where they are in slices of lines, flat, shape (M,).
    groups
        All directions.
    sources
        For each axis, lines that hold a group's source, shape (n B, K h (w + 1));
        what lies away from the cloud stays 0.
    radiance
        Room for a group's radiance.
    gathered
        Room for what all directions give in the near voxels, shape (N, B M).
    """

    shape: tuple[int, ...]
    near: tuple[NDArray[np.intp], ...]
    places: tuple[NDArray[np.intp], ...]
    groups: list[Group]
    sources: tuple[Reals, ...]
    radiance: Reals
    gathered: Reals


def next_to(occupied: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Mark voxels that touch an occupied one, by a face, an edge or a corner."""
    near = occupied.copy()
    for axis in range(3):
        here = np.moveaxis(near, axis, 0)
        wider = here.copy()
        wider[1:] |= here[:-1]
        wider[:-1] |= here[1:]
        near = np.moveaxis(wider, 0, axis)
    return near


def prepare(
    extinction: Array,
    directions: Directions,
    *,
    cell: Array,
    batch: int = 1,
    dtype: Any = np.float64,
) -> Beams:
    """Prepare a grid for any number of sweeps of a batch of sources."""
    steps = [step_of(vector, cell) for vector in directions.vectors]
    together: dict[tuple[int, int, bool], list[int]] = {}
    for n, step in enumerate(steps):
        whole = all(isinstance(side, int) for side in step.side)
        together.setdefault((step.axis, step.sense, whole), []).append(n)
    near = np.nonzero(next_to(extinction > 0.0))
    places = []
    for axis in range(3):
        h, w = (size for a, size in enumerate(extinction.shape) if a != axis)
        j, i = (near[a] for a in range(3) if a != axis)
        places.append((near[axis] * h + j) * (w + 1) + i)
    tables = _Tables(extinction[near], tuple(places), extinction.shape, dtype)
    groups = [_group(key, members, steps, tables) for key, members in together.items()]
    most = [
        max((len(g.members) for g in groups if g.axis == axis), default=0) * batch
        for axis in range(3)
    ]
    sources = tuple(
        np.zeros((n, tables.length(axis)), dtype) for axis, n in enumerate(most)
    )
    radiance = np.zeros(max(source.size for source in sources), dtype)
    gathered = np.empty((len(steps), batch * len(near[0])), dtype)
    return Beams(
        extinction.shape, near, tuple(places), groups, sources, radiance, gathered
    )


class _Tables:
    """Transmittances through each voxel of a slice, by axis and length of path."""

    def __init__(
        self,
        extinction: Array,
        places: tuple[NDArray[np.intp], ...],
        shape: tuple[int, ...],
        dtype: Any,
    ) -> None:
        self.extinction, self.places, self.shape = extinction, places, shape
        self.dtype = dtype
        self.values: dict[float, tuple[Array, Array]] = {}
        self.tables: dict[tuple[int, float], tuple[Reals, Reals]] = {}

    def rows(self, axis: int) -> tuple[int, int]:
        """Give how many rows a slice has, and how long they are."""
        h, w = (size for a, size in enumerate(self.shape) if a != axis)
        return h, w

    def length(self, axis: int) -> int:
        """Give how many numbers all slices have, the dark cells with them."""
        h, w = self.rows(axis)
        return self.shape[axis] * h * (w + 1)

    def of(self, axis: int, path: float) -> tuple[Reals, Reals]:
        """Give what passes each voxel, and what does so on average inside it."""
        if path not in self.values:
            tau = self.extinction * path
            self.values[path] = np.exp(-tau), mean_transmittance(tau)
        if (axis, path) not in self.tables:
            tables = []
            for values, behind in zip(self.values[path], (0.0, 1.0), strict=True):
                h, w = self.rows(axis)
                table = np.ones((self.shape[axis], h, w + 1), self.dtype)
                # Behind each row beams end: what moves there is outside, and dark.
                table[..., -1] = behind
                table = table.reshape(-1)
                table[self.places[axis]] = values
                tables.append(table.reshape(self.shape[axis], -1))
            self.tables[axis, path] = tables[0], tables[1]
        return self.tables[axis, path]


def _group(
    key: tuple[int, int, bool], members: list[int], steps: list[Step], tables: _Tables
) -> Group:
    axis, sense, whole = key
    length = {n: round(steps[n].length, 12) for n in members}
    members = sorted(members, key=lambda n: length[n])
    paths = [length[n] for n in members]
    runs = []
    for path in sorted(set(paths)):
        first = paths.index(path)
        runs.append((first, first + paths.count(path), *tables.of(axis, path)))
    h, w = tables.rows(axis)
    sides = [steps[n].side for n in members]
    if whole:
        offsets = [int(a) * (w + 1) + int(b) for a, b in sides]
        return Group(axis, sense, members, runs, offsets, None)
    down = np.zeros((len(members), 1, h, h), tables.dtype)
    across = np.zeros((len(members), 1, w + 1, w + 1), tables.dtype)
    for n, (a, b) in enumerate(sides):
        down[n, 0] = shift_matrix(h, a)
        across[n, 0, :-1, :-1] = shift_matrix(w, b).T
    return Group(axis, sense, members, runs, None, (down, across))
