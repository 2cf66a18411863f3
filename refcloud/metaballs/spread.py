"""Phase 2: how far the voxels of each ball spread."""

from __future__ import annotations

from typing import Annotated

import numpy as np

from refcloud.checking import checked
from refcloud.conventions import Array, Positive, Range, Shape
from refcloud.metaballs.kmeans import Labels

# Mean square distance of a cube's points from its centre, over its squared edge.
OWN_SPREAD = 0.25


@checked
def rms_radii(
    points: Annotated[Array, Shape("K", 3)],
    assignment: Labels,
    *,
    centers: Annotated[Array, Shape("N", 3)],
    spacing: Annotated[float, Positive],
    weights: Annotated[Array, Shape("K"), Range(0.0)] | None = None,
) -> Array:
    """Give each cluster's root mean square distance, phase 2.

    Formula: sigma_k^2 = mean of |w_k - x_q|^2 over the cluster + h^2 / 4

    Parameters
    ----------
    points
        Centres of the voxels, shape (K, 3), scene units.
    assignment
        Which cluster each voxel belongs to, shape (K,).
    centers
        Shape (N, 3), scene units.
    spacing
        Edge h of a voxel, scene units. A voxel is a cube and not a point: its own mean
        square distance h^2 / 4 keeps a cluster of one voxel from the radius 0 (E18).
    weights
        What each voxel counts in the mean, shape (K,). None is the paper's: all alike.

    Returns
    -------
    sigma, shape (N,), scene units.

    Source: paper M, eq 23; E18.

    Examples
    --------
    >>> rms_radii([[0, 0, 0]], np.array([0]), centers=[[0, 0, 0]], spacing=2.0)
    array([1.])
    """
    size = len(centers)
    counts = np.ones(len(points)) if weights is None else weights
    away = (points - centers[assignment]) / spacing
    squares = counts * np.einsum("ij,ij->i", away, away)
    total = np.bincount(assignment, counts, minlength=size)
    mean = np.zeros(size)
    parts = np.bincount(assignment, squares, minlength=size)
    np.divide(parts, total, out=mean, where=total > 0.0)
    return spacing * np.sqrt(mean + OWN_SPREAD)
