"""What an image of a grid's slices shows: its samples, and the parts of each slice."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import AnyCamera
from refcloud.cloudmap import VoxelGrid
from refcloud.conventions import Array
from refcloud.march.resample import Cells, Image, Places, places_of, tents
from refcloud.march.shear import Bounds, Shear, seen, shears

FINER = 1.25  # image samples per cell, where the cloud is nearest
LARGEST = 2048  # image samples along a side, whatever the grid
Span = tuple[list[int], list[int]]
MARGIN = 2  # samples around what shows: Catmull-Rom weighs two to each side


@dataclass(frozen=True)
class View:
    """What of a grid an image shows, and where its samples are.

    Attributes
    ----------
    shear
        The camera and the slices.
    q_v, q_u
        Of the image's rows and columns, shapes (R_v,) and (R_u,).
    spans
        The first and the last cell with cloud along v, and along u, of each slice.
    """

    shear: Shear
    q_v: Array
    q_u: Array
    spans: tuple[Span, Span]

    @property
    def shape(self) -> tuple[int, int]:
        """Samples along v and u."""
        return len(self.q_v), len(self.q_u)

    @property
    def cut(self) -> bool:
        """Whether cloud ends at a side of the box, or the eye is within the box."""
        touched = any(
            min(first) <= 0 or max(last) >= n - 1
            for (first, last), n in zip(self.spans, self.shear.counts[1:], strict=True)
        )
        return touched or self.shear.begins > -0.5

    def ends(self, q_v: Array, q_u: Array) -> tuple[Image, Image]:
        """Give w where rays enter the box and leave it; they broadcast."""
        (v0, v1), (u0, u1) = self.shear.inside(0, q_v), self.shear.inside(1, q_u)
        first = np.maximum(np.maximum(v0, u0), max(self.shear.begins, -0.5))
        last = np.minimum(np.minimum(v1, u1), self.shear.counts[0] - 0.5)
        return first.astype(np.float32), last.astype(np.float32)


@dataclass(frozen=True)
class Part:
    """The part of some slices in which there is cloud, and of the image that sees it.

    Attributes
    ----------
    w
        Where the n slices are, shape (n,).
    cells
        Along v and u.
    at
        Where the image's rays cross each slice, (n, R_v) and (n, R_u), cells.
    image
        Rows and columns of the image.
    """

    w: Array
    cells: tuple[Cells, Cells]
    at: tuple[Array, Array]
    image: tuple[slice, slice]

    def of(self, slabs: NDArray[Any], scale: int = 1) -> NDArray[Any]:
        """Cut the part out of slices with `scale` samples per cell."""
        v, u = (slice(scale * first, scale * end) for first, end in self.cells)
        return slabs[:, v, u]

    def places(self, scale: int) -> tuple[Places, Image]:
        """Give the places along v, and the tents along u, among samples."""
        v, u = (
            places_of(scale * (at + 0.5) - 0.5, (scale * cells[0], scale * cells[1]))
            for at, cells in zip(self.at, self.cells, strict=True)
        )
        return v, tents(u)


def sides_touched(grid: VoxelGrid) -> bool:
    """Tell whether there is cloud at a side of the box."""
    return any(
        grid.density.take(end, axis=axis).any() for axis in range(3) for end in (0, -1)
    )


def view_of(
    grid: VoxelGrid, camera: AnyCamera, side: int | None, finer: float = FINER
) -> View | None:
    """Choose the main axis and the image's samples; None where slices cannot serve."""
    density = grid.density
    # 1. Where there is cloud, seen along x and along y; the box around it.
    across = {2: density.max(axis=2) > 0.0, 1: density.max(axis=1) > 0.0}
    ends = []
    for line in (across[2].any(axis=1), across[2].any(axis=0), across[1].any(axis=0)):
        cells = np.flatnonzero(line)
        ends.append((cells[0] - 1.0, cells[-1] + 1.0) if cells.size else (0.0, -1.0))
    box = np.array(ends).T  # (2, 3): z, y, x
    # 2. The main axis along which rays are least steep.
    ways = []
    for shear in shears(grid, camera):
        turned = shear.turned_box(box)
        bounds = seen(shear, turned)
        if bounds is not None:
            steepest = max(abs(q) for pair in shear.slopes(bounds) for q in pair)
            ways.append((steepest, shear, bounds, turned))
    if not ways:
        return None
    _, shear, bounds, turned = min(ways, key=lambda way: way[0])
    # 3. Samples of the image, and where there is cloud in each slice.
    w, v, u = shear.order
    for axis in {v, u} - across.keys():
        across[axis] = density.max(axis=axis) > 0.0
    planes = []
    for other, along in ((u, v), (v, u)):
        plane = across[other] if w < along else across[other].T
        planes.append(span_of(plane[::-1] if shear.back else plane))
    q_v, q_u = image_grid(shear, bounds, turned, side, finer)
    return View(shear, q_v, q_u, (planes[0], planes[1]))


def image_grid(
    shear: Shear, bounds: Bounds, box: Array, side: int | None, finer: float
) -> tuple[Array, Array]:
    """Spread samples over what shows, as far from each other along v as along u."""
    spans = [max(high - low, 0.0) for low, high in bounds]
    _, gain = shear.across(box[:, 0])
    if side is None:
        near = max(float(gain[0]), 0.5 * float(gain[1]))  # the eye may be in the cloud
        side = min(int(np.ceil(finer * max(spans) * near)) + 1, LARGEST)
    step = max(spans) / max(side - 1, 1) or 1.0
    q = []
    for (low, _), span in zip(bounds, spans, strict=True):
        count = int(np.ceil(span / step)) + 1
        q.append(low + step * np.arange(-MARGIN, count + MARGIN))
    return q[0], q[1]


def part_of(view: View, w: Array, half: float) -> Part | None:
    """Find the cloud in some slices, each `half` to both sides thick; None if empty."""
    shear, K = view.shear, view.shear.counts[0]
    # Slices behind the eye are left out; of one that holds it the part in front counts.
    w = w[(w + half > shear.begins) & (w < K - 0.5)]
    if not w.size:
        return None
    slabs = slice(max(math.floor(w[0]), 0), math.ceil(w[-1]) + 1)
    offset, gain = shear.across(np.maximum(w, 0.5 * (w + half + shear.begins)))
    cells, at, image = [], [], []
    for (firsts, lasts), q, n, own in zip(
        view.spans, (view.q_v, view.q_u), shear.counts[1:], offset, strict=True
    ):
        # Cloud shows up to one cell beside its last one.
        first, last = min(firsts[slabs]) - 1, max(lasts[slabs]) + 1
        if first > last:
            return None
        # For one cell q only rises or only falls with w: the end slices bound it.
        ends = [(cell - own[k]) / gain[k] for cell in (first, last) for k in (0, -1)]
        step = q[1] - q[0]
        start = math.floor(max((min(ends) - q[0]) / step, 0.0))
        stop = math.ceil(min((max(ends) - q[0]) / step + 1.0, float(len(q))))
        if start >= stop:
            return None
        cells.append((max(first, 0), min(last + 1, n)))
        at.append(own[:, None] + gain[:, None] * q[start:stop])
        image.append(slice(start, stop))
    return Part(w, (cells[0], cells[1]), (at[0], at[1]), (image[0], image[1]))


def span_of(occupied: NDArray[np.bool_]) -> tuple[list[int], list[int]]:
    """List the first and the last cell with cloud of each slice; n and -1 if none."""
    n = occupied.shape[1]
    some = occupied.any(axis=1)
    first = np.where(some, occupied.argmax(axis=1), n)
    last = np.where(some, n - 1 - occupied[:, ::-1].argmax(axis=1), -1)
    return first.tolist(), last.tolist()
