"""The fit beside the same made of a library's parts: k-means and ridge regression."""

from __future__ import annotations

import numpy as np
import pytest

from refcloud.cloudmap import generate
from refcloud.metaballs import approximate, rms_radii
from refcloud.metaballs.pairs import list_pairs, prepare

OVERLAPS = (2.0, 2.1, 2.2, 2.3)  # the peer takes the best of them for each count
RIDGE = 1e-6  # more only raises its error: the design is well conditioned


def peer_error(work, count: int, seed: int) -> float:
    """Fit sklearn's KMeans and Ridge: same kernel, same voxels, heights of any sign."""
    sparse = pytest.importorskip("scipy.sparse", reason="needs scikit-learn's scipy")
    cluster = pytest.importorskip("sklearn.cluster", reason="needs scikit-learn")
    linear = pytest.importorskip("sklearn.linear_model", reason="needs scikit-learn")
    points = work.positions()
    means = cluster.KMeans(count, n_init=1, random_state=seed).fit(points)
    centers = means.cluster_centers_.astype(float)
    labels = means.labels_.astype(np.int64)
    sigma = rms_radii(points, labels, centers=centers, spacing=1.0)
    errors = []
    for overlap in OVERLAPS:
        pairs = list_pairs(work, centers, overlap * sigma, "wyvill")
        shape = (len(pairs.target), count)
        design = sparse.csr_matrix(
            (pairs.value, (pairs.voxel, pairs.ball)), shape=shape
        )
        ridge = linear.Ridge(alpha=RIDGE, fit_intercept=False).fit(design, pairs.target)
        left = pairs.target - design @ ridge.coef_
        errors.append(np.linalg.norm(left) / np.linalg.norm(pairs.target))
    return min(errors)


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["cumulus", "ellipsoid"])
@pytest.mark.parametrize("count", [30, 100, 1000])
def test_standard_is_no_worse_than_kmeans_and_ridge(shape, count):
    pytest.importorskip("sklearn", reason="needs scikit-learn (extra: bench)")
    grid = generate(shape)
    work = prepare(grid)
    assert work is not None
    theirs = [peer_error(work, count, seed) for seed in (0, 1, 2)]
    ours = []
    for seed in (0, 1, 2):
        balls = approximate(grid, count=count, seed=seed)
        centers = (balls.centers - work.origin) / work.edge
        pairs = list_pairs(work, centers, balls.radii / work.edge, "wyvill")
        left = pairs.target - pairs.forward(balls.densities / work.peak)
        ours.append(float(np.linalg.norm(left) / np.linalg.norm(pairs.target)))
    print(f"{shape} {count}: ours {np.median(ours):.4f}, peer {np.median(theirs):.4f}")
    assert np.median(ours) <= np.median(theirs)
