"""How a camera's rays cross the slices of a grid.

Slices lie across the main axis w and are numbered away from the eye: slice k is at
w = k, and cells across it are counted along v and u. In these units every ray is

    u(w) = offset_u(w) + gain(w) q_u        v(w) = offset_v(w) + gain(w) q_v

with two numbers q of its own. All rays of a pinhole leave the eye E and q is their
slope: the offset is E_u, the gain w - E_w. Parallel rays share a slope, and q is where
they cross w = 0: the offset is slope_u w, the gain 1. So an image on a regular grid of
q sees the same part of every slice, only moved and scaled.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from refcloud.camera import AnyCamera, Camera, axes
from refcloud.cloudmap import VoxelGrid, cell_size
from refcloud.conventions import Array

# Cells across per slice: a ray this steep along v and u has one sample in four voxels'
# length. Up to it the error was seen to grow from .004 to .007 of a picture.
STEEPEST = 3.0
STRAIGHT = 1e-12  # slopes that move less than this across any grid's slices
NOTHING = ((1.0, 0.0), (1.0, 0.0))
Values = NDArray[Any]
Pair = tuple[float, float]
Bounds = tuple[Pair, Pair]  # of v and of u, or of q


@dataclass(frozen=True)
class Shear:
    """A camera seen from a grid's slices.

    Attributes
    ----------
    order
        Axes of the voxel array that are w, v and u.
    back
        Whether slices are numbered against the array's first axis in that order.
    eye
        The eye in w, v, u, cells.
    pixels
        Shape (3, 3): a ray's direction (pinhole), or where it starts from the eye
        (parallel rays), in w, v, u, is pixels[0] + column pixels[1] + row pixels[2].
    slope
        Of parallel rays, cells along v and u per slice; None for a pinhole.
    cell
        Edges of a cell along w, v, u, scene units.
    counts
        Cells along w, v, u.
    size
        Rows and columns of the picture.
    """

    order: tuple[int, int, int]
    back: bool
    eye: Array
    pixels: Array
    slope: Array | None
    cell: Array
    counts: tuple[int, int, int]
    size: tuple[int, int]

    def turned(self, values: Values) -> Values:
        """View a voxel array as slices [w, v, u]."""
        slabs = values.transpose(self.order)
        return slabs[::-1] if self.back else slabs

    def across(self, w: Array) -> tuple[Array, Array]:
        """Give offset, shape (2, ...) for v and u, and gain of planes w."""
        if self.slope is None:
            offset = np.multiply.outer(self.eye[1:], np.ones(np.shape(w)))
            return offset, w - self.eye[0]
        return np.multiply.outer(self.slope, w), np.ones(np.shape(w))

    @property
    def begins(self) -> float:
        """The eye's w, where rays of a pinhole begin; parallel rays have no eye."""
        return float(self.eye[0]) if self.slope is None else -math.inf

    def inside(self, axis: int, q: Array) -> tuple[Array, Array]:
        """Give first and last w at which rays are in the box, along v (0) or u (1)."""
        n = self.counts[1 + axis]
        if self.slope is None:
            start, slope = self.eye[1 + axis] - q * self.eye[0], q
        else:
            start, slope = q, np.full(q.shape, self.slope[axis])
        slope = np.where(np.abs(slope) < STRAIGHT, STRAIGHT, slope)
        one, other = (-0.5 - start) / slope, (n - 0.5 - start) / slope
        return np.minimum(one, other), np.maximum(one, other)

    def slopes(self, bounds: Bounds) -> Bounds:
        """Give the least and largest slopes along v and u of rays with such q."""
        if self.slope is None:
            return bounds
        v, u = (float(slope) for slope in self.slope)
        return (v, v), (u, u)

    def turned_box(self, box: Array) -> Array:
        """Turn first and last cells [z, y, x] into w, v, u, shape (2, 3)."""
        turned = box[:, list(self.order)]
        if self.back:
            turned[:, 0] = self.counts[0] - 1 - turned[::-1, 0]
        return turned

    def step(self, q_v: Array, q_u: Array) -> Array:
        """Give the length of rays from slice to slice, scene units."""
        v, u = (q_v, q_u) if self.slope is None else self.slope
        h_w, h_v, h_u = self.cell
        return np.sqrt(h_w**2 + np.square(v * h_v) + np.square(u * h_u))

    def homogeneous(self, first: Pair, step: Pair) -> Array:
        """Give a pixel's numbers (q - first) / step as quotients of linear forms.

        Shape (3, 3): w, and along v and along u w times the number, as what it is at
        pixel 0, and more per column and per row.
        """
        w, v, u = self.pixels.T
        one = np.array([1.0, 0.0, 0.0])
        if self.slope is None:
            one = w
        else:
            v, u = v - self.slope[0] * w, u - self.slope[1] * w
        return np.array(
            [one, (v - first[0] * one) / step[0], (u - first[1] * one) / step[1]]
        )

    def places(self, columns: Values, rows: Values) -> tuple[Array, Array]:
        """Give q_v and q_u of pixels, and NaN where rays lead away from the slices."""
        w, v, u = (
            start + columns * right + rows * down
            for start, right, down in self.homogeneous((0.0, 0.0), (1.0, 1.0))
        )
        w = np.where(w > 0.0, w, np.nan)
        return v / w, u / w


def shears(grid: VoxelGrid, camera: AnyCamera) -> list[Shear]:
    """List the ways to slice a grid for a camera, the main axis of the view first."""
    h, counts = cell_size(grid), grid.density.shape[::-1]
    right, up, back = axes(camera)
    if isinstance(camera, Camera):
        pixel = 2.0 * math.tan(0.5 * camera.fov_y) / camera.height
        ahead = -back
    else:
        pixel, ahead = camera.height_of_view / camera.height, np.zeros(3)
    corner = (0.5 - 0.5 * camera.width) * right + (0.5 * camera.height - 0.5) * up
    pixels = np.array([ahead + pixel * corner, pixel * right, -pixel * up]) / h
    eye = (camera.eye - grid.lower) / h - 0.5
    toward = -back / h
    found = []
    for main in np.argsort(-np.abs(toward), kind="stable"):
        order = [int(main), *(axis for axis in (2, 1, 0) if axis != main)]
        turn = np.ones(3)
        turn[0] = 1.0 if toward[main] > 0.0 else -1.0
        place = eye[order] * turn
        if turn[0] < 0.0:
            place[0] += counts[main] - 1
        slope = None
        if not isinstance(camera, Camera):
            if toward[main] == 0.0:
                continue
            slope = (toward[order] * turn)[1:] / abs(toward[main])
        moved = pixels[:, order] * turn
        if slope is not None:
            moved[0] += place
        found.append(
            Shear(
                (2 - order[0], 2 - order[1], 2 - order[2]),
                bool(turn[0] < 0.0),
                place,
                moved,
                slope,
                h[order],
                (counts[order[0]], counts[order[1]], counts[order[2]]),
                (camera.height, camera.width),
            )
        )
    return found


def seen(shear: Shear, box: Array) -> Bounds | None:
    """Bound the q of rays that may meet a box; None where slices cannot serve.

    Parameters
    ----------
    shear
        The camera and the slices.
    box
        First and last place in w, v, u of what there is to see, shape (2, 3), cells.

    Returns
    -------
    Least and largest q_v, and q_u; the least is above the largest where nothing shows.
    None where rays lead both ways along the main axis, more than `STEEPEST` cells aside
    per slice, or where parallel rays start within the box.
    """
    H, W = shear.size
    corners = np.array(list(itertools.product((0.0, W - 1.0), (0.0, H - 1.0)))).T
    picture = np.array(shear.places(*corners))  # (2, 4)
    all_ahead, w = not np.isnan(picture).any(), box[:, 0]
    if shear.slope is None:
        begins = shear.eye[0]
        if w[1] <= begins:
            return NOTHING
    else:
        start, right, down = shear.pixels[:, 0]
        begins = float((start + corners[0] * right + corners[1] * down).max())
    beyond = w[0] > begins  # the box lies wholly in front of where rays start
    if not beyond and (shear.slope is not None or not all_ahead):
        return None
    bounds = []
    for axis in (0, 1):
        low, high = -np.inf, np.inf
        if all_ahead:
            low, high = picture[axis].min(), picture[axis].max()
        if beyond:
            offset, gain = shear.across(w)
            ends = (box[:, axis + 1, None] - offset[axis]) / gain
            low, high = max(low, ends.min()), min(high, ends.max())
        bounds.append((float(low), float(high)))
    found = bounds[0], bounds[1]
    steepest = max(abs(slope) for pair in shear.slopes(found) for slope in pair)
    return found if steepest <= STEEPEST else None
