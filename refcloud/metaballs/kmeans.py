"""Phase 1: where the balls go.

`adaptive_kmeans` is the paper's, one voxel at a time; `lloyd` moves all centres at
once. Both run in coordinates that are centred and scaled to 1, so that neither an
offset nor a unit shows.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray

from refcloud.checking import checked
from refcloud.conventions import Array, Range, Seed, Shape
from refcloud.metaballs.choices import spread_start, start_patterns, visits
from refcloud.products import ONE_THREAD

Labels = NDArray[np.integer]


@dataclass(frozen=True)
class Clusters:
    """Groups of points around centres; none is empty.

    Attributes
    ----------
    centers
        Shape (N, 3), scene units.
    assignment
        Which centre each point belongs to, shape (K,).
    epochs
        How often all points were visited and centres moved.
    """

    centers: Array
    assignment: Labels
    epochs: int


@checked
def adaptive_kmeans(
    points: Annotated[Array, Shape("K", 3)],
    count: Annotated[int, Range(1)],
    *,
    seed: Seed = 0,
    order: Literal["shuffled", "raster"] = "shuffled",
    minimal_rate: Annotated[float, Range(0.0, 1.0, open_lower=True)] = 0.05,
    most_epochs: Annotated[int, Range(1)] = 8,
) -> Clusters:
    """Cluster points by the paper's phase 1: each visit moves the nearest centre.

    Formula: w_k += (x_j - w_k) / sqrt(n_k), n_k = visits that w_k has won, from 1

    Parameters
    ----------
    points
        The patterns, shape (K, 3), scene units.
    count
        Number of centres wanted. There are never more than points.
    seed
        Which patterns the centres start on, and the shuffled order.
    order
        How an epoch visits the patterns. In raster order the centres chase the sweep
        and end up to six times worse.
    minimal_rate
        Where the learning ends: the mean rate of all centres.
    most_epochs
        Where it ends at the latest.

    Returns
    -------
    The clusters that are not empty (E18); ties go to the lower number.

    Source: paper M, eq 21-22; E18.

    Examples
    --------
    >>> adaptive_kmeans([[0, 0, 0], [0, 0, 1], [9, 9, 9]], 1).assignment
    array([0, 0, 0])
    """
    scaled, middle, scale = _scaled(points)
    centers = scaled[start_patterns(len(points), count, seed)]
    hits = np.zeros(len(centers))
    epoch = 0
    while epoch < most_epochs and len(points):
        for j in visits(len(points), epoch, seed, order):
            away = scaled[j] - centers
            k = np.einsum("ij,ij->i", away, away).argmin()
            hits[k] += 1.0
            centers[k] += away[k] / np.sqrt(hits[k])
        epoch += 1
        if (1.0 / np.sqrt(np.maximum(hits, 1.0))).mean() < minimal_rate:
            break
    return _clusters(scaled, centers, middle, scale, epoch)


@checked
def lloyd(
    points: Annotated[Array, Shape("K", 3)],
    weights: Annotated[Array, Shape("K"), Range(0.0)],
    count: Annotated[int, Range(1)],
    *,
    seed: Seed = 0,
    rounds: Annotated[int, Range(0)] = 15,
) -> Clusters:
    """Cluster weighted points by rounds of assignment and mean.

    Formula: c_k = sum of w_j x_j / sum of w_j over the points nearest to c_k

    Parameters
    ----------
    points
        Shape (K, 3), scene units.
    weights
        Shape (K,), at least 0. Heavier points get more and closer centres.
    count
        Number of centres wanted. There are never more than distinct points of weight.
    seed
        Where the centres start: drawn by weight times squared distance (k-means++).
    rounds
        How often all centres move, unless no point changes its centre before.

    Returns
    -------
    The clusters that are not empty; distances are compared in float32.

    Source: in place of paper M, eq 21-22; A13.

    Examples
    --------
    >>> found = lloyd([[0, 0, 0], [0, 0, 1], [9, 9, 9]], [1, 3, 1], 2)
    >>> sorted(found.centers[:, 2].round(6).tolist())
    [0.75, 9.0]
    """
    scaled, middle, scale = _scaled(points)
    largest = weights.max(initial=0.0)
    if largest > 0.0:
        weights = weights / largest
    centers = scaled[spread_start(scaled, weights, count, seed)]
    labels, epoch = np.zeros(0, dtype=np.intp), 0
    while epoch < rounds and len(centers):
        before, labels = labels, _nearest(scaled, centers)
        if np.array_equal(labels, before):  # all further rounds would repeat this
            break
        centers = _means(scaled, weights, centers, labels)
        epoch += 1
    return _clusters(scaled, centers, middle, scale, epoch)


def clusters_around(points: Array, centers: Array) -> Clusters:
    """Assign points to given centres, and leave out those that get none."""
    scaled, middle, scale = _scaled(points)
    return _clusters(scaled, (centers - middle) / scale, middle, scale, 0)


def _scaled(points: Array) -> tuple[Array, Array, float]:
    """Centre points and scale them into [-1, 1]."""
    # Their mean depends in its last bits on their order in memory: it is always this.
    points = np.ascontiguousarray(points)
    middle = points.mean(axis=0) if len(points) else np.zeros(3)
    centred = points - middle
    scale = float(np.abs(centred).max(initial=0.0)) or 1.0
    return centred / scale, middle, scale


def _nearest(points: Array, centers: Array) -> Labels:
    """Find the nearest centre of each point, lowest number first, in float32."""
    # The largest x.c - |c|^2/2 is the nearest: one matrix product of the rows [x, -1]
    # with the columns [c, |c|^2/2], in blocks so small that BLAS keeps to one thread.
    # Each score is a sum of four products, which no thread could split either.
    rows = np.full((len(points), 4), -1.0, dtype=np.float32)
    columns = np.empty((4, len(centers)), dtype=np.float32)
    rows[:, :3], columns[:3] = points, centers.T
    columns[3] = 0.5 * np.square(centers).sum(axis=1)
    step = max(1, ONE_THREAD // (4 * max(1, len(centers))))
    score = np.empty((step, len(centers)), dtype=np.float32)
    labels = np.zeros(len(points), dtype=np.intp)
    for start in range(0, len(rows), step):
        part = rows[start : start + step]
        found = np.matmul(part, columns, out=score[: len(part)])
        labels[start : start + step] = found.argmax(axis=1)
    return labels


def _means(points: Array, weights: Array, centers: Array, labels: Labels) -> Array:
    """Move each centre to the weighted mean of its points, if it has any."""
    total = np.bincount(labels, weights, minlength=len(centers))
    moved = np.empty_like(centers)
    for axis in range(3):
        parts = weights * points[:, axis]
        moved[:, axis] = np.bincount(labels, parts, minlength=len(centers))
    full = total > 0.0
    moved[full] /= total[full, None]
    moved[~full] = centers[~full]
    return moved


def _clusters(
    points: Array, centers: Array, middle: Array, scale: float, epochs: int
) -> Clusters:
    """Assign the points once more, and leave out clusters that stay empty."""
    if not len(centers):
        return Clusters(np.zeros((0, 3)), np.zeros(len(points), dtype=np.intp), epochs)
    labels = _nearest(points, centers)
    used, labels = np.unique(labels, return_inverse=True)
    return Clusters(centers[used] * scale + middle, labels, epochs)
