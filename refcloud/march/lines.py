"""Rays as straight lines over slabs: the frame in which the fast march sees a cloud."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from refcloud.conventions import Array
from refcloud.march.box import slabs
from refcloud.march.cells import Lattice
from refcloud.march.planes import Singles

# Cells that a ray may pass aside for one along its frame's axis.
STEEPEST = 1.5


@dataclass(frozen=True)
class Frame:
    """Axes named by one ray's way: w is the axis it runs along, upward.

    Attributes
    ----------
    axis
        Which axis w is: 0 for x, 1 for y, 2 for z.
    flipped
        Whether w counts from the upper face down.
    """

    axis: int
    flipped: bool

    @property
    def across(self) -> tuple[int, int]:
        """Give the axes u and v, in x, y, z order."""
        u, v = (k for k in range(3) if k != self.axis)
        return u, v

    def turned(self, field: NDArray) -> NDArray:
        """View a field ``[z, y, x]`` as ``[w, v, u]``."""
        u, v = self.across
        view = field.transpose(2 - self.axis, 2 - v, 2 - u)
        return view[::-1] if self.flipped else view


@dataclass(frozen=True)
class Lines:
    """Rays of one frame in single precision, as functions of w.

    Attributes
    ----------
    at, slope
        u and v are at + slope w, shape (2, n), cells.
    speed
        Scene units per cell of w, shape (n,).
    low, high
        Between which w the ray has begun and is within the faces aside, shape (n,).
    """

    at: Singles
    slope: Singles
    speed: Singles
    low: Singles
    high: Singles


def frame_numbers(grid: Lattice, directions: Array) -> NDArray[np.intp]:
    """Give each ray a frame: the axis along which it passes most cells, and the sense.

    Those that pass nearly as many along the axis of most rays join them: slabs of
    another frame cost more than a few steeper rays lose. So a ray's frame depends on
    the others: a sample of rays keeps the frames that it has among all.
    """
    slope = [directions[:, k] / grid.size[k] for k in range(3)]
    steep = [np.abs(part) for part in slope]
    largest = np.maximum(np.maximum(steep[0], steep[1]), steep[2])
    axis = np.where(steep[0] == largest, 0, np.where(steep[1] == largest, 1, 2))
    flipped = np.where(axis == 0, slope[0], np.where(axis == 1, slope[1], slope[2])) < 0
    number = 2 * axis + flipped
    most = int(np.bincount(number, minlength=6).argmax())
    sense = -slope[most // 2] if most % 2 else slope[most // 2]
    number[sense * STEEPEST >= largest] = most
    return number


def by_frame(numbers: NDArray[np.intp]) -> list[tuple[Frame, NDArray[np.intp]]]:
    """Sort rays by their frames' numbers."""
    found = []
    for number in range(6):
        which = np.flatnonzero(numbers == number)
        if len(which):
            found.append((Frame(number // 2, bool(number % 2)), which))
    return found


def as_lines(
    grid: Lattice, frame: Frame, origins: Array, directions: Array
) -> tuple[Lines, NDArray[np.intp]]:
    """Set rays up in double precision, and keep those that meet the occupied box.

    Parameters
    ----------
    grid, frame
        The cloud map, and the rays' frame.
    origins, directions
        Shape (N, 3), scene units; unit vectors.

    Returns
    -------
    The lines, and which rays they are, shape (n,).
    """
    # 1. From the place nearest to the box on: a far eye costs no digits.
    middle = grid.lower + 0.5 * grid.size * np.array(grid.counts)
    x, y, z = ((middle[k] - origins[:, k]) * directions[:, k] for k in range(3))
    shift = x + y + z
    place = grid.cells_of(origins + shift[:, None] * directions)
    slope = directions / grid.size
    t0, t1 = slabs(place, slope, grid.first, grid.last, -shift)
    hits = np.flatnonzero(t1 > t0)
    place, slope, shift = place[hits], slope[hits], shift[hits]

    # 2. Slabs end at the box by themselves: only faces aside, and an origin within,
    # cut a ray where there is density.
    w, (u, v) = frame.axis, frame.across
    ended = (t0[hits] == -shift) | grid.reaches_faces
    t0, t1 = np.full(len(hits), -np.inf), np.full(len(hits), np.inf)
    if ended.any():
        endless = np.where(np.arange(3) == w, np.inf, 0.0)
        first, last = grid.first - endless, grid.last + endless
        t0[ended], t1[ended] = slabs(
            place[ended], slope[ended], first, last, -shift[ended]
        )
    rise, height = slope[:, w], place[:, w]
    if frame.flipped:
        rise, height = -rise, grid.counts[w] - 1.0 - height
    aside = slope[:, [u, v]].T / rise
    return Lines(
        (place[:, [u, v]].T - aside * height).astype(np.float32),
        aside.astype(np.float32),
        (1.0 / rise).astype(np.float32),
        (height + rise * t0).astype(np.float32),
        (height + rise * t1).astype(np.float32),
    ), hits
