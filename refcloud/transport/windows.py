"""Where slices and rays lie among the columns of a sheared accumulator, on one axis.

With s samples per cell, sample j of slice m lies at cell (j + 1/2) / s - 1/2, on the
ray c = j + m slope. Whole numbers c = s r + p are columns: number r of phase p.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

Values = NDArray[Any]

PAD = 2  # columns beside a slice: a ray is read from two columns on each side of it


# What sample j of some phase reads: a weight, times column number + j of a phase.
Tap = tuple[float, int, int]


def window_of(moved: float, phase: int, scale: int) -> tuple[int, float]:
    """Place a slice that has moved up by samples: cell 0's column, and what is beyond.

    Formula: column + fraction = (moved - phase - 1/2) / scale + 1/2
    """
    at = (moved - phase - 0.5) / scale + 0.5
    column = math.floor(at)
    return column, at - column


def taps_of(moved: float, phase: int, scale: int) -> list[Tap]:
    """List what the samples of a phase read, by Catmull-Rom: weight, phase, column."""
    whole = math.floor(moved)
    taps = []
    for k, weight in enumerate(catmull_rom(moved - whole)):
        column, other = divmod(phase + whole + k - 1, scale)
        if weight:  # on a column, only that one
            taps.append((weight, other, column))
    return taps


def catmull_rom(t: float) -> tuple[float, float, float, float]:
    """Weigh the values at -1, 0, 1 and 2 for a place t in [0, 1)."""
    return (
        0.5 * t * (t * (2.0 - t) - 1.0),
        0.5 * (t * t * (3.0 * t - 5.0) + 2.0),
        0.5 * t * (t * (4.0 - 3.0 * t) + 1.0),
        0.5 * t * t * (t - 1.0),
    )


def lit_share(fraction: float, slope: float, step: float, scale: int) -> float:
    """Give the share inside the box of a step on the column just beyond the last cell.

    Formula: 1/2 + scale (fraction - 1/2) / (slope step), in [0, 1]: in the middle of a
    step the column is 1 - fraction cells beyond the last cell's centre, the box ends
    half a cell beyond it, and the step toward the sun leads outward.
    """
    inside = scale * (fraction - 0.5)
    if slope == 0.0:
        return float(inside > 0.0)
    return min(max(0.5 + inside / (slope * step), 0.0), 1.0)


def steps_inside(c: Values, m: int, slope: float, samples: int) -> Values:
    """Count the steps from slice m to the end of the box, on columns along an axis.

    Formula: min(m + 1/2, (samples - 1/2 - c + m slope) / slope): to the face of slice 0
    or to the side; columns beyond the last sample count as on it.
    """
    if slope == 0.0:
        return np.full(c.shape, m + 0.5)
    to_side = np.maximum(samples - 0.5 - (c - m * slope), 0.5)
    return np.minimum(m + 0.5, to_side / slope)


def own_share(moved: float) -> float:
    """Give the share that the first column beyond the side has in what is read there.

    Formula: 2 f - 1, at least 0, where f is the fraction of what a slice has `moved`:
    the column is 1 - f cells beyond the last sample, and the side half a cell.
    """
    return max(2.0 * (moved - math.floor(moved)) - 1.0, 0.0)


def border_factor(moved: float, slope: float, steps: Values) -> Values:
    """Give what stands for the first column beyond the side, per value of the last one.

    A ray's column density is the mean density along it times its length in the box.
    Only the length changes fast at the side that faces the sun: with f the fraction of
    what a slice has `moved`, it is min(steps, (1/2 + f) / slope) on the last column
    inside, and min(steps, 1/2 / slope) on the last sample, f columns further out. The
    factor lets the straight line between both columns give that at the last sample.
    """
    f = moved - math.floor(moved)
    if slope == 0.0 or f == 0.0:
        return np.ones(steps.shape)
    inner = np.minimum(steps, (0.5 + f) / slope)
    own = np.minimum(steps, 0.5 / slope)
    return (own / inner - (1.0 - f)) / f
