"""The benchmark of fits: run time against error at 30 to 3000 balls, beside peers.

The cloud is paper M's, of about 12,000 voxels. A time is of one fit; an error is the
relative root mean square over all voxels. The peers get the same kernel and the same
voxels, empty ones included: scikit-learn's k-means and ridge regression, and scipy's
non-negative least squares on the same centres.
"""

from __future__ import annotations

import functools
import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from refcloud.bench.contenders import peer
from refcloud.bench.subject import MS, Subject
from refcloud.bench.timing import Contender
from refcloud.cloudmap import VoxelGrid, cell_centres, generate
from refcloud.conventions import Array
from refcloud.metaballs import (
    Metaballs,
    approximate,
    direct_metaballs,
    field_grid,
    rms_radii,
)
from refcloud.metaballs.approximate import METHODS
from refcloud.metaballs.pairs import list_pairs, prepare
from refcloud.metaballs.sizes import OVERLAP

PEERS = ("scikit-learn", "scipy")
SEED = 1
RIM = 2  # empty cells around those that the generator leaves
COUNTS, QUICK_COUNTS = (30, 100, 300, 1000, 3000), (30, 100)
# Diameters and noise cell of the cloud where quick: about 1200 voxels.
SMALL = {"diameters": np.array([28.0, 16.0, 20.0]), "cell": 8.0}
# Orthogonal least squares takes the square of the balls times the candidates: 30 s at
# 3000. scipy's solver works on a dense matrix: 1 GB at 1000.
MOST = {"orthogonal": 1000, "scipy nnls": 100}
RIDGE = 1e-6  # more only raises the peer's error: the design is well conditioned


def fits(size: int) -> list[Contender]:
    """List every method at every count, and the peers that are installed.

    A size of 0 is the small cloud with few counts.
    """
    shape: dict[str, Any] = {} if size else SMALL
    grid = _padded(generate("ellipsoid", seed=SEED, **shape))
    found: list[Contender] = []
    for count in COUNTS if size else QUICK_COUNTS:
        works: dict[str, Callable[[], Any]] = {
            f"refcloud {method}": functools.partial(
                approximate, grid, count=count, method=method, seed=SEED
            )
            for method in METHODS
            if count <= MOST.get(method, count)
        }
        works["refcloud direct"] = functools.partial(
            direct_metaballs,
            count=count,
            seed=SEED,
            **shape,
        )
        if peer("sklearn") and peer("scipy"):
            works["sklearn KMeans + Ridge"] = functools.partial(_ridge, grid, count)
        if peer("sklearn") and peer("scipy") and count <= MOST["scipy nnls"]:
            works["sklearn KMeans + scipy nnls"] = functools.partial(
                _non_negative, grid, count
            )
        found += [
            Contender(
                f"{count:4d} balls",
                name,
                1,
                functools.partial(_fitted, grid, work),
                float,  # no error
                rival=name.endswith("Ridge"),
                peer=name.startswith("sklearn"),
            )
            for name, work in works.items()
        ]
    return found


@dataclass(frozen=True)
class Fitted:
    """Balls of a fit; as a number they are their error.

    So the runner times the fit alone, and finds the error where it compares.

    Attributes
    ----------
    grid
        What was fitted.
    balls
        Those whose densities are added, and those whose densities are taken away.
    """

    grid: VoxelGrid
    balls: tuple[Metaballs, ...]

    def __array__(self, dtype: Any = None, copy: Any = None) -> Array:
        """Give the relative root mean square error over all voxels."""
        x, y, z = cell_centres(self.grid)
        left = self.grid.density
        for balls, sign in zip(self.balls, (1.0, -1.0), strict=False):
            left = left - sign * field_grid(balls, x, y=y, z=z)
        squares = np.square(left).sum() / np.square(self.grid.density).sum()
        return np.asarray(np.sqrt(squares))


def _fitted(grid: VoxelGrid, work: Callable[[], Any]) -> Fitted:
    found = work()
    return Fitted(grid, found if isinstance(found, tuple) else (found,))


def _padded(grid: VoxelGrid) -> VoxelGrid:
    """Surround a cloud map by empty cells, where balls may bleed."""
    edges = (grid.upper - grid.lower) / np.array(grid.density.shape[::-1])
    room = RIM * edges
    return VoxelGrid(np.pad(grid.density, RIM), grid.lower - room, grid.upper + room)


def _design(grid: VoxelGrid, count: int) -> tuple[Array, Array, Any, Array]:
    """Cluster by scikit-learn, and give centres, radii, design matrix and target."""
    work = prepare(grid)
    assert work is not None  # these clouds are not empty
    points = work.positions
    cluster = importlib.import_module("sklearn.cluster")
    means = cluster.KMeans(count, n_init=1, random_state=SEED).fit(points)
    centers = means.cluster_centers_.astype(float)
    sigma = rms_radii(
        points, means.labels_.astype(np.int64), centers=centers, spacing=1.0
    )
    radii = OVERLAP * sigma
    pairs = list_pairs(work, centers, radii, "wyvill")
    sparse = importlib.import_module("scipy.sparse")
    design = sparse.csr_matrix(
        (pairs.value, (pairs.voxel, pairs.ball)), shape=(len(pairs.target), count)
    )
    places = work.origin + centers * work.edge
    return places, radii * work.edge, design, pairs.target * work.peak


def _ridge(grid: VoxelGrid, count: int) -> tuple[Metaballs, ...]:
    """Fit by scikit-learn's parts: heights of any sign."""
    centers, radii, design, target = _design(grid, count)
    linear = importlib.import_module("sklearn.linear_model")
    fit = linear.Ridge(alpha=RIDGE, fit_intercept=False).fit(design, target)
    above, below = np.maximum(fit.coef_, 0.0), np.maximum(-fit.coef_, 0.0)
    return Metaballs(centers, radii, above), Metaballs(centers, radii, below)


def _non_negative(grid: VoxelGrid, count: int) -> Metaballs:
    """Fit by scikit-learn's clusters and scipy's dense solver."""
    centers, radii, design, target = _design(grid, count)
    optimize = importlib.import_module("scipy.optimize")
    covered = np.flatnonzero(np.diff(design.indptr))  # rows of zeros change nothing
    heights, _ = optimize.nnls(design[covered].toarray(), target[covered])
    return Metaballs(centers, radii, heights)


APPROXIMATE = Subject(
    name="approximate",
    title="fits of a cloud map by balls, 30 to 3000 of them",
    about="CPU time of a fit, medians; error: relative RMSE of the density over all"
    " voxels, those of heights of any sign for Ridge",
    lists=((fits, 1, 0),),
    peers=PEERS,
    unit=MS,
    digits=3,
    reference="the voxels themselves, exact",
    one_task=True,
)
