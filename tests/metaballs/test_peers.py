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
    points = work.positions
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


def error_of(work, balls) -> float:
    centers = (balls.centers - work.origin) / work.edge
    pairs = list_pairs(work, centers, balls.radii / work.edge, "wyvill")
    left = pairs.target - pairs.forward(balls.densities / work.peak)
    return float(np.linalg.norm(left) / np.linalg.norm(pairs.target))


# How far the error lies below the peer's: the median of three of the paper's clouds.
# What was measured is 1 to 3 points more; the peer here takes its best of overlaps.
GOALS = {
    ("quick", 30): 0.07,
    ("quick", 100): 0.09,
    ("quick", 1000): 0.015,
    ("standard", 30): 0.17,
    ("standard", 100): 0.21,
    ("standard", 1000): 0.29,
    ("full", 30): 0.19,
    ("full", 100): 0.25,
    ("full", 1000): 0.41,
}


@pytest.mark.slow
@pytest.mark.parametrize("count", [30, 100, 1000])
def test_errors_are_below_those_of_kmeans_and_ridge(count):
    pytest.importorskip("sklearn", reason="needs scikit-learn (extra: bench)")
    below: dict[str, list[float]] = {"quick": [], "standard": [], "full": []}
    for cloud in (1, 2, 3):
        grid = generate("ellipsoid", seed=cloud)
        work = prepare(grid)
        assert work is not None
        seeds = (0, 1, 2) if count < 1000 else (0,)
        theirs = np.median([peer_error(work, count, seed) for seed in seeds])
        for method, found in below.items():
            ours = np.median(
                [
                    error_of(
                        work, approximate(grid, count=count, seed=seed, method=method)
                    )
                    for seed in seeds
                ]
            )
            found.append(1.0 - float(ours / theirs))
    print(count, below)
    for method, found in below.items():
        assert np.median(found) >= GOALS[method, count], method


# On this cloud about 190 and 460 balls are needed; the peer takes its best of overlaps.
@pytest.mark.slow
@pytest.mark.parametrize(("count", "few"), [(1000, 200), (3000, 500)])
def test_few_balls_err_as_little_as_the_peers_many(count, few):
    pytest.importorskip("sklearn", reason="needs scikit-learn (extra: bench)")
    grid = generate("ellipsoid", seed=2)
    work = prepare(grid)
    assert work is not None
    ours = error_of(work, approximate(grid, count=few, method="full"))
    theirs = peer_error(work, count, 0)
    print(f"full with {few}: {ours:.4f}, peer with {count}: {theirs:.4f}")
    assert ours <= theirs
